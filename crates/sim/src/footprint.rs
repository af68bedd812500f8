//! The outline of a vehicle.

use crate::geometry::Polygon;
use crate::{FieldError, Point, Shape};

/// The checked outline of a vehicle, which holds the vehicle's origin inside.
#[derive(Debug, Clone)]
pub struct Footprint {
    shape: Shape,
    circumradius: f64,
    polygon: Option<Polygon>,
}

impl Footprint {
    /// Builds an outline from its shape.
    ///
    /// # Errors
    /// Names what is wrong with the shape; a polygon must hold the origin strictly inside.
    pub fn new(shape: &Shape) -> Result<Self, FieldError> {
        shape.check()?;
        let polygon = shape.polygon();
        if let Some(polygon) = &polygon
            && polygon.signed_distance(&Point::origin()) >= 0.0
        {
            let allowed = "an outline around the vehicle's origin (0, 0)";
            return Err(FieldError::new("vertices", format!("{:?}", polygon.vertices()), allowed));
        }
        Ok(Self { shape: shape.clone(), circumradius: shape.circumradius(), polygon })
    }

    /// A disc around the origin. A radius of 0 is a point.
    pub(crate) fn disc(radius: f64) -> Self {
        Self { shape: Shape::Disc { radius }, circumradius: radius, polygon: None }
    }

    /// The outline of a checked shape that need not hold its origin: an obstacle looked at as a footprint.
    pub(crate) fn of_obstacle(shape: &Shape) -> Self {
        Self { shape: shape.clone(), circumradius: shape.circumradius(), polygon: shape.polygon() }
    }

    /// The shape it was built from.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The distance from the origin to the farthest point, metres.
    #[must_use]
    pub fn circumradius(&self) -> f64 {
        self.circumradius
    }

    /// The distance from the origin to the nearest point of the outline, metres.
    #[must_use]
    pub fn inradius(&self) -> f64 {
        self.polygon.as_ref().map_or(self.circumradius, |polygon| -polygon.signed_distance(&Point::origin()))
    }

    /// How far a point of the outline moves when the footprint turns, metres per radian at most:
    /// 0 for a disc, which turns onto itself.
    #[must_use]
    pub fn turning_radius(&self) -> f64 {
        if self.polygon.is_some() { self.circumradius } else { 0.0 }
    }

    /// The distance from the origin to the outline in a direction of the vehicle's frame, metres.
    ///
    /// ```
    /// use headway_sim::{Footprint, Shape};
    /// let jackal = Footprint::new(&Shape::Box { length: 0.5, width: 0.4 })?;
    /// assert!((jackal.extent(0.0) - 0.25).abs() < 1e-12);
    /// assert!((jackal.extent(std::f64::consts::FRAC_PI_2) - 0.2).abs() < 1e-12);
    /// # Ok::<(), headway_sim::FieldError>(())
    /// ```
    #[must_use]
    pub fn extent(&self, direction: f64) -> f64 {
        let (sin, cos) = direction.sin_cos();
        match &self.polygon {
            None => self.circumradius,
            Some(polygon) => polygon.exit(&[cos, sin].into()),
        }
    }

    pub(crate) fn polygon(&self) -> Option<&Polygon> {
        self.polygon.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_origin_must_be_inside() {
        let vertices = vec![[1.0, 0.0], [2.0, 0.0], [2.0, 1.0]];
        assert!(Footprint::new(&Shape::Polygon { vertices }).is_err());
    }

    #[test]
    fn extents_end_on_the_outline() {
        let vertices = vec![[-0.3, -0.2], [0.4, -0.1], [0.2, 0.3]];
        let triangle = Footprint::new(&Shape::Polygon { vertices }).unwrap();
        for k in 0..36 {
            let direction = f64::from(k) / 36.0 * std::f64::consts::TAU;
            let (sin, cos) = direction.sin_cos();
            let end = Point::new(cos, sin) * triangle.extent(direction);
            assert!(triangle.polygon().unwrap().signed_distance(&end).abs() < 1e-12);
        }
    }
}
