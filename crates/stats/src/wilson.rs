//! The interval of a rate.

use crate::{Confidence, Interval, StatsError};

/// The Wilson score interval of the share p of successes in n *independent* trials (Wilson, 1927, "Probable Inference,
/// the Law of Succession, and Statistical Inference"):
/// `(p + z^2/2n ± z sqrt(p (1 - p)/n + z^2/4n^2)) / (1 + z^2/n)`, within [0, 1].
///
/// For the rates of *one* policy, whose episodes in scenarios of their own are the unit. Where several episodes share a
/// scenario, see [`cluster_bootstrap`](crate::cluster_bootstrap); over several seeds,
/// [`over_seeds`](crate::over_seeds).
///
/// # Errors
/// If there is no trial, or fewer trials than successes.
///
/// ```
/// use headway_stats::{Confidence, wilson};
///
/// let none = wilson(0, 10, Confidence::default())?;
/// assert_eq!((none.point, none.low), (0.0, 0.0));
/// assert!((none.high - 0.2775).abs() < 1e-4);
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
pub fn wilson(successes: usize, n: usize, confidence: Confidence) -> Result<Interval, StatsError> {
    if n == 0 {
        return Err(StatsError::Empty { what: "trials" });
    }
    if successes > n {
        return Err(StatsError::Successes { successes, n });
    }
    let (p, n, z) = (successes as f64 / n as f64, n as f64, confidence.z());
    let centre = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let half = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    // The interval holds the rate; rounding must not say otherwise where the two meet, at 0 and 1.
    Ok(Interval { point: p, low: (centre - half).clamp(0.0, p), high: (centre + half).clamp(p, 1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_published_values() {
        // Newcombe (1998), table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
        for (successes, n, low, high) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
        {
            let interval = wilson(successes, n, Confidence::default()).unwrap();
            assert!((interval.low - low).abs() < 6e-5, "{interval:?}");
            assert!((interval.high - high).abs() < 6e-5, "{interval:?}");
        }
        assert_eq!(wilson(7, 7, Confidence::default()).unwrap().high, 1.0);
    }

    #[test]
    fn its_ends_are_the_rates_whose_score_test_just_rejects() {
        // (p - end)^2 = z^2 end (1 - end) / n, what the interval is the solution of.
        for percent in [50.0, 90.0, 99.0] {
            let confidence = Confidence::percent(percent).unwrap();
            let interval = wilson(13, 40, confidence).unwrap();
            for end in [interval.low, interval.high] {
                let score = (interval.point - end) / (end * (1.0 - end) / 40.0).sqrt();
                assert!((score.abs() - confidence.z()).abs() < 1e-9, "{score}");
            }
        }
    }

    #[test]
    fn impossible_counts_are_refused() {
        let of = |successes, n| wilson(successes, n, Confidence::default()).unwrap_err().to_string();
        assert_eq!(of(0, 0), "trials: must be at least one");
        assert_eq!(of(3, 2), "successes = 3: must be from 0 to the number of trials, 2");
    }
}
