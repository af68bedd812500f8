//! Exact motion at constant speed and yaw rate.

use nalgebra::{UnitComplex, Vector2};

use crate::{Pose, Twist};

/// Where a unicycle is after driving at constant `speed` and `yaw_rate` for `time` seconds.
///
/// The arc's chord is `v t sinc(w t / 2)` long and points half the turn to the left, which holds for
/// any yaw rate, 0 included.
///
/// ```
/// use headway_sim::{arc, Pose};
/// use std::f64::consts::{FRAC_PI_2, PI};
/// // A quarter circle of radius 2 m to the left: from the origin to (2, 2), facing +y.
/// let end = arc(&Pose::identity(), PI, FRAC_PI_2, 1.0);
/// assert!((end.translation.vector - nalgebra::Vector2::new(2.0, 2.0)).norm() < 1e-12);
/// assert!((end.rotation.angle() - FRAC_PI_2).abs() < 1e-12);
/// ```
#[must_use]
#[inline]
pub fn arc(pose: &Pose, speed: f64, yaw_rate: f64, time: f64) -> Pose {
    let half = yaw_rate * time / 2.0;
    let (sinc, cos) = sinc_cos(half);
    let sin = half * sinc;
    let chord = pose.rotation * Vector2::new(cos, sin) * (speed * time * sinc);
    let turn = UnitComplex::from_cos_sin_unchecked(cos * cos - sin * sin, 2.0 * sin * cos);
    Pose::from_parts((pose.translation.vector + chord).into(), pose.rotation * turn)
}

/// Where something is after moving at a constant velocity of its own frame for `time` seconds: [`arc`] with sideways motion.
///
/// ```
/// use headway_sim::{glide, Pose, Twist};
/// use std::f64::consts::{FRAC_PI_2, PI};
/// // Leftwards while turning left: a quarter circle around the point 2 m behind.
/// let end = glide(&Pose::identity(), &Twist::new(0.0, PI, FRAC_PI_2), 1.0);
/// assert!((end.translation.vector - nalgebra::Vector2::new(-2.0, 2.0)).norm() < 1e-12);
/// ```
#[must_use]
pub fn glide(pose: &Pose, twist: &Twist, time: f64) -> Pose {
    let ahead = arc(pose, 1.0, twist.z, time);
    let chord = ahead.translation.vector - pose.translation.vector;
    let left = Vector2::new(-chord.y, chord.x);
    let moved = pose.translation.vector + chord * twist.x + left * twist.y;
    Pose::from_parts(moved.into(), ahead.rotation)
}

/// `sin(x) / x` and `cos(x)`: by their power series for the small turns of a substep, which is several times faster.
fn sinc_cos(x: f64) -> (f64, f64) {
    // The first terms left out are below 2e-19.
    const MOST: f64 = 0.06;
    const SINC: [f64; 5] = [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0];
    const COS: [f64; 5] = [1.0, -0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0];
    if x.abs() > MOST {
        let (sin, cos) = x.sin_cos();
        return (sin / x, cos);
    }
    let square = x * x;
    let horner = |coefficients: &[f64; 5]| coefficients.iter().rev().fold(0.0, |sum, c| sum * square + c);
    (horner(&SINC), horner(&COS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_series_are_as_good_as_the_functions(x in -0.07..0.07_f64) {
            let (sinc, cos) = sinc_cos(x);
            prop_assert!((sinc * x - x.sin()).abs() <= x.abs() * 2.0 * f64::EPSILON);
            prop_assert!((cos - x.cos()).abs() <= f64::EPSILON);
        }

        #[test]
        fn arcs_compose(v in -2.0..2.0, w in -3.0..3.0, t in 0.0..2.0, share in 0.0..1.0) {
            let start = Pose::new([1.0, -2.0].into(), 0.7);
            let whole = arc(&start, v, w, t);
            let parts = arc(&arc(&start, v, w, share * t), v, w, (1.0 - share) * t);
            prop_assert!((whole.translation.vector - parts.translation.vector).norm() < 1e-9);
            prop_assert!(whole.rotation.angle_to(&parts.rotation).abs() < 1e-9);
        }

        #[test]
        fn arcs_agree_with_small_straight_steps(v in -2.0..2.0_f64, w in -3.0..3.0_f64) {
            let n = 20_000;
            let (mut x, mut y, mut yaw, h) = (0.0, 0.0, 0.0_f64, 1.0 / f64::from(n));
            for _ in 0..n {
                let middle: f64 = yaw + w * h / 2.0;
                x += v * middle.cos() * h;
                y += v * middle.sin() * h;
                yaw += w * h;
            }
            let end = arc(&Pose::identity(), v, w, 1.0).translation.vector;
            prop_assert!((end - nalgebra::Vector2::new(x, y)).norm() < 1e-7);
        }
    }
}
