//! Convex polygons as parry sees them.

use std::sync::Arc;

use parry2d::math::{Pose as ParryPose, Rotation, Vector};
use parry2d::query;
use parry2d::shape::ConvexPolygon;

use crate::{Point, Pose};

/// A convex polygon in parry's terms, made once in its own frame: moving it moves the frame.
#[derive(Debug, Clone)]
pub(crate) struct Hull {
    polygon: Arc<ConvexPolygon>,
    frame: ParryPose,
}

impl Hull {
    /// From a checked shape's corners, of which parry keeps every one.
    pub(crate) fn new(vertices: &[Point]) -> Self {
        let points = vertices.iter().map(|p| Vector::new(p.x, p.y)).collect();
        let polygon = ConvexPolygon::from_convex_polyline(points).expect("a checked polygon's corners turn enough");
        Self { polygon: Arc::new(polygon), frame: ParryPose::identity() }
    }

    /// The same polygon moved to `pose`.
    pub(crate) fn at(&self, pose: &Pose) -> Self {
        Self { polygon: Arc::clone(&self.polygon), frame: to_parry(pose) * self.frame }
    }

    /// Moves the frame to `pose`.
    pub(crate) fn place(&mut self, pose: &Pose) {
        self.frame = to_parry(pose);
    }

    /// How many corners parry kept.
    #[cfg(test)]
    pub(crate) fn n_corners(&self) -> usize {
        self.polygon.points().len()
    }

    /// Whether another polygon, moved to `pose`, touches or overlaps this one.
    pub(crate) fn touches(&self, other: &Self, pose: &Pose) -> bool {
        let (a, b) = (self.polygon.as_ref(), other.polygon.as_ref());
        let found = query::intersection_test(&self.frame, a, &(to_parry(pose) * other.frame), b);
        found.expect("parry knows convex polygons").intersecting
    }

    /// The signed distance to another polygon, moved to `pose`, metres, negative where they overlap: GJK outside, EPA inside.
    pub(crate) fn signed_distance(&self, other: &Self, pose: &Pose) -> f64 {
        let (a, b, frame) = (self.polygon.as_ref(), other.polygon.as_ref(), to_parry(pose) * other.frame);
        let apart = query::distance(&self.frame, a, &frame, b).expect("parry measures convex polygons");
        if apart.distance > 0.0 {
            return apart.distance;
        }
        let contact = query::contact(&self.frame, a, &frame, b, 0.0).expect("parry measures convex polygons");
        contact.map_or(0.0, |contact| contact.dist.min(0.0))
    }
}

/// The one place where our poses become parry's.
fn to_parry(pose: &Pose) -> ParryPose {
    let (translation, rotation) = (pose.translation.vector, pose.rotation);
    ParryPose::from_parts(Vector::new(translation.x, translation.y), Rotation { re: rotation.re, im: rotation.im })
}
