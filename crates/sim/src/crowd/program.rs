//! Linear programmes in the plane: the velocity that half-planes allow and that is nearest to a wanted one.
//!
//! Incremental, as in de Berg et al., *Computational Geometry*, chapter 4, and in van den Berg, Guy, Lin and Manocha 2011,
//! section 5: every half-plane in turn either holds already, or the optimum moves to its line.

use nalgebra::Vector2;

/// The velocities `v` with `v . normal >= offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HalfPlane {
    /// Of length 1.
    pub(super) normal: Vector2<f64>,
    /// m/s.
    pub(super) offset: f64,
}

impl HalfPlane {
    /// How far a velocity lies outside, m/s; negative inside.
    pub(super) fn violation(&self, velocity: &Vector2<f64>) -> f64 {
        self.offset - self.normal.dot(velocity)
    }
}

/// What is best.
#[derive(Clone, Copy)]
enum Aim {
    /// The least distance to a velocity.
    Near(Vector2<f64>),
    /// The farthest along a unit vector.
    Along(Vector2<f64>),
}

/// Cross products below this are those of parallel lines.
const PARALLEL: f64 = 1e-9;

/// The velocity of at most `most` m/s nearest to `wanted` that all half-planes allow. Where there is none, one that the first
/// `n_hard` allow and that violates the others as little as can be: the greatest violation is least (section 5.3 there).
///
/// The hard ones must leave something: each of them holds velocity 0, say.
pub(super) fn nearest_allowed(planes: &[HalfPlane], n_hard: usize, most: f64, wanted: &Vector2<f64>) -> Vector2<f64> {
    match best(planes, most, Aim::Near(*wanted)) {
        Ok(velocity) => velocity,
        Err((failed, velocity)) => least_violating(planes, n_hard, failed, most, velocity),
    }
}

/// The best velocity; or the half-plane that left none, and the best before it.
fn best(planes: &[HalfPlane], most: f64, aim: Aim) -> Result<Vector2<f64>, (usize, Vector2<f64>)> {
    let mut velocity = match aim {
        Aim::Near(wanted) => wanted.cap_magnitude(most),
        Aim::Along(direction) => direction * most,
    };
    for (i, plane) in planes.iter().enumerate() {
        if plane.violation(&velocity) > 0.0 {
            velocity = best_on_line(&planes[..i], plane, most, aim).ok_or((i, velocity))?;
        }
    }
    Ok(velocity)
}

/// The best velocity on the line of a half-plane that others allow.
fn best_on_line(others: &[HalfPlane], line: &HalfPlane, most: f64, aim: Aim) -> Option<Vector2<f64>> {
    let (origin, along) = (line.normal * line.offset, Vector2::new(line.normal.y, -line.normal.x));
    let half_chord_squared = most * most - line.offset * line.offset;
    if half_chord_squared < 0.0 {
        return None;
    }
    let (mut low, mut high) = (-half_chord_squared.sqrt(), half_chord_squared.sqrt());
    for other in others {
        let (rate, lack) = (other.normal.dot(&along), other.violation(&origin));
        if rate.abs() <= PARALLEL {
            if lack > 0.0 {
                return None;
            }
        } else if rate > 0.0 {
            low = low.max(lack / rate);
        } else {
            high = high.min(lack / rate);
        }
    }
    if low > high {
        return None;
    }
    let t = match aim {
        Aim::Near(wanted) => along.dot(&(wanted - origin)).clamp(low, high),
        Aim::Along(direction) => {
            if direction.dot(&along) > 0.0 {
                high
            } else {
                low
            }
        }
    };
    Some(origin + along * t)
}

/// The velocity of least greatest violation: a linear programme in three dimensions, the third one the violation, solved
/// half-plane by half-plane on the planes where two of them are violated equally.
fn least_violating(
    planes: &[HalfPlane],
    n_hard: usize,
    from: usize,
    most: f64,
    mut velocity: Vector2<f64>,
) -> Vector2<f64> {
    let mut greatest = 0.0;
    let mut projected = Vec::with_capacity(planes.len());
    for (i, worst) in planes.iter().enumerate().skip(from.max(n_hard)) {
        if worst.violation(&velocity) <= greatest {
            continue;
        }
        projected.clear();
        projected.extend_from_slice(&planes[..n_hard]);
        projected.extend(planes[n_hard..i].iter().filter_map(|other| no_worse(other, worst)));
        // What fails here failed by rounding: the optimum is where it was.
        if let Ok(better) = best(&projected, most, Aim::Along(worst.normal)) {
            velocity = better;
        }
        greatest = worst.violation(&velocity);
    }
    velocity
}

/// The velocities that violate `one` no more than `other`; all of them, `None`, where the two lines are parallel.
fn no_worse(one: &HalfPlane, other: &HalfPlane) -> Option<HalfPlane> {
    let normal = one.normal - other.normal;
    let length = normal.norm();
    (length > PARALLEL).then(|| HalfPlane { normal: normal / length, offset: (one.offset - other.offset) / length })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn plane(angle: f64, offset: f64) -> HalfPlane {
        HalfPlane { normal: Vector2::new(angle.cos(), angle.sin()), offset }
    }

    #[test]
    fn by_hand() {
        let right = plane(0.0, 0.5); // x >= 0.5
        let near = |planes: &[HalfPlane], x, y| nearest_allowed(planes, 0, 1.0, &Vector2::new(x, y));
        assert_eq!(near(&[], 0.3, 0.4), Vector2::new(0.3, 0.4));
        assert!((near(&[], 3.0, 4.0) - Vector2::new(0.6, 0.8)).norm() < 1e-12);
        assert_eq!(near(&[right], 0.7, 0.1), Vector2::new(0.7, 0.1));
        assert!((near(&[right], -0.2, 0.1) - Vector2::new(0.5, 0.1)).norm() < 1e-12);
        // x >= 0.6 and x <= 0.2 leave nothing: 0.4 lacks 0.2 of both.
        let torn = near(&[plane(0.0, 0.6), plane(std::f64::consts::PI, -0.2)], 0.0, 0.0);
        assert!((torn.x - 0.4).abs() < 1e-9);
        // A hard one is kept.
        let kept = nearest_allowed(&[plane(std::f64::consts::PI, -0.2), plane(0.0, 0.6)], 1, 1.0, &Vector2::zeros());
        assert!((kept.x - 0.2).abs() < 1e-9);
    }

    proptest! {
        /// Against all velocities of a fine grid.
        #[test]
        fn nothing_is_better(
            planes in prop::collection::vec((-3.1..3.1, -1.2..0.9), 0..6),
            hard in prop::collection::vec((-3.1..3.1, -1.0..-0.05), 0..3),
            wanted in (-1.0..1.0, -1.0..1.0),
        ) {
            let all: Vec<_> = hard.iter().chain(&planes).map(|(angle, offset)| plane(*angle, *offset)).collect();
            let (hard, soft) = all.split_at(hard.len());
            let wanted = Vector2::new(wanted.0, wanted.1);
            let found = nearest_allowed(&all, hard.len(), 1.0, &wanted);
            let lack = |planes: &[HalfPlane], v: &Vector2<f64>| planes.iter().map(|p| p.violation(v)).fold(0.0, f64::max);
            prop_assert!(found.norm() <= 1.0 + 1e-9 && lack(hard, &found) < 1e-9);
            let (n, reach) = (60, 1.0);
            let at = |k: i32| f64::from(k) / f64::from(n) * reach;
            for (i, j) in (-n..=n).flat_map(|i| (-n..=n).map(move |j| (i, j))) {
                let other = Vector2::new(at(i), at(j));
                if other.norm() <= 1.0 && lack(hard, &other) == 0.0 {
                    prop_assert!(lack(soft, &found) <= lack(soft, &other) + 1e-9);
                    let is_allowed = lack(soft, &other) == 0.0;
                    prop_assert!(!is_allowed || (found - wanted).norm() <= (other - wanted).norm() + 1e-9);
                }
            }
        }
    }
}
