//! Shapes as data: what specs and world files hold.

use serde::{Deserialize, Serialize};

use crate::{FieldError, Point, Pose, at_least, positive};

/// A closed rectangle of walls around `[0, width] x [0, height]`, metres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Room {
    /// Extent along x, metres.
    pub width: f64,
    /// Extent along y, metres.
    pub height: f64,
}

impl Room {
    /// Checks the extents.
    ///
    /// # Errors
    /// Names an extent that is not a finite number above 0.
    pub fn check(&self) -> Result<(), FieldError> {
        positive("width", self.width)?;
        positive("height", self.height)
    }
}

/// A solid convex outline in its own frame.
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
        /// At least three corners `[x, y]` in metres, counter-clockwise, strictly convex.
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
            Self::Disc { radius } => positive("radius", *radius),
            Self::Box { length, width } => {
                positive("length", *length)?;
                positive("width", *width)
            }
            Self::Polygon { vertices } => check_polygon(vertices),
        }
    }
}

fn check_polygon(vertices: &[[f64; 2]]) -> Result<(), FieldError> {
    at_least("vertices.len", vertices.len(), 3)?;
    let n = vertices.len();
    let mut turned = 0.0;
    for i in 0..n {
        let [a, b, c] = [0, 1, 2].map(|k| Point::from(vertices[(i + k) % n]));
        let (ab, bc) = (b - a, c - b);
        let sine = ab.perp(&bc) / (ab.norm() * bc.norm());
        if sine.is_nan() || sine < 1e-9 {
            let place = format!("vertices.{}", (i + 1) % n);
            let allowed = "a left turn: list the corners counter-clockwise, strictly convex and finite";
            return Err(FieldError::new(place, format!("[{}, {}]", b.x, b.y), allowed));
        }
        turned += ab.perp(&bc).atan2(ab.dot(&bc));
    }
    if turned > 1.5 * std::f64::consts::TAU {
        let allowed = "a simple polygon: these corners go round more than once";
        return Err(FieldError::new("vertices", format!("{vertices:?}"), allowed));
    }
    Ok(())
}

/// A static solid: a shape and where it stands.
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
}
