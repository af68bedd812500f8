//! Angles.

use std::f64::consts::{PI, TAU};

/// The angle equal to `angle` modulo a full turn, in (-pi, pi].
///
/// ```
/// use std::f64::consts::PI;
/// assert_eq!(headway_sim::wrap(PI), PI);
/// assert_eq!(headway_sim::wrap(-PI), PI);
/// assert!((headway_sim::wrap(3.0 * PI / 2.0) + PI / 2.0).abs() < 1e-12);
/// ```
#[must_use]
pub fn wrap(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}
