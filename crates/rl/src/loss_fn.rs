//! How wrong a Q-value is.

use serde::{Deserialize, Serialize};

/// The loss of one TD error `e = Q(s, a) - y`, with `y` the target.
// The empty braces let serde reject unknown keys beside `type`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum LossFn {
    /// `e^2 / 2` where `|e| <= delta`, `delta (|e| - delta / 2)` beyond (Huber 1964). With `delta = 1` its gradient is
    /// the clipped error of Mnih et al. (2015).
    Huber {
        /// Where the parabola turns into a line, in scaled reward; > 0.
        delta: f64,
    },
    /// `e^2`: eq. (2) of Liu et al., literally.
    Mse {},
}

impl LossFn {
    /// The loss of one error.
    ///
    /// ```
    /// use headway_rl::LossFn;
    /// let huber = LossFn::Huber { delta: 1.0 };
    /// assert_eq!(huber.value(0.5), 0.125);
    /// assert_eq!(huber.value(-3.0), 2.5);
    /// assert_eq!(LossFn::Mse {}.value(-3.0), 9.0);
    /// ```
    pub fn value(self, error: f32) -> f32 {
        match self {
            Self::Huber { delta } => {
                let delta = delta as f32;
                // The part of the error inside the parabola, and the part on the line.
                let inside = error.abs().min(delta);
                0.5 * inside * inside + delta * (error.abs() - inside)
            }
            Self::Mse {} => error * error,
        }
    }

    /// The derivative of the loss with respect to the error, and so to `Q(s, a)`.
    ///
    /// ```
    /// use headway_rl::LossFn;
    /// let huber = LossFn::Huber { delta: 1.0 };
    /// assert_eq!([huber.gradient(0.5), huber.gradient(3.0), huber.gradient(-3.0)], [0.5, 1.0, -1.0]);
    /// assert_eq!(LossFn::Mse {}.gradient(-3.0), -6.0);
    /// ```
    pub fn gradient(self, error: f32) -> f32 {
        match self {
            Self::Huber { delta } => error.clamp(-delta as f32, delta as f32),
            Self::Mse {} => 2.0 * error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn huber_by_hand_with_delta_two() {
        let huber = LossFn::Huber { delta: 2.0 };
        for (error, value, gradient) in
            [(0.0, 0.0, 0.0), (1.0, 0.5, 1.0), (-2.0, 2.0, -2.0), (5.0, 8.0, 2.0), (-5.0, 8.0, -2.0)]
        {
            assert_eq!(huber.value(error), value);
            assert_eq!(huber.gradient(error), gradient);
        }
    }

    proptest! {
        #[test]
        fn the_gradient_is_the_slope_of_the_value(error in -5.0..5.0f32, delta in 0.1..4.0f64) {
            for loss in [LossFn::Huber { delta }, LossFn::Mse {}] {
                let h = 1e-2;
                let slope = (loss.value(error + h) - loss.value(error - h)) / (2.0 * h);
                prop_assert!((slope - loss.gradient(error)).abs() < 1e-2, "{slope} at {error}");
            }
        }
    }
}
