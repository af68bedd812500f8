//! How sure an interval is to be.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crate::StatsError;

/// The confidence of a two-sided interval, in percent; 95 % by default.
///
/// ```
/// use headway_stats::Confidence;
///
/// assert_eq!(Confidence::default(), Confidence::percent(95.0)?);
/// assert_eq!(Confidence::default().tails(), (0.025, 0.975));
/// assert!((Confidence::percent(99.0)?.z() - 2.575_829_303_548_901).abs() < 1e-14);
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Confidence {
    percent: f64,
}

impl Confidence {
    /// A confidence of `percent`, above 0 and below 100.
    ///
    /// # Errors
    /// If it is not.
    pub fn percent(percent: f64) -> Result<Self, StatsError> {
        if percent > 0.0 && percent < 100.0 {
            Ok(Self { percent })
        } else {
            Err(StatsError::Number { what: "confidence", value: percent, allowed: "above 0 % and below 100 %" })
        }
    }

    /// The probabilities that lie below the interval's lower and upper end.
    pub fn tails(self) -> (f64, f64) {
        // In percent, so that decimal confidences have the nearest numbers to their decimal tails.
        ((100.0 - self.percent) / 200.0, (100.0 + self.percent) / 200.0)
    }

    /// The quantile of the standard normal distribution at the upper end: z with `P(|Z| <= z)` = the confidence.
    ///
    /// Newton's method on the upper tail `Q(z) = erfc(z / sqrt 2) / 2`, which is convex for z > 0: from z = 0 it rises
    /// to the solution and never passes it.
    pub fn z(self) -> f64 {
        let (tail, _) = self.tails();
        let mut z = 0.0_f64;
        loop {
            let density = (-0.5 * z * z).exp() / (2.0 * PI).sqrt();
            let next = z + (0.5 * libm::erfc(z * FRAC_1_SQRT_2) - tail) / density;
            if next <= z {
                return z;
            }
            z = next;
        }
    }
}

impl Default for Confidence {
    fn default() -> Self {
        Self { percent: 95.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // NIST/SEMATECH handbook, 1.3.6.7.1, with more digits.
        for (percent, z) in [
            (50.0, 0.674_489_750_196_081_7),
            (90.0, 1.644_853_626_951_472_2),
            (95.0, 1.959_963_984_540_054),
            (99.9, 3.290_526_731_491_926),
            (99.999_999, 5.730_728_868_236_294),
        ] {
            let found = Confidence::percent(percent).unwrap().z();
            assert!((found - z).abs() < 1e-9 * z, "{found} at {percent} %");
        }
        assert_eq!(Confidence::default().z(), 1.959_963_984_540_054);
    }

    #[test]
    fn only_shares_of_a_hundred_are_allowed() {
        for percent in [0.0, 100.0, -5.0, f64::NAN, f64::INFINITY] {
            assert!(Confidence::percent(percent).is_err());
        }
        let error = Confidence::percent(950.0).unwrap_err();
        assert_eq!(error.to_string(), "confidence = 950: must be above 0 % and below 100 %");
    }
}
