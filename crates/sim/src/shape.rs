//! Shapes as data: what specs and world files hold.

use rand::RngExt;
use serde::{Deserialize, Serialize};

use crate::check::{at_least, positive, within};
use crate::geometry::Polygon;
use crate::{FieldError, Point, Pose};

/// A closed rectangle of walls around `[x, x + width] x [y, y + height]`, metres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Room {
    /// Least x within, metres.
    #[serde(default)]
    pub x: f64,
    /// Least y within, metres.
    #[serde(default)]
    pub y: f64,
    /// Extent along x, metres.
    pub width: f64,
    /// Extent along y, metres.
    pub height: f64,
}

impl Room {
    /// The room `[0, width] x [0, height]`.
    #[must_use]
    pub const fn new(width: f64, height: f64) -> Self {
        Self { x: 0.0, y: 0.0, width, height }
    }

    /// Checks the place and the extents.
    ///
    /// # Errors
    /// Names a corner's coordinate beyond 1000 km or an extent that is not from a micrometre to 1000 km.
    pub fn check(&self) -> Result<(), FieldError> {
        within("x", self.x, -SIZES[1], SIZES[1])?;
        within("y", self.y, -SIZES[1], SIZES[1])?;
        check_size("width", self.width)?;
        check_size("height", self.height)
    }

    /// The distances from a point to the walls, metres, in the order of [`crate::Surface::Wall`]; negative outside.
    ///
    /// ```
    /// use headway_sim::{Point, Room};
    /// let room = Room { x: -2.0, y: 1.0, width: 10.0, height: 15.0 };
    /// assert_eq!(room.to_walls(&Point::new(0.0, 5.0)), [2.0, 4.0, 8.0, 11.0]);
    /// ```
    #[must_use]
    #[inline]
    pub fn to_walls(&self, point: &Point) -> [f64; 4] {
        let Self { x, y, width, height } = self;
        [point.x - x, point.y - y, x + width - point.x, y + height - point.y]
    }

    /// A point drawn uniformly from the room.
    pub(crate) fn sample(&self, rng: &mut impl RngExt) -> Point {
        let Self { x, y, width, height } = *self;
        Point::new(x + rng.random_range(0.0..width), y + rng.random_range(0.0..height))
    }

    /// Whether a point lies between the walls or on one; no point that is not a number does.
    pub(crate) fn contains(&self, point: &Point) -> bool {
        self.to_walls(point).iter().all(|distance| *distance >= 0.0)
    }
}

/// The smallest and the largest size of a thing, metres: between them, rounding does not spoil its outline.
const SIZES: [f64; 2] = [1e-6, 1e6];

/// The least sine of the turn at a polygon's corner. Parry drops corners that turn by less than 0.17 mrad.
const LEAST_SINE: f64 = 1e-3;

/// A solid convex outline in its own frame; sizes from a micrometre to 1000 km.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// A disc around the origin.
    Disc {
        /// Metres, above 0.
        radius: f64,
    },
    /// A rectangle around the origin.
    Box {
        /// Extent along x (forward), metres, above 0.
        length: f64,
        /// Extent along y (left), metres, above 0.
        width: f64,
    },
    /// A convex polygon.
    Polygon {
        /// At least three corners `[x, y]` in metres, counter-clockwise, strictly convex: the sine of the
        /// turn at each is at least 0.001.
        vertices: Vec<[f64; 2]>,
    },
}

impl Shape {
    /// The corners, counter-clockwise; none for a disc.
    #[must_use]
    pub fn vertices(&self) -> Vec<Point> {
        match self {
            Self::Disc { .. } => Vec::new(),
            Self::Box { length, width } => {
                let (x, y) = (length / 2.0, width / 2.0);
                [[-x, -y], [x, -y], [x, y], [-x, y]].map(Point::from).into()
            }
            Self::Polygon { vertices } => vertices.iter().copied().map(Point::from).collect(),
        }
    }

    /// The distance from the origin to the farthest point, metres.
    #[must_use]
    pub fn circumradius(&self) -> f64 {
        match self {
            Self::Disc { radius } => *radius,
            _ => self.vertices().iter().map(|v| v.coords.norm()).fold(0.0, f64::max),
        }
    }

    /// Checks sizes and, for a polygon, convexity and orientation.
    ///
    /// # Errors
    /// Names the field, its value and what is allowed.
    pub fn check(&self) -> Result<(), FieldError> {
        match self {
            Self::Disc { radius } => check_size("radius", *radius),
            Self::Box { length, width } => {
                check_size("length", *length)?;
                check_size("width", *width)
            }
            Self::Polygon { vertices } => check_polygon(vertices),
        }
    }

    /// The checked shape as a polygon; none for a disc.
    pub(crate) fn polygon(&self) -> Option<Polygon> {
        (!matches!(self, Self::Disc { .. })).then(|| Polygon::new(self.vertices()))
    }
}

fn check_size(field: &str, value: f64) -> Result<(), FieldError> {
    positive(field, value)?;
    within(field, value, SIZES[0], SIZES[1])
}

fn check_polygon(vertices: &[[f64; 2]]) -> Result<(), FieldError> {
    at_least("vertices.len", vertices.len(), 3)?;
    let n = vertices.len();
    let mut turned = 0.0;
    for i in 0..n {
        let [a, b, c] = [0, 1, 2].map(|k| Point::from(vertices[(i + k) % n]));
        let (ab, bc) = (b - a, c - b);
        let refuse = |allowed: &str| {
            let place = format!("vertices.{}", (i + 1) % n);
            Err(FieldError::new(place, format!("[{}, {}]", b.x, b.y), allowed))
        };
        let sine = ab.perp(&bc) / (ab.norm() * bc.norm());
        if sine.is_nan() || sine < LEAST_SINE {
            return refuse("a left turn of some size: list the corners counter-clockwise, strictly convex and finite");
        }
        if ab.norm() < SIZES[0] || b.coords.amax() > SIZES[1] {
            return refuse("a micrometre or more from the corner before, and within 1000 km of the origin");
        }
        turned += ab.perp(&bc).atan2(ab.dot(&bc));
    }
    if turned > 1.5 * std::f64::consts::TAU {
        let allowed = "a simple polygon: these corners go round more than once";
        return Err(FieldError::new("vertices", format!("{vertices:?}"), allowed));
    }
    Ok(())
}

/// A solid: a shape and where it stands, or where it now is if it moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// Its outline.
    pub shape: Shape,
    /// Position of the outline's origin, metres.
    pub x: f64,
    /// Position of the outline's origin, metres.
    pub y: f64,
    /// Orientation, radians.
    pub yaw: f64,
}

impl Obstacle {
    /// Where it stands.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose::new([self.x, self.y].into(), self.yaw)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(vertices: &[[f64; 2]]) -> Shape {
        Shape::Polygon { vertices: vertices.to_vec() }
    }

    #[test]
    fn polygons_must_be_convex_counter_clockwise_and_simple() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!(polygon(&square).check().is_ok());
        let clockwise: Vec<_> = square.iter().rev().copied().collect();
        assert!(polygon(&clockwise).check().is_err());
        let dented = [[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]];
        let error = polygon(&dented).check().unwrap_err();
        assert_eq!(error.field, "vertices.2");
        let star: Vec<_> =
            (0..5).map(|k| (f64::from(k) * 0.8 * std::f64::consts::PI).sin_cos()).map(|(y, x)| [x, y]).collect();
        assert!(polygon(&star).check().is_err());
        assert!(polygon(&[[0.0, 0.0], [f64::NAN, 0.0], [0.0, 1.0]]).check().is_err());
        assert!(polygon(&square[..2]).check().is_err());
    }

    #[test]
    fn corners_that_hardly_turn_are_refused() {
        // Parry drops these corners, or is left with no polygon at all.
        for sliver in [[[0.0, 0.0], [10.0, 0.0], [5.0, 1e-8]], [[0.0, 0.0], [1.0, 0.0], [0.5, 4e-4]]] {
            assert!(polygon(&sliver).check().is_err());
        }
        assert!(polygon(&[[0.0, 0.0], [1e-7, 0.0], [0.0, 1e-7]]).check().is_err());
        assert!(polygon(&[[0.0, 0.0], [1e7, 0.0], [0.0, 1e7]]).check().is_err());
        for radius in [1e-9, 1e9] {
            assert!(Shape::Disc { radius }.check().is_err());
        }
    }

    #[test]
    fn parry_keeps_all_corners_that_are_allowed() {
        for n in [3, 60, 3000] {
            let corner = |k| (f64::from(k) / f64::from(n) * std::f64::consts::TAU).sin_cos();
            for scale in [1e-3, 1.0, 1e5] {
                let shape = polygon(&(0..n).map(corner).map(|(y, x)| [scale * x, scale * y]).collect::<Vec<_>>());
                assert!(shape.check().is_ok());
                assert_eq!(shape.polygon().unwrap().hull().n_corners(), n as usize);
            }
        }
    }
}
