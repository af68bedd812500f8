//! Quantities that change along the training, as functions of its progress in `[0, 1]`.

use serde::{Deserialize, Serialize};

/// The learning rate, falling (or rising) linearly over the whole training.
///
/// `at(p) = start + p (end - start)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearningRate {
    /// The rate at the first env step; > 0.
    pub start: f64,
    /// The rate at the last env step; >= 0.
    pub end: f64,
}

/// The probability of a random action, falling linearly over a first fraction of the training and constant after.
///
/// `at(p) = start + min(p / fraction, 1) (end - start)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Epsilon {
    /// The probability at the first env step, in `[0, 1]`.
    pub start: f64,
    /// The probability after `fraction` of the training, in `[0, 1]`.
    pub end: f64,
    /// The fraction of the training's env steps over which it falls, in `(0, 1]`.
    pub fraction: f64,
}

impl LearningRate {
    /// The rate at a progress, which is clamped to `[0, 1]`.
    ///
    /// ```
    /// let rate = headway_rl::LearningRate { start: 0.003, end: 0.0003 };
    /// assert_eq!(rate.at(0.0), 0.003);
    /// assert!((rate.at(0.5) - 0.00165).abs() < 1e-15);
    /// assert_eq!(rate.at(1.0), 0.0003);
    /// ```
    pub fn at(&self, progress: f64) -> f64 {
        lerp(self.start, self.end, progress)
    }
}

impl Epsilon {
    /// The probability at a progress, which is clamped to `[0, 1]`.
    ///
    /// ```
    /// let epsilon = headway_rl::Epsilon { start: 1.0, end: 0.02, fraction: 0.3 };
    /// assert_eq!(epsilon.at(0.0), 1.0);
    /// assert!((epsilon.at(0.15) - 0.51).abs() < 1e-12);
    /// assert_eq!(epsilon.at(0.3), 0.02);
    /// assert_eq!(epsilon.at(1.0), 0.02);
    /// ```
    pub fn at(&self, progress: f64) -> f64 {
        lerp(self.start, self.end, progress / self.fraction)
    }
}

/// Exact at both ends, so that a schedule's end is the number in the spec.
fn lerp(start: f64, end: f64, t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    start * (1.0 - t) + end * t
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn schedules_stay_between_their_ends(start in 0.0..1.0f64, end in 0.0..1.0f64, fraction in 0.01..1.0f64, p in -1.0..2.0f64) {
            let (low, high) = (start.min(end) - 1e-15, start.max(end) + 1e-15);
            let epsilon = Epsilon { start, end, fraction };
            prop_assert!((low..=high).contains(&epsilon.at(p)));
            let rate = LearningRate { start, end };
            prop_assert!((low..=high).contains(&rate.at(p)));
            prop_assert_eq!((rate.at(0.0), rate.at(1.0)), (start, end));
            prop_assert_eq!((epsilon.at(0.0), epsilon.at(1.0)), (start, end));
        }
    }
}
