//! One figure per training seed.

use serde::Serialize;

use crate::bootstrap::mean;
use crate::{Bootstrap, Interval, bootstrap};

/// Fewest units, such as training seeds, for which an interval means anything: 3.
pub const MIN_UNITS: usize = 3;

/// A mean over units, such as training seeds, with its interval; a field is `None` where it is undefined.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The mean; `None` if no value is defined.
    pub mean: Option<f64>,
    /// The lower end of the interval; `None` for fewer than [`MIN_UNITS`] units.
    pub low: Option<f64>,
    /// The upper end of the interval; `None` for fewer than [`MIN_UNITS`] units.
    pub high: Option<f64>,
    /// Number of units in which the value is defined, over which the mean is taken.
    pub n: usize,
}

/// The mean over units, such as training seeds, with its percentile bootstrap interval (Efron, 1979); for fewer than
/// [`MIN_UNITS`] without one.
///
/// Units in which the value is undefined are left out, and [`Estimate::n`] says how many remain. [`Bootstrap::default`] suits
/// tables: at 95 %, the interval runs from the 2.5 % to the 97.5 % quantile of the means of 10 000 resamples.
///
/// ```
/// use headway_stats::{Bootstrap, over_units};
///
/// let how = Bootstrap::default();
/// let estimate = over_units([Some(0.9), Some(1.0), None, Some(1.1)], &how);
/// assert_eq!(estimate.n, 3);
/// assert!((estimate.mean.unwrap() - 1.0).abs() < 1e-12);
/// assert!((estimate.low.unwrap() - 0.9).abs() < 1e-12 && (estimate.high.unwrap() - 1.1).abs() < 1e-12);
/// assert_eq!(over_units([Some(0.9), Some(1.0)], &how).low, None);
/// ```
pub fn over_units(values: impl IntoIterator<Item = Option<f64>>, how: &Bootstrap) -> Estimate {
    let defined: Vec<f64> = values.into_iter().flatten().collect();
    let n = defined.len();
    let enough = (n >= MIN_UNITS).then_some(&defined);
    let interval = enough.and_then(|units| bootstrap(units, mean, how).ok()).map(Interval::ends);
    Estimate {
        mean: (n > 0).then(|| mean(&defined)),
        low: interval.map(|(low, _)| low),
        high: interval.map(|(_, high)| high),
        n,
    }
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    use super::*;
    use crate::Confidence;

    fn of(values: &[f64]) -> Estimate {
        over_units(values.iter().copied().map(Some), &Bootstrap::default())
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
        let how = Bootstrap::default();
        assert_eq!(over_units([], &how), none);
        assert_eq!(over_units([None, None, None], &how), none);
        assert_eq!(of(&[1.0, 2.0]), Estimate { mean: Some(1.5), n: 2, ..none });
        assert_eq!(over_units([Some(1.0), None, Some(2.0)], &how), Estimate { mean: Some(1.5), n: 2, ..none });
    }

    #[test]
    fn equal_values_have_an_interval_of_no_width() {
        let estimate = of(&[0.25; 5]);
        assert_eq!(estimate, Estimate { mean: Some(0.25), low: Some(0.25), high: Some(0.25), n: 5 });
    }

    #[test]
    fn three_seeds_span_their_range() {
        // Each extreme mean has a share of 1/27 > 2.5 % of the resamples.
        let estimate = of(&[2.0, 5.0, 3.0]);
        assert_eq!((estimate.low, estimate.high), (Some(2.0), Some(5.0)));
    }

    #[test]
    fn agrees_with_the_exact_enumeration() {
        for values in [vec![0.3, 0.9, 0.4], vec![1.16, 1.02, 1.31, 0.98], vec![0.91, 0.985, 0.97, 0.93, 1.0]] {
            let estimate = of(&values);
            let (low, high) = exact_interval(&values);
            assert!((estimate.low.unwrap() - low).abs() < 0.003, "{estimate:?} against {low}");
            assert!((estimate.high.unwrap() - high).abs() < 0.003, "{estimate:?} against {high}");
        }
    }

    #[test]
    fn approaches_the_normal_interval_for_many_seeds() {
        let values: Vec<f64> = (0..400).map(|i| f64::from(i) / 399.0).collect();
        let estimate = of(&values);
        let standard_error = (1.0_f64 / 12.0 / 400.0).sqrt();
        assert!((estimate.high.unwrap() - 0.5 - 1.96 * standard_error).abs() < 0.1 * standard_error);
        assert!((estimate.low.unwrap() - 0.5 + 1.96 * standard_error).abs() < 0.1 * standard_error);
    }

    #[test]
    fn the_interval_is_that_of_the_bootstrap_asked_for() {
        let values = [0.1, 0.5, 0.2, 0.9];
        let how = Bootstrap::new(500, 3).unwrap().with_confidence(Confidence::percent(80.0).unwrap());
        let estimate = over_units(values.map(Some), &how);
        let (low, high) = bootstrap(&values, mean, &how).unwrap().ends();
        assert_eq!((estimate.low, estimate.high), (Some(low), Some(high)));
        assert_ne!(estimate, of(&values));
    }

    #[test]
    fn the_same_every_time() {
        let values = [0.1, 0.5, 0.2, 0.9];
        assert_eq!(of(&values), of(&values));
    }

    /// The interval of one loop, drawn as [`Bootstrap`] says, with nothing shared with it.
    fn plain_interval(values: &[f64]) -> (f64, f64) {
        let mut rng = ChaCha8Rng::from_seed(*b"headway bootstrap over the seeds");
        let n = values.len();
        let mut means = Vec::new();
        for _ in 0..10_000 {
            let index = |rng: &mut ChaCha8Rng| ((u128::from(rng.next_u64()) * n as u128) >> 64) as usize;
            means.push((0..n).map(|_| values[index(&mut rng)]).sum::<f64>() / n as f64);
        }
        means.sort_by(f64::total_cmp);
        let at = |q: f64| {
            let (i, rest) = ((q * 9_999.0) as usize, (q * 9_999.0).fract());
            means[i] + rest * (means[i + 1] - means[i])
        };
        (at(0.025), at(0.975))
    }

    #[test]
    fn reports_keep_their_bytes() {
        for n in [3, 4, 7, 10, 33] {
            let values: Vec<f64> = (0..n).map(|i| (f64::from(i) * 0.7).sin().abs()).collect();
            let estimate = of(&values);
            assert_eq!((estimate.low.unwrap(), estimate.high.unwrap()), plain_interval(&values));
        }
        let estimate = of(&[0.91, 0.985, 0.97, 0.93, 1.0]);
        assert_eq!((estimate.low, estimate.high), (Some(0.929), Some(0.987_999_999_999_999_9)));
    }
}
