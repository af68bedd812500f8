//! Starts and goals as they stand in files.

use nalgebra::{Complex, Unit};

use crate::check::within;
use crate::{FieldError, Point, Pose};

/// How far from the origin things may be, metres: far beyond what a room allows, so that the room's own error is seen.
const FAR: f64 = 1e7;

/// A coordinate or an angle that can be computed with.
pub(super) fn checked(field: &str, value: f64) -> Result<f64, FieldError> {
    within(field, value, -FAR, FAR).map(|()| value)
}

/// A start `[x, y, yaw]`, or, with every bit of the rotation, `[x, y, cos yaw, sin yaw]`.
pub(super) fn start(numbers: &[f64]) -> Result<Pose, FieldError> {
    for number in numbers {
        checked("start", *number)?;
    }
    match *numbers {
        [x, y, yaw] => Ok(Pose::new([x, y].into(), yaw)),
        [x, y, cos, sin] if (cos.hypot(sin) - 1.0).abs() <= 1e-6 => {
            let rotation = Unit::new_unchecked(Complex::new(cos, sin));
            Ok(Pose::from_parts([x, y].into(), rotation))
        }
        _ => {
            let allowed = "[x, y, yaw], or [x, y, cos, sin] of a yaw, metres and radians";
            Err(FieldError::new("start", format!("{numbers:?}"), allowed))
        }
    }
}

/// What [`start`] reads.
pub(super) fn start_numbers(start: &Pose) -> [f64; 4] {
    [start.translation.x, start.translation.y, start.rotation.re, start.rotation.im]
}

/// A goal `[x, y]`.
pub(super) fn goal(numbers: &[f64]) -> Result<Point, FieldError> {
    match *numbers {
        [x, y] => Ok(Point::new(checked("goal", x)?, checked("goal", y)?)),
        _ => Err(FieldError::new("goal", format!("{numbers:?}"), "[x, y], metres")),
    }
}
