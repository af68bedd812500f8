//! Rays and sectors: how far one can see.

use nalgebra::Vector2;

use crate::world::nearest_on_wall;
use crate::{Point, Pose, World};

impl World {
    /// The distance from `origin` along the unit vector `direction` to the first surface, exact, at
    /// most `max_range`; 0 from within an obstacle or outside the room, and if `max_range` is negative or
    /// not a number. A point on a wall is inside the room.
    ///
    /// ```
    /// use headway_sim::{Point, Room, World};
    /// let world = World::new(Room::new(10.0, 15.0), vec![])?;
    /// let range = world.cast_ray(&Point::new(4.0, 5.0), &[1.0, 0.0].into(), 30.0);
    /// assert_eq!(range, 6.0);
    /// # Ok::<(), headway_sim::SimError>(())
    /// ```
    #[must_use]
    pub fn cast_ray(&self, origin: &Point, direction: &Vector2<f64>, max_range: f64) -> f64 {
        let room = self.room();
        if !room.contains(origin) {
            return 0.0;
        }
        let [left, below, right, above] = room.to_walls(origin);
        let along = |back: f64, ahead: f64, rate: f64| {
            if rate > 0.0 {
                ahead / rate
            } else if rate < 0.0 {
                -back / rate
            } else {
                f64::INFINITY
            }
        };
        let wall = along(left, right, direction.x).min(along(below, above, direction.y));
        // `max` and `min` pass over what is not a number.
        let range = wall.min(max_range.max(0.0));
        let ranges =
            self.obstacles_near(origin, range).filter_map(|index| self.solids()[index].cast(origin, direction));
        ranges.fold(range, f64::min)
    }

    /// The distance from a pose's origin to the nearest surface within `half_angle` to both sides of
    /// its heading, metres, as if nothing were hidden; exact, with the half-angle in [0, pi/2]. 0 from
    /// within an obstacle or outside the room.
    ///
    /// The nearest point of a convex thing within a convex sector is its nearest point of all, if that
    /// lies in the sector, or else lies on one of the sector's two sides.
    #[must_use]
    pub fn sector_range(&self, pose: &Pose, half_angle: f64) -> f64 {
        let origin = Point::from(pose.translation.vector);
        let ahead = pose.rotation * Vector2::x();
        let (sin, cos) = half_angle.sin_cos();
        let side = |sin: f64| self.cast_ray(&origin, &(pose.rotation * Vector2::new(cos, sin)), f64::INFINITY);
        let reach = side(-sin).min(side(sin));
        let on_solids = self.obstacles_near(&origin, reach).map(|index| self.solids()[index].nearest(&origin));
        let on_walls = self.walls().map(|wall| nearest_on_wall(&wall, &origin));
        let in_sector = |to: &Vector2<f64>| ahead.dot(to) >= cos * to.norm();
        let ranges = on_solids.chain(on_walls).map(|nearest| nearest - origin).filter(in_sector).map(|to| to.norm());
        ranges.fold(reach, f64::min)
    }
}
