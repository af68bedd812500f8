//! Poses in three dimensions.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use super::xml::{exactly, refusal};
use crate::FieldError;
use crate::files::FileError;
use crate::files::error::quoted;

/// A pose in three dimensions that remembers a yaw to the last bit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pose: Isometry3<f64>,
    /// The rotation, where it is known to be one about z.
    yaw: Option<f64>,
}

impl Frame {
    pub(super) fn identity() -> Self {
        Self { pose: Isometry3::identity(), yaw: Some(0.0) }
    }

    /// A frame of a rotation alone.
    pub(super) fn turned(rotation: UnitQuaternion<f64>) -> Self {
        Self { pose: Isometry3::from_parts(Translation3::identity(), rotation), yaw: None }
    }

    /// What a `<pose>` says: x, y, z and roll, pitch, yaw, or x, y, z and a quaternion x, y, z, w.
    pub(super) fn parse(node: Node<'_, '_>) -> Result<Self, FileError> {
        let format = node.attribute("rotation_format").unwrap_or("euler_rpy");
        let is_empty = node.text().unwrap_or_default().trim().is_empty() && !node.has_children();
        match format {
            _ if is_empty => Ok(Self::identity()),
            "euler_rpy" => {
                let in_degrees = matches!(node.attribute("degrees"), Some("true" | "1"));
                let [x, y, z, roll, pitch, yaw] = exactly(node)?;
                let [roll, pitch, yaw] = [roll, pitch, yaw].map(|a| if in_degrees { a.to_radians() } else { a });
                let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
                let yaw = (roll == 0.0 && pitch == 0.0).then_some(yaw);
                Ok(Self { pose: Isometry3::from_parts(Translation3::new(x, y, z), rotation), yaw })
            }
            "quat_xyzw" => {
                let [x, y, z, i, j, k, w] = exactly(node)?;
                let quaternion = Quaternion::new(w, i, j, k);
                let rotation = UnitQuaternion::try_new(quaternion, 1e-6).ok_or_else(|| {
                    refusal(node, FieldError::new("pose", "a quaternion of length 0", "a rotation, other than 0"))
                })?;
                Ok(Self { pose: Isometry3::from_parts(Translation3::new(x, y, z), rotation), yaw: None })
            }
            other => {
                let allowed = "euler_rpy or quat_xyzw";
                Err(refusal(node, FieldError::new("rotation_format", quoted(other), allowed)))
            }
        }
    }

    /// A frame given in this one. Where one of the two is the identity, the other comes out bit for bit.
    pub(super) fn then(&self, inner: &Self) -> Self {
        if self.is_identity() {
            return *inner;
        }
        if inner.is_identity() {
            return *self;
        }
        let yaw = self.yaw.zip(inner.yaw).map(|(outer, inner)| outer + inner);
        Self { pose: self.pose * inner.pose, yaw }
    }

    /// The outer frame, given in this one.
    pub(super) fn inverse(&self) -> Self {
        Self { pose: self.pose.inverse(), yaw: self.yaw.map(|yaw| -yaw) }
    }

    fn is_identity(&self) -> bool {
        self.yaw == Some(0.0) && self.pose.translation == Translation3::identity()
    }

    pub(super) fn pose(&self) -> &Isometry3<f64> {
        &self.pose
    }

    /// Where its origin is.
    pub(super) fn origin(&self) -> Vector3<f64> {
        self.pose.translation.vector
    }

    /// Its z axis, seen from outside.
    pub(super) fn up(&self) -> Vector3<f64> {
        self.pose.rotation * Vector3::z()
    }

    /// The angle about z, if that is all its rotation.
    pub(super) fn yaw(&self) -> Option<f64> {
        self.yaw.or_else(|| (self.up().z > 1.0 - 1e-12).then(|| self.heading()))
    }

    /// The direction of its x axis in the plane, whether it stands upright or on its head.
    pub(super) fn vertical_heading(&self) -> Option<f64> {
        self.yaw.or_else(|| (self.up().z.abs() > 1.0 - 1e-12).then(|| self.heading()))
    }

    fn heading(&self) -> f64 {
        let forward = self.pose.rotation * Vector3::x();
        forward.y.atan2(forward.x)
    }
}
