//! Percentile bootstrap intervals (Efron, 1979).

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::{Deserialize, Serialize};

use crate::{Confidence, StatsError};

/// How a bootstrap is done: number of resamples, confidence, and the seed of its random stream.
///
/// The default, 10 000 resamples, 95 % and seed 0, suits tables; 2 000 suit plots of profiles. An end at tail
/// probability q has a Monte-Carlo error of `sqrt(q (1 - q) / n_resamples)` in probability: 0.0016 of 0.025 at 10 000.
///
/// ```
/// use headway_stats::{Bootstrap, Confidence};
///
/// let quick = Bootstrap::new(2_000, 7)?.with_confidence(Confidence::percent(90.0)?);
/// assert_eq!(quick.n_resamples(), 2_000);
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bootstrap {
    n_resamples: usize,
    confidence: Confidence,
    seed: u64,
    redrawn: Redrawn,
}

/// What a resample of [`Scores`](crate::Scores) is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Redrawn {
    /// Each task's scores come from runs drawn for that task alone (Agarwal et al., 2021): right where every task has policies of
    /// its own.
    #[default]
    WithinTasks,
    /// Whole runs are drawn, with their scores in all tasks: right where one policy is judged in all of them, so that they share
    /// its luck.
    WholeRuns,
}

impl Default for Bootstrap {
    fn default() -> Self {
        Self { n_resamples: 10_000, confidence: Confidence::default(), seed: 0, redrawn: Redrawn::default() }
    }
}

/// An estimate with the ends of its interval, in the units of the scores; of no width for a single unit, which says
/// nothing of its spread.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The estimate from the values as they are.
    pub point: f64,
    /// The interval's lower end.
    pub low: f64,
    /// The interval's upper end.
    pub high: f64,
}

impl Interval {
    /// The ends, low and high.
    pub fn ends(self) -> (f64, f64) {
        (self.low, self.high)
    }
}

impl Bootstrap {
    /// `n_resamples` at 95 % from the random stream of `seed`.
    ///
    /// # Errors
    /// If there is no resample.
    pub fn new(n_resamples: usize, seed: u64) -> Result<Self, StatsError> {
        match n_resamples {
            0 => Err(StatsError::Empty { what: "resamples" }),
            _ => Ok(Self { n_resamples, seed, ..Self::default() }),
        }
    }

    /// The same with another confidence; it redraws the same resamples.
    #[must_use]
    pub fn with_confidence(self, confidence: Confidence) -> Self {
        Self { confidence, ..self }
    }

    /// The same with other resamples of scores in several tasks; nothing else changes.
    #[must_use]
    pub fn redrawing(self, redrawn: Redrawn) -> Self {
        Self { redrawn, ..self }
    }

    /// Writes a resample of scores, row by row.
    pub(crate) fn redraw(&self, rng: &mut impl Rng, values: &[f64], n_tasks: usize, resample: &mut [f64]) {
        let n_runs = values.len() / n_tasks;
        for row in resample.chunks_exact_mut(n_tasks) {
            match self.redrawn {
                Redrawn::WithinTasks => {
                    let scores = row.iter_mut().enumerate();
                    scores.for_each(|(task, score)| *score = values[below(rng, n_runs) * n_tasks + task]);
                }
                Redrawn::WholeRuns => row.copy_from_slice(&values[below(rng, n_runs) * n_tasks..][..n_tasks]),
            }
        }
    }

    /// Number of resamples.
    pub fn n_resamples(&self) -> usize {
        self.n_resamples
    }

    /// The intervals around `points`, from what `draw` writes of each resample: one figure per point.
    pub(crate) fn intervals(&self, points: &[f64], mut draw: impl FnMut(&mut ChaCha8Rng, &mut [f64])) -> Vec<Interval> {
        let mut rng = ChaCha8Rng::from_seed(*b"headway bootstrap over the seeds");
        rng.set_stream(self.seed);
        let mut drawn = vec![0.0; points.len()];
        let mut samples = vec![Vec::with_capacity(self.n_resamples); points.len()];
        for _ in 0..self.n_resamples {
            draw(&mut rng, &mut drawn);
            samples.iter_mut().zip(&drawn).for_each(|(sample, figure)| sample.push(*figure));
        }
        points.iter().zip(&mut samples).map(|(point, sample)| self.percentiles(*point, sample)).collect()
    }

    /// The interval around one point.
    pub(crate) fn interval(&self, point: f64, mut draw: impl FnMut(&mut ChaCha8Rng) -> f64) -> Interval {
        self.intervals(&[point], |rng, drawn| drawn[0] = draw(rng))[0]
    }

    fn percentiles(&self, point: f64, sample: &mut [f64]) -> Interval {
        sample.sort_unstable_by(f64::total_cmp);
        let (low, high) = self.confidence.tails();
        Interval { point, low: quantile(sample, low), high: quantile(sample, high) }
    }
}

/// Any statistic of independent units with its percentile bootstrap interval: units are redrawn with replacement, and
/// the interval runs between quantiles of the statistic of the resamples (Efron, 1979, "Bootstrap Methods: Another Look
/// at the Jackknife").
///
/// A unit may be any value: a seed's score, a pair of scores, a whole scenario. The statistic must not depend on the
/// units' order. Not for fewer than three units, nor for extremes (a maximum's resamples never pass it).
///
/// # Errors
/// If there is no unit.
///
/// ```
/// use headway_stats::{Bootstrap, bootstrap};
///
/// // Metres driven and collisions, seed by seed: collisions per metre.
/// let seeds = [(950.0, 3.0), (1020.0, 1.0), (980.0, 2.0), (1050.0, 2.0)];
/// let per_metre = |seeds: &[(f64, f64)]| {
///     seeds.iter().map(|seed| seed.1).sum::<f64>() / seeds.iter().map(|seed| seed.0).sum::<f64>()
/// };
/// let rate = bootstrap(&seeds, per_metre, &Bootstrap::default())?;
/// assert_eq!(rate.point, 0.002);
/// assert!(0.001 < rate.low && rate.high < 0.003);
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
pub fn bootstrap<T: Clone>(
    units: &[T],
    mut statistic: impl FnMut(&[T]) -> f64,
    how: &Bootstrap,
) -> Result<Interval, StatsError> {
    if units.is_empty() {
        return Err(StatsError::Empty { what: "units" });
    }
    let point = statistic(units);
    let mut resample = units.to_vec();
    Ok(how.interval(point, |rng| {
        resample.iter_mut().for_each(|unit| unit.clone_from(&units[below(rng, units.len())]));
        statistic(&resample)
    }))
}

/// A uniform index below `n`, by multiplication and shift; its bias of `n / 2^64` is of no account.
pub(crate) fn below(rng: &mut impl Rng, n: usize) -> usize {
    ((u128::from(rng.next_u64()) * n as u128) >> 64) as usize
}

/// The quantile of sorted values with linear interpolation (Hyndman & Fan, 1996, type 7).
fn quantile(sorted: &[f64], q: f64) -> f64 {
    let position = q * (sorted.len() - 1) as f64;
    let (i, rest) = (position as usize, position.fract());
    let next = sorted[(i + 1).min(sorted.len() - 1)];
    sorted[i] + rest * (next - sorted[i])
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate_as_numpy_does() {
        // numpy.quantile([1, 2, 4, 8], ...).
        let sorted = [1.0, 2.0, 4.0, 8.0];
        for (q, expected) in [(0.0, 1.0), (0.1, 1.3), (0.5, 3.0), (0.9, 6.8), (1.0, 8.0)] {
            assert!((quantile(&sorted, q) - expected).abs() < 1e-12, "{q}");
        }
        assert_eq!(quantile(&[5.0], 0.975), 5.0);
    }

    #[test]
    fn indices_are_uniform_and_streams_differ_by_seed() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut counts = [0_usize; 5];
        (0..50_000).for_each(|_| counts[below(&mut rng, 5)] += 1);
        // Five standard errors of sqrt(50 000 * 0.2 * 0.8).
        assert!(counts.iter().all(|count| count.abs_diff(10_000) < 450), "{counts:?}");

        let units: Vec<f64> = (0..30).map(|i| f64::from(i * i)).collect();
        let of = |seed| bootstrap(&units, mean, &Bootstrap::new(500, seed).unwrap()).unwrap();
        assert_eq!(of(3), of(3));
        assert_ne!(of(3), of(4));
    }

    #[test]
    fn a_median_of_units_agrees_with_its_exact_distribution() {
        // The median of 5 redrawn from {0, 1, 2, 3, 4} is 0 with P(at least 3 of 5 are 0) = 181/3125 = 0.058 > 0.025.
        let units = [0.0, 1.0, 2.0, 3.0, 4.0];
        let median = |units: &[f64]| {
            let mut sorted = units.to_vec();
            sorted.sort_unstable_by(f64::total_cmp);
            sorted[2]
        };
        let at = |percent| Bootstrap::default().with_confidence(Confidence::percent(percent).unwrap());
        assert_eq!(bootstrap(&units, median, &at(95.0)).unwrap(), Interval { point: 2.0, low: 0.0, high: 4.0 });
        assert_eq!(bootstrap(&units, median, &at(86.0)).unwrap(), Interval { point: 2.0, low: 1.0, high: 3.0 });
        assert!(bootstrap(&[], median, &at(95.0)).is_err());
        assert!(Bootstrap::new(0, 0).is_err());
    }

    #[test]
    fn whole_runs_stay_together() {
        let values: Vec<f64> = (0..12).map(f64::from).collect();
        let (mut rng, mut resample) = (ChaCha8Rng::seed_from_u64(0), values.clone());
        let how = Bootstrap::default().redrawing(Redrawn::WholeRuns);
        let mut seen = [false; 4];
        for _ in 0..20 {
            how.redraw(&mut rng, &values, 3, &mut resample);
            for row in resample.chunks_exact(3) {
                assert_eq!((row[0] % 3.0, row[1] - row[0], row[2] - row[0]), (0.0, 1.0, 2.0));
                seen[row[0] as usize / 3] = true;
            }
        }
        assert_eq!(seen, [true; 4]);
    }

    #[test]
    fn redrawing_keeps_every_score_in_its_column() {
        let values: Vec<f64> = (0..12).map(f64::from).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let mut resample = vec![0.0; 12];
        let mut seen = [false; 12];
        for _ in 0..200 {
            Bootstrap::default().redraw(&mut rng, &values, 3, &mut resample);
            for (i, value) in resample.iter().enumerate() {
                assert_eq!(*value as usize % 3, i % 3);
                seen[*value as usize] = true;
            }
        }
        assert_eq!(seen, [true; 12]);
    }
}
