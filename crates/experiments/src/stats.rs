//! Estimates over training seeds, or other units, and intervals of a single policy's rates.
//!
//! Between trained policies, the training *seed* is the unit: a policy's episodes share its luck, so pooled episodes would give
//! intervals that are far too narrow (Agarwal et al., 2021, "Deep Reinforcement Learning at the Edge of the Statistical
//! Precipice"). In a benchmark of few worlds, the *world* is, for the same reason.

mod clustered;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::Serialize;

pub use clustered::{Clustered, clustered};

/// Number of bootstrap resamples.
const N_RESAMPLES: usize = 10_000;
/// Fewest units for which an interval is given.
const MIN_UNITS: usize = 3;
/// The two-sided 97.5 % quantile of the standard normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// A mean with its 95 % interval; a field is `None` where it is undefined.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The mean; `None` if no value is defined.
    pub mean: Option<f64>,
    /// The lower end of the 95 % interval; `None` for fewer than three units.
    pub low: Option<f64>,
    /// The upper end of the 95 % interval; `None` for fewer than three units.
    pub high: Option<f64>,
    /// Number of units in which the value is defined, over which the mean is taken.
    pub n: usize,
}

/// The mean over units, such as training seeds, with its 95 % percentile bootstrap interval.
///
/// Units in which the value is undefined are left out, and [`Estimate::n`] says how many remain. The interval runs from
/// the 2.5 % to the 97.5 % quantile of the means of 10 000 resamples (Efron, 1979), drawn with a fixed random stream:
/// equal values, in equal order, give equal bytes.
///
/// ```
/// use headway_experiments::stats::over_units;
///
/// let estimate = over_units(&[Some(0.9), Some(1.0), None, Some(1.1)]);
/// assert_eq!(estimate.n, 3);
/// assert!((estimate.mean.unwrap() - 1.0).abs() < 1e-12);
/// assert!((estimate.low.unwrap() - 0.9).abs() < 1e-12 && (estimate.high.unwrap() - 1.1).abs() < 1e-12);
/// assert_eq!(over_units(&[Some(0.9), Some(1.0)]).low, None);
/// ```
pub fn over_units(values: &[Option<f64>]) -> Estimate {
    let defined: Vec<f64> = values.iter().copied().flatten().collect();
    let n = defined.len();
    let interval = (n >= MIN_UNITS).then(|| bootstrap_interval(&defined));
    Estimate {
        mean: (n > 0).then(|| mean(&defined)),
        low: interval.map(|(low, _)| low),
        high: interval.map(|(_, high)| high),
        n,
    }
}

/// The 95 % Wilson score interval of the share of successes in `n` independent trials (Wilson, 1927), low and high: for
/// the rates of *one* policy, where the episodes are the unit. `None` without a trial.
///
/// ```
/// use headway_experiments::stats::wilson;
///
/// let (low, high) = wilson(0, 10).unwrap();
/// assert_eq!(low, 0.0);
/// assert!((high - 0.2775).abs() < 1e-4);
/// ```
pub fn wilson(successes: usize, n: usize) -> Option<(f64, f64)> {
    (n > 0).then(|| wilson_of(successes as f64 / n as f64, n as f64))
}

/// That of a share `p` of `n` trials, which need be no whole number.
fn wilson_of(p: f64, n: f64) -> (f64, f64) {
    let centre = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    // The interval holds the rate; rounding must not say otherwise where the two meet, at 0 and 1.
    ((centre - half).clamp(0.0, p), (centre + half).clamp(p, 1.0))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn bootstrap_interval(values: &[f64]) -> (f64, f64) {
    let mut rng = ChaCha8Rng::from_seed(*b"headway bootstrap over the seeds");
    let n = values.len();
    let mut means: Vec<f64> =
        (0..N_RESAMPLES).map(|_| (0..n).map(|_| values[below(&mut rng, n)]).sum::<f64>() / n as f64).collect();
    means.sort_by(f64::total_cmp);
    (quantile(&means, 0.025), quantile(&means, 0.975))
}

/// A uniform index below `n`, by multiplication and shift; its bias of `n / 2^64` is of no account.
fn below(rng: &mut impl Rng, n: usize) -> usize {
    ((u128::from(rng.next_u64()) * n as u128) >> 64) as usize
}

/// The quantile of sorted values with linear interpolation (Hyndman & Fan, 1996, type 7).
fn quantile(sorted: &[f64], q: f64) -> f64 {
    let position = q * (sorted.len() - 1) as f64;
    let (i, rest) = (position as usize, position.fract());
    let next = sorted[(i + 1).min(sorted.len() - 1)];
    sorted[i] + rest * (next - sorted[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some(values: &[f64]) -> Vec<Option<f64>> {
        values.iter().copied().map(Some).collect()
    }

    /// The smallest means that 2.5 % and 97.5 % of all `n^n` resamples do not exceed.
    fn exact_interval(values: &[f64]) -> (f64, f64) {
        let n = values.len();
        let mut means: Vec<f64> = (0..n.pow(n as u32))
            .map(|code| (0..n).map(|k| values[code / n.pow(k as u32) % n]).sum::<f64>() / n as f64)
            .collect();
        means.sort_by(f64::total_cmp);
        let at = |q: f64| means[(q * means.len() as f64).ceil() as usize - 1];
        (at(0.025), at(0.975))
    }

    #[test]
    fn undefined_values_and_few_seeds() {
        let none = Estimate { mean: None, low: None, high: None, n: 0 };
        assert_eq!(over_units(&[]), none);
        assert_eq!(over_units(&[None, None, None]), none);
        assert_eq!(over_units(&some(&[1.0, 2.0])), Estimate { mean: Some(1.5), n: 2, ..none });
        assert_eq!(over_units(&[Some(1.0), None, Some(2.0)]), Estimate { mean: Some(1.5), n: 2, ..none });
    }

    #[test]
    fn equal_values_have_an_interval_of_no_width() {
        let estimate = over_units(&some(&[0.25; 5]));
        assert_eq!(estimate, Estimate { mean: Some(0.25), low: Some(0.25), high: Some(0.25), n: 5 });
    }

    #[test]
    fn three_seeds_span_their_range() {
        // Each extreme mean has a share of 1/27 > 2.5 % of the resamples.
        let estimate = over_units(&some(&[2.0, 5.0, 3.0]));
        assert_eq!((estimate.low, estimate.high), (Some(2.0), Some(5.0)));
    }

    #[test]
    fn agrees_with_the_exact_enumeration() {
        for values in [vec![0.3, 0.9, 0.4], vec![1.16, 1.02, 1.31, 0.98], vec![0.91, 0.985, 0.97, 0.93, 1.0]] {
            let estimate = over_units(&some(&values));
            let (low, high) = exact_interval(&values);
            assert!((estimate.low.unwrap() - low).abs() < 0.003, "{estimate:?} against {low}");
            assert!((estimate.high.unwrap() - high).abs() < 0.003, "{estimate:?} against {high}");
        }
    }

    #[test]
    fn approaches_the_normal_interval_for_many_seeds() {
        let values: Vec<f64> = (0..400).map(|i| f64::from(i) / 399.0).collect();
        let estimate = over_units(&some(&values));
        let standard_error = (1.0_f64 / 12.0 / 400.0).sqrt();
        assert!((estimate.high.unwrap() - 0.5 - Z * standard_error).abs() < 0.1 * standard_error);
        assert!((estimate.low.unwrap() - 0.5 + Z * standard_error).abs() < 0.1 * standard_error);
    }

    #[test]
    fn the_same_every_time() {
        let values = some(&[0.1, 0.5, 0.2, 0.9]);
        assert_eq!(over_units(&values), over_units(&values));
    }

    #[test]
    fn wilson_against_published_values() {
        // Newcombe (1998), table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
        for (successes, n, low, high) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
        {
            let interval = wilson(successes, n).unwrap();
            assert!((interval.0 - low).abs() < 6e-5, "{interval:?}");
            assert!((interval.1 - high).abs() < 6e-5, "{interval:?}");
        }
        assert_eq!(wilson(7, 7).unwrap().1, 1.0);
        assert_eq!(wilson(0, 0), None);
    }
}
