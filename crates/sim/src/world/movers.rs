//! Obstacles whose pose can be set.

use std::borrow::Cow;

use super::{Circles, World, area};
use crate::{Obstacle, Point, Pose, SimError};

impl World {
    /// Adds obstacles that move, behind all others: each must lie within the room. None is added where one is refused.
    ///
    /// # Errors
    /// Names the field of a mover (`movers.3.shape.radius`) that is not allowed, or the mover that leaves the room by its
    /// index among all obstacles.
    pub fn add_movers(&mut self, movers: Vec<Obstacle>) -> Result<(), SimError> {
        for (number, mover) in movers.iter().enumerate() {
            let index = self.obstacles.len() + number;
            self.check(mover, index).map_err(|e| e.under(&format!("movers.{number}")))?;
        }
        let n = self.obstacles.len() + movers.len();
        if !self.circles.suits(n) {
            self.circles = Circles::new(&area(&self.obstacles), n);
            for solid in &self.solids {
                self.circles.push_solid(solid);
            }
        }
        movers.into_iter().for_each(|mover| self.append(mover));
        Ok(())
    }

    /// The obstacles that stand still: the first ones of [`Self::obstacles`].
    #[must_use]
    pub fn static_obstacles(&self) -> &[Obstacle] {
        &self.obstacles[..self.n_static]
    }

    /// The obstacles that move, where they are: the last ones of [`Self::obstacles`].
    #[must_use]
    pub fn movers(&self) -> &[Obstacle] {
        &self.obstacles[self.n_static..]
    }

    /// The world without its movers: itself, where it has none.
    #[must_use]
    pub fn without_movers(&self) -> Cow<'_, Self> {
        if self.movers().is_empty() {
            return Cow::Borrowed(self);
        }
        let world = Self::of_checked(self.room, self.static_obstacles().to_vec());
        Cow::Owned(world.expect("the room was checked"))
    }

    /// Moves a mover, named by its index among all obstacles, to a pose at which it lies within the room.
    ///
    /// All questions then find what they would in a world built anew with the mover at `pose`.
    ///
    /// # Errors
    /// If the mover would leave the room; it then stays.
    ///
    /// # Panics
    /// If there is no such mover.
    ///
    /// ```
    /// use headway_sim::{Obstacle, Point, Pose, Room, Shape, World};
    /// let mut world = World::new(Room::new(10.0, 10.0), vec![])?;
    /// world.add_movers(vec![Obstacle { shape: Shape::Disc { radius: 0.5 }, x: 2.0, y: 5.0, yaw: 0.0 }])?;
    /// world.set_pose(0, &Pose::translation(7.0, 5.0))?;
    /// assert_eq!(world.distance(&Point::new(7.0, 4.0)), 0.5);
    /// assert!(world.set_pose(0, &Pose::translation(9.8, 5.0)).is_err());
    /// # Ok::<(), headway_sim::SimError>(())
    /// ```
    pub fn set_pose(&mut self, index: usize, pose: &Pose) -> Result<(), SimError> {
        self.set_place(index, [pose.translation.x, pose.translation.y, pose.rotation.angle()])
    }

    /// As [`Self::set_pose`], by position and yaw, so that a yaw that stays is the same to the last bit.
    pub(crate) fn set_place(&mut self, index: usize, place: [f64; 3]) -> Result<(), SimError> {
        assert!(index >= self.n_static, "obstacle {index} stands still");
        let old = self.place(index, place);
        if self.is_within(index) {
            self.circles.relocate(index, &self.solids[index].bounding_circle().0);
            return Ok(());
        }
        let refused = self.outside(&self.obstacles[index], index);
        self.place(index, old);
        Err(refused)
    }

    /// Puts an obstacle and its solid elsewhere: the place where it was.
    fn place(&mut self, index: usize, [x, y, yaw]: [f64; 3]) -> [f64; 3] {
        let obstacle = &mut self.obstacles[index];
        let old = [obstacle.x, obstacle.y, obstacle.yaw];
        (obstacle.x, obstacle.y, obstacle.yaw) = (x, y, yaw);
        self.solids[index].place(obstacle);
        old
    }

    /// Whether an obstacle lies within the room, by the rule of [`World::new`].
    fn is_within(&self, index: usize) -> bool {
        let Obstacle { x, y, yaw, .. } = self.obstacles[index];
        let least = |point| self.room.to_walls(&point).into_iter().fold(f64::INFINITY, f64::min);
        let is_finite = x.is_finite() && y.is_finite() && yaw.is_finite();
        is_finite && self.solids[index].least_to_walls(Point::new(x, y), least) >= -1e-9
    }
}
