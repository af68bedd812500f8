//! What stands where, and how near it is.

use parry2d::query;
use parry2d::shape::ConvexPolygon;
use serde::{Deserialize, Serialize};

use crate::geometry::{Polygon, nearest_on_segment, ray_disc};
use crate::{Footprint, Obstacle, Point, Pose, Room, Shape, SimError};
use nalgebra::Vector2;

/// A room with static obstacles, ready to be asked for distances.
///
/// Serialised as its room and obstacles; what is derived from them is built anew.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(try_from = "WorldData", into = "WorldData")]
pub struct World {
    room: Room,
    obstacles: Vec<Obstacle>,
    solids: Vec<Solid>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WorldData {
    room: Room,
    obstacles: Vec<Obstacle>,
}

/// An obstacle in the world's frame.
#[derive(Debug, Clone)]
pub(crate) enum Solid {
    Disc { center: Point, radius: f64 },
    Polygon(Polygon),
}

/// The outline of an obstacle or a wall in the world's frame, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outline<'a> {
    /// A disc.
    Disc {
        /// Its centre.
        center: Point,
        /// Its radius.
        radius: f64,
    },
    /// A convex polygon's corners, counter-clockwise.
    Polygon(&'a [Point]),
    /// A wall, from corner to corner.
    Wall([Point; 2]),
}

/// Something that a vehicle can hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// The wall at x = 0, y = 0, x = width or y = height, in this order.
    Wall(usize),
    /// An obstacle, by its index.
    Obstacle(usize),
}

/// How near a footprint is to things: signed distances, negative where they overlap, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proximity {
    /// The nearest wall, and the distance to it.
    pub wall: (usize, f64),
    /// The nearest obstacle, and the distance to it, where there is any.
    pub obstacle: Option<(usize, f64)>,
}

impl Proximity {
    /// The distance to whatever is nearest, metres.
    #[must_use]
    pub fn clearance(&self) -> f64 {
        self.obstacle.map_or(self.wall.1, |(_, clearance)| clearance.min(self.wall.1))
    }
}

impl TryFrom<WorldData> for World {
    type Error = SimError;
    fn try_from(data: WorldData) -> Result<Self, SimError> {
        Self::new(data.room, data.obstacles)
    }
}

impl From<World> for WorldData {
    fn from(world: World) -> Self {
        Self { room: world.room, obstacles: world.obstacles }
    }
}

impl World {
    /// Builds a world; every obstacle must lie within the room.
    ///
    /// # Errors
    /// Names the field of the room or of an obstacle (`obstacles.3.shape.radius`) that is not
    /// allowed, or the obstacle that leaves the room.
    pub fn new(room: Room, obstacles: Vec<Obstacle>) -> Result<Self, SimError> {
        room.check()?;
        let mut world = Self { room, obstacles: Vec::new(), solids: Vec::new() };
        for (index, obstacle) in obstacles.into_iter().enumerate() {
            let place = format!("obstacles.{index}");
            obstacle.shape.check().map_err(|e| e.under("shape").under(&place))?;
            let clearance = world.wall_clearance(&Footprint::of_obstacle(&obstacle.shape), &obstacle.pose()).1;
            if !(clearance >= -1e-9 && obstacle.yaw.is_finite()) {
                let (x, y) = (obstacle.x, obstacle.y);
                return Err(SimError::OutsideRoom { index, x, y, width: room.width, height: room.height });
            }
            world.push(obstacle);
        }
        Ok(world)
    }

    /// Adds a checked obstacle.
    pub(crate) fn push(&mut self, obstacle: Obstacle) {
        let pose = obstacle.pose();
        self.solids.push(match &obstacle.shape {
            Shape::Disc { radius } => Solid::Disc { center: Point::new(obstacle.x, obstacle.y), radius: *radius },
            shape => Solid::Polygon(Polygon::new(shape.vertices()).at(&pose)),
        });
        self.obstacles.push(obstacle);
    }

    /// The walls.
    #[must_use]
    pub fn room(&self) -> Room {
        self.room
    }

    /// The obstacles, as given.
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
        let Room { width, height } = self.room;
        let corner = |x, y| Point::new(x, y);
        let [a, b, c, d] = [corner(0.0, 0.0), corner(width, 0.0), corner(width, height), corner(0.0, height)];
        [[d, a], [a, b], [b, c], [c, d]]
    }

    /// The signed distance from a footprint to the nearest surface, metres: negative in a collision.
    ///
    /// ```
    /// use headway_sim::{Footprint, Obstacle, Pose, Room, Shape, World};
    /// let disc = |radius| Shape::Disc { radius };
    /// let obstacle = Obstacle { shape: disc(0.5), x: 5.0, y: 5.0, yaw: 0.0 };
    /// let world = World::new(Room { width: 10.0, height: 15.0 }, vec![obstacle])?;
    /// let vehicle = Footprint::new(&disc(0.25))?;
    /// let clearance = world.clearance(&vehicle, &Pose::translation(7.0, 5.0));
    /// assert!((clearance - 1.25).abs() < 1e-12);
    /// # Ok::<(), headway_sim::SimError>(())
    /// ```
    #[must_use]
    pub fn clearance(&self, footprint: &Footprint, pose: &Pose) -> f64 {
        self.proximity(footprint, pose).clearance()
    }

    /// Whether a footprint touches or overlaps anything.
    #[must_use]
    pub fn collides(&self, footprint: &Footprint, pose: &Pose) -> bool {
        self.clearance(footprint, pose) <= 0.0
    }

    /// The nearest wall and the nearest obstacle, with the signed distances to them.
    #[must_use]
    pub fn proximity(&self, footprint: &Footprint, pose: &Pose) -> Proximity {
        let mut nearest: Option<(usize, f64)> = None;
        let center = Point::from(pose.translation.vector);
        for (index, solid) in self.solids.iter().enumerate() {
            let best = nearest.map_or(f64::INFINITY, |(_, clearance)| clearance);
            if solid.bound(&center) - footprint.circumradius() < best {
                let clearance = solid.clearance(footprint, pose);
                if clearance < best {
                    nearest = Some((index, clearance));
                }
            }
        }
        Proximity { wall: self.wall_clearance(footprint, pose), obstacle: nearest }
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
            Surface::Wall(index) => {
                let Room { width, height } = self.room;
                [point.x, point.y, width - point.x, height - point.y][index]
            }
            Surface::Obstacle(index) => {
                let pose = Pose::translation(point.x, point.y);
                self.solids[index].clearance(&Footprint::disc(0.0), &pose)
            }
        }
    }

    /// Whether a disc of `radius` can be moved along the straight line from `a` to `b` without
    /// touching anything, but for dips of less than a millimetre.
    ///
    /// Walks the line by the room it has (sphere tracing), so thin obstacles are not stepped over.
    #[must_use]
    pub fn is_free(&self, a: &Point, b: &Point, radius: f64) -> bool {
        let (length, mut travelled) = ((b - a).norm(), 0.0);
        loop {
            let t = if length > 0.0 { travelled / length } else { 1.0 };
            let room = self.distance(&(a + (b - a) * t)) - radius;
            if room <= 0.0 {
                return false;
            }
            if t >= 1.0 {
                return true;
            }
            travelled = (travelled + room.max(1e-3)).min(length);
        }
    }

    fn wall_clearance(&self, footprint: &Footprint, pose: &Pose) -> (usize, f64) {
        let Room { width, height } = self.room;
        let to_walls = |p: &Point| [p.x, p.y, width - p.x, height - p.y];
        let center = Point::from(pose.translation.vector);
        let mut distances = to_walls(&center);
        match footprint.polygon() {
            None => distances.iter_mut().for_each(|d| *d -= footprint.circumradius()),
            Some(polygon) => {
                for corner in polygon.vertices() {
                    for (least, d) in distances.iter_mut().zip(to_walls(&(pose * corner))) {
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

impl Solid {
    /// A lower bound of the distance from a point to the solid.
    fn bound(&self, point: &Point) -> f64 {
        match self {
            Self::Disc { center, radius } => (point - center).norm() - radius,
            Self::Polygon(polygon) => (point - polygon.center()).norm() - polygon.radius(),
        }
    }

    fn clearance(&self, footprint: &Footprint, pose: &Pose) -> f64 {
        let origin = Point::from(pose.translation.vector);
        match (self, footprint.polygon()) {
            (Self::Disc { .. }, None) => self.bound(&origin) - footprint.circumradius(),
            (Self::Disc { center, radius }, Some(own)) => {
                own.signed_distance(&pose.inverse_transform_point(center)) - radius
            }
            (Self::Polygon(polygon), None) => polygon.signed_distance(&origin) - footprint.circumradius(),
            (Self::Polygon(polygon), Some(own)) => polygon_clearance(polygon, &own.at(pose)),
        }
    }

    /// Where a ray along a unit vector meets the solid.
    pub(crate) fn cast(&self, origin: &Point, direction: &Vector2<f64>) -> Option<f64> {
        match self {
            Self::Disc { center, radius } => ray_disc(&(center - origin), *radius, direction),
            Self::Polygon(polygon) => polygon.cast(origin, direction),
        }
    }

    /// The point of the surface nearest to an outside point.
    pub(crate) fn nearest(&self, point: &Point) -> Point {
        match self {
            Self::Disc { center, radius } => center + (point - center).normalize() * *radius,
            Self::Polygon(polygon) => polygon.nearest(point),
        }
    }
}

/// The point of a wall nearest to `point`.
pub(crate) fn nearest_on_wall(wall: &[Point; 2], point: &Point) -> Point {
    nearest_on_segment(&wall[0], &wall[1], point)
}

/// The signed distance between two convex polygons, by parry: GJK outside, EPA inside.
fn polygon_clearance(a: &Polygon, b: &Polygon) -> f64 {
    let [Some(shape_a), Some(shape_b)] = [a, b].map(to_parry) else {
        return (a.center() - b.center()).norm() - a.radius() - b.radius();
    };
    let identity = parry2d::math::Pose::identity();
    let apart = query::distance(&identity, &shape_a, &identity, &shape_b).map_or(f64::INFINITY, |d| d.distance);
    if apart > 0.0 {
        return apart;
    }
    match query::contact(&identity, &shape_a, &identity, &shape_b, 0.0) {
        Ok(Some(contact)) => contact.dist.min(0.0),
        _ => 0.0,
    }
}

/// The one place where our points become parry's.
fn to_parry(polygon: &Polygon) -> Option<ConvexPolygon> {
    let points = polygon.vertices().iter().map(|p| parry2d::math::Vector::new(p.x, p.y)).collect();
    ConvexPolygon::from_convex_polyline(points)
}
