//! What stands where, and how near it is.

mod buckets;
mod circles;
mod kernel;
mod movers;
mod solid;
mod surface;

use serde::{Deserialize, Serialize};

use crate::{Footprint, Obstacle, Point, Pose, Room, SimError};
use circles::Circles;
use solid::Solid;

pub(crate) use solid::nearest_on_wall;
pub use surface::{Outline, Proximity, Surface};

/// A room with obstacles, ready to be asked for distances.
///
/// Behind those that stand still it may have *movers*, obstacles whose pose can be set ([`Self::set_pose`]); every
/// question finds them where they now are. Serialised as its room, obstacles and movers (if any); what is derived from them is built anew.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(try_from = "WorldData", into = "WorldData")]
pub struct World {
    room: Room,
    /// Those that stand still, and then those that move.
    obstacles: Vec<Obstacle>,
    n_static: usize,
    solids: Vec<Solid>,
    /// Around each solid.
    circles: Circles,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WorldData {
    room: Room,
    obstacles: Vec<Obstacle>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    movers: Vec<Obstacle>,
}

impl TryFrom<WorldData> for World {
    type Error = SimError;
    fn try_from(data: WorldData) -> Result<Self, SimError> {
        let mut world = Self::new(data.room, data.obstacles)?;
        world.add_movers(data.movers)?;
        Ok(world)
    }
}

impl From<World> for WorldData {
    fn from(world: World) -> Self {
        let mut obstacles = world.obstacles;
        let movers = obstacles.split_off(world.n_static);
        Self { room: world.room, obstacles, movers }
    }
}

impl World {
    /// Builds a world; every obstacle must lie within the room.
    ///
    /// # Errors
    /// Names the field of the room or of an obstacle (`obstacles.3.shape.radius`) that is not
    /// allowed, or the obstacle that leaves the room.
    pub fn new(room: Room, obstacles: Vec<Obstacle>) -> Result<Self, SimError> {
        let mut world = Self::around(room, &obstacles)?;
        for (index, obstacle) in obstacles.into_iter().enumerate() {
            world.check(&obstacle, index).map_err(|e| e.under(&format!("obstacles.{index}")))?;
            world.push(obstacle);
        }
        Ok(world)
    }

    /// Checks the shape of an obstacle, and that it lies within the room.
    fn check(&self, obstacle: &Obstacle, index: usize) -> Result<(), SimError> {
        obstacle.shape.check().map_err(|e| e.under("shape"))?;
        let clearance = self.wall_clearance(&Footprint::of_obstacle(&obstacle.shape), &obstacle.pose()).1;
        if clearance >= -1e-9 && obstacle.yaw.is_finite() { Ok(()) } else { Err(self.outside(obstacle, index)) }
    }

    /// The refusal of an obstacle that leaves the room.
    fn outside(&self, &Obstacle { x, y, .. }: &Obstacle, index: usize) -> SimError {
        SimError::OutsideRoom { index, x, y, width: self.room.width, height: self.room.height }
    }

    /// A world of checked obstacles that stand still.
    pub(crate) fn of_checked(room: Room, obstacles: Vec<Obstacle>) -> Result<Self, SimError> {
        let mut world = Self::around(room, &obstacles)?;
        obstacles.into_iter().for_each(|obstacle| world.push(obstacle));
        Ok(world)
    }

    /// A room in which up to `n_obstacles` are going to stand, anywhere.
    pub(crate) fn empty(room: Room, n_obstacles: usize) -> Result<Self, SimError> {
        Self::within(room, &room, n_obstacles)
    }

    /// A room in which some obstacles are going to stand.
    fn around(room: Room, obstacles: &[Obstacle]) -> Result<Self, SimError> {
        Self::within(room, &area(obstacles), obstacles.len())
    }

    /// A room in which up to `n_obstacles` are going to stand, most of them in a part of it.
    fn within(room: Room, area: &Room, n_obstacles: usize) -> Result<Self, SimError> {
        room.check()?;
        let circles = Circles::new(area, n_obstacles);
        let (obstacles, solids) = (Vec::with_capacity(n_obstacles), Vec::with_capacity(n_obstacles));
        Ok(Self { room, obstacles, n_static: 0, solids, circles })
    }

    /// Adds a checked obstacle that stands still, before any that moves.
    pub(crate) fn push(&mut self, obstacle: Obstacle) {
        self.n_static += 1;
        self.append(obstacle);
    }

    fn append(&mut self, obstacle: Obstacle) {
        let solid = Solid::new(&obstacle);
        self.circles.push_solid(&solid);
        self.solids.push(solid);
        self.obstacles.push(obstacle);
    }

    /// The walls.
    #[must_use]
    pub fn room(&self) -> Room {
        self.room
    }

    /// All obstacles: those that stand still, as given, and then the movers, where they are.
    #[must_use]
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    pub(crate) fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// The outline of a wall or an obstacle in the world's frame.
    ///
    /// # Panics
    /// If there is no such wall (0 to 3) or obstacle.
    #[must_use]
    pub fn outline(&self, surface: Surface) -> Outline<'_> {
        match surface {
            Surface::Wall(index) => Outline::Wall(self.walls()[index]),
            Surface::Obstacle(index) => match &self.solids[index] {
                Solid::Disc { center, radius } => Outline::Disc { center: *center, radius: *radius },
                Solid::Polygon(polygon) => Outline::Polygon(polygon.vertices()),
            },
        }
    }

    /// The four walls in the order of [`Surface::Wall`].
    pub(crate) fn walls(&self) -> [[Point; 2]; 4] {
        let Room { x, y, width, height } = self.room;
        let corner = |dx, dy| Point::new(x + dx, y + dy);
        let [a, b, c, d] = [corner(0.0, 0.0), corner(width, 0.0), corner(width, height), corner(0.0, height)];
        [[d, a], [a, b], [b, c], [c, d]]
    }

    /// The signed distance from a footprint to the nearest surface, metres: negative in a collision, not a
    /// number at a pose that is none.
    ///
    /// ```
    /// use headway_sim::{Footprint, Obstacle, Pose, Room, Shape, World};
    /// let disc = |radius| Shape::Disc { radius };
    /// let obstacle = Obstacle { shape: disc(0.5), x: 5.0, y: 5.0, yaw: 0.0 };
    /// let world = World::new(Room::new(10.0, 15.0), vec![obstacle])?;
    /// let vehicle = Footprint::new(&disc(0.25))?;
    /// let clearance = world.clearance(&vehicle, &Pose::translation(7.0, 5.0));
    /// assert!((clearance - 1.25).abs() < 1e-12);
    /// # Ok::<(), headway_sim::SimError>(())
    /// ```
    #[must_use]
    pub fn clearance(&self, footprint: &Footprint, pose: &Pose) -> f64 {
        self.proximity(footprint, pose).clearance()
    }

    /// Whether a footprint touches or overlaps anything; a pose that is not finite counts as a collision.
    #[must_use]
    pub fn collides(&self, footprint: &Footprint, pose: &Pose) -> bool {
        let center = Point::from(pose.translation.vector);
        let touches = |index: usize| self.solids[index].touches(footprint, pose);
        let is_off_the_walls = self.wall_clearance(footprint, pose).1 > 0.0;
        !is_off_the_walls || self.circles.any_near(&center, footprint.circumradius(), touches)
    }

    /// Whether the clearance of a footprint is at least `least`: as [`Self::clearance`] says, but only
    /// what stands near is looked at. Never at a pose that is not finite.
    pub(crate) fn has_room(&self, footprint: &Footprint, pose: &Pose, least: f64) -> bool {
        let center = Point::from(pose.translation.vector);
        let reach = footprint.circumradius() + least;
        self.wall_clearance(footprint, pose).1 >= least
            && !self.circles.any_near(&center, reach, |index| self.solids[index].clearance(footprint, pose) < least)
    }

    /// Whether a point has at least `least` metres of room around it.
    pub(crate) fn has_room_around(&self, point: &Point, least: f64) -> bool {
        self.has_room(&Footprint::disc(0.0), &Pose::translation(point.x, point.y), least)
    }

    /// Whether all gaps, between obstacles and between obstacles and walls, are wider than `width`, metres.
    ///
    /// A disc of this diameter, wherever it is free, can then get to wherever else it is free: grown by its radius, the
    /// obstacles are convex, apart from each other and from the walls, and so divide the room nowhere.
    pub(crate) fn has_gaps_above(&self, width: f64) -> bool {
        let is_apart = |index: usize, solid: &Solid| {
            let (center, radius) = solid.bounding_circle();
            let outline = Footprint::of_obstacle(&self.obstacles[index].shape);
            self.wall_clearance(&outline, &self.obstacles[index].pose()).1 > width
                && !self
                    .circles
                    .any_near(&center, radius + width, |other| other < index && self.solids[other].gap(solid) <= width)
        };
        self.solids.iter().enumerate().all(|(index, solid)| is_apart(index, solid))
    }

    /// The nearest wall and the nearest obstacle, with the signed distances to them.
    #[must_use]
    pub fn proximity(&self, footprint: &Footprint, pose: &Pose) -> Proximity {
        let wall = self.wall_clearance(footprint, pose);
        let obstacle = if wall.1.is_nan() { None } else { self.nearest_obstacle(footprint, pose) };
        Proximity { wall, obstacle }
    }

    /// The nearest obstacle, the first among equals: looks around ever farther until nothing beyond can be nearer.
    fn nearest_obstacle(&self, footprint: &Footprint, pose: &Pose) -> Option<(usize, f64)> {
        let (center, own_radius) = (Point::from(pose.translation.vector), footprint.circumradius());
        let everywhere = self.room.to_walls(&center).iter().map(|distance| distance.abs()).sum::<f64>();
        let mut reach = self.circles.first_reach();
        loop {
            let mut nearest = (usize::MAX, f64::INFINITY);
            self.circles.visit_near(&center, reach, |index| {
                let clearance = self.solids[index].clearance(footprint, pose);
                if clearance < nearest.1 || (clearance == nearest.1 && index < nearest.0) {
                    nearest = (index, clearance);
                }
                reach.min(nearest.1 + own_radius)
            });
            if nearest.1 + own_radius <= reach || reach >= everywhere {
                return (nearest.0 != usize::MAX).then_some(nearest);
            }
            reach *= 2.0;
        }
    }

    /// The obstacles whose bounding circles come within `reach` metres of a point, in no particular order; a
    /// negative reach counts as 0.
    ///
    /// ```
    /// use headway_sim::{Obstacle, Point, Room, Shape, World};
    /// let disc = |x| Obstacle { shape: Shape::Disc { radius: 0.5 }, x, y: 5.0, yaw: 0.0 };
    /// let world = World::new(Room::new(10.0, 10.0), vec![disc(2.0), disc(8.0)])?;
    /// assert!(world.obstacles_near(&Point::new(1.0, 5.0), 3.0).eq([0]));
    /// # Ok::<(), headway_sim::SimError>(())
    /// ```
    pub fn obstacles_near(&self, point: &Point, reach: f64) -> impl Iterator<Item = usize> + use<'_> {
        self.circles.near(point, reach.max(0.0))
    }

    /// The distance from a point to the nearest surface, metres, negative within an obstacle.
    #[must_use]
    pub fn distance(&self, point: &Point) -> f64 {
        self.clearance(&Footprint::disc(0.0), &Pose::translation(point.x, point.y))
    }

    /// The distance from a point to one surface, metres, negative within an obstacle.
    ///
    /// # Panics
    /// If there is no such wall (0 to 3) or obstacle.
    #[must_use]
    pub fn distance_to(&self, surface: Surface, point: &Point) -> f64 {
        match surface {
            Surface::Wall(index) => self.room.to_walls(point)[index],
            Surface::Obstacle(index) => self.solids[index].distance(point),
        }
    }

    /// Whether a disc of `radius` can be moved along the straight line from `a` to `b` without
    /// touching anything, but for dips of less than a millimetre; never between ends that are not finite.
    ///
    /// Walks the line by the room it has (sphere tracing), so thin obstacles are not stepped over.
    #[must_use]
    pub fn is_free(&self, a: &Point, b: &Point, radius: f64) -> bool {
        let (length, mut travelled) = ((b - a).norm(), 0.0);
        loop {
            let t = if length > 0.0 { travelled / length } else { 1.0 };
            let room = self.distance(&(a + (b - a) * t)) - radius;
            if room.is_nan() || room <= 0.0 {
                return false;
            }
            if t >= 1.0 {
                return true;
            }
            travelled = (travelled + room.max(1e-3)).min(length);
        }
    }

    fn wall_clearance(&self, footprint: &Footprint, pose: &Pose) -> (usize, f64) {
        let center = Point::from(pose.translation.vector);
        // Minima pass over what is not a number: a single bad coordinate would go unnoticed.
        if ![center.x, center.y, pose.rotation.re, pose.rotation.im].iter().all(|number| number.is_finite()) {
            return (0, f64::NAN);
        }
        let mut distances = self.room.to_walls(&center);
        match footprint.polygon() {
            None => distances.iter_mut().for_each(|d| *d -= footprint.circumradius()),
            Some(polygon) => {
                for corner in polygon.vertices() {
                    for (least, d) in distances.iter_mut().zip(self.room.to_walls(&(pose * corner))) {
                        *least = least.min(d);
                    }
                }
            }
        }
        let mut nearest = (0, distances[0]);
        for (index, distance) in distances.into_iter().enumerate() {
            if distance < nearest.1 {
                nearest = (index, distance);
            }
        }
        nearest
    }
}

/// The rectangle around the places of obstacles: where to look for them. No side of it is shorter than a millimetre.
fn area(obstacles: &[Obstacle]) -> Room {
    let side = |of: fn(&Obstacle) -> f64| {
        let low = obstacles.iter().map(of).fold(f64::INFINITY, f64::min);
        let high = obstacles.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        if low.is_finite() && high.is_finite() { (low, (high - low).max(1e-3)) } else { (0.0, 1.0) }
    };
    let ((x, width), (y, height)) = (side(|obstacle| obstacle.x), side(|obstacle| obstacle.y));
    Room { x, y, width, height }
}
