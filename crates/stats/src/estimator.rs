//! What is estimated of a matrix of scores.

use crate::bootstrap::mean;
use crate::scores::task_means;
use crate::{Bootstrap, Interval, Scores};

/// An aggregate of N x M scores in one figure (Agarwal et al., 2021, section 4.3), in the units of the scores.
///
/// ```
/// use headway_stats::{Estimator, Scores};
///
/// let scores = Scores::from_rows(&[[0.0, 0.6, 0.8, 1.0], [0.2, 0.8, 1.0, 9.0]])?;
/// assert!((Estimator::Iqm.of(&scores) - 0.8).abs() < 1e-12); // of 0.6, 0.8, 0.8, 1.0
/// assert!((Estimator::Median.of(&scores) - 0.8).abs() < 1e-12); // of 0.1, 0.7, 0.9, 5.0
/// assert!((Estimator::Mean.of(&scores) - 1.675).abs() < 1e-12); // one score weighs as much as all others
/// assert!((Estimator::OptimalityGap { target: 1.0 }.of(&scores) - 0.325).abs() < 1e-12);
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Estimator {
    /// The mean of all scores: `sum x_nm / (N M)`. Ruled by outliers where scores are not bounded.
    Mean,
    /// The median over tasks of the mean over runs. Blind to nearly half of the tasks, and of wide intervals.
    Median,
    /// The interquartile mean: the mean of what is left of all N M scores, sorted, without the `floor(0.25 N M)` lowest
    /// and as many of the highest. Blind to rare failures: show the optimality gap or a profile beside it.
    Iqm,
    /// How far scores fall short of a target: `target - sum min(x_nm, target) / (N M)`. Less is better.
    OptimalityGap {
        /// The score that is as good as needed, gamma; what lies above counts as no more. Not a number gives no number.
        target: f64,
    },
}

impl Estimator {
    /// The estimate from scores.
    pub fn of(self, scores: &Scores) -> f64 {
        self.of_values(&mut scores.values().to_vec(), scores.n_tasks(), &mut Vec::new())
    }

    /// The estimate from row-major values, which it may reorder, with room for the means of tasks.
    fn of_values(self, values: &mut [f64], n_tasks: usize, means: &mut Vec<f64>) -> f64 {
        match self {
            Self::Mean => mean(values),
            Self::Median => {
                task_means(values, n_tasks, means);
                median(means)
            }
            Self::Iqm => interquartile_mean(values),
            Self::OptimalityGap { target } => {
                target - values.iter().map(|value| value.min(target)).sum::<f64>() / values.len() as f64
            }
        }
    }
}

/// The middle value, or the mean of the two in the middle.
fn median(values: &mut [f64]) -> f64 {
    let half = values.len() / 2;
    let is_odd = values.len() % 2 == 1;
    let (below, middle, _) = values.select_nth_unstable_by(half, f64::total_cmp);
    let upper = *middle;
    match below.iter().copied().max_by(f64::total_cmp) {
        Some(lower) if !is_odd => 0.5 * (lower + upper),
        _ => upper,
    }
}

fn interquartile_mean(values: &mut [f64]) -> f64 {
    let cut = values.len() / 4;
    let n_middle = values.len() - 2 * cut;
    if cut > 0 {
        values.select_nth_unstable_by(cut, f64::total_cmp);
        values[cut..].select_nth_unstable_by(n_middle, f64::total_cmp);
    }
    mean(&values[cut..][..n_middle])
}

/// An estimate with its bootstrap interval: runs are redrawn with replacement, so that every resample has N scores of every
/// task, and the interval runs between quantiles of their estimates (Agarwal et al., 2021, section 4.1).
///
/// It says what other seeds would have given in the same tasks, not how other tasks would have gone. Runs are redrawn within
/// each task unless `how` says otherwise ([`Bootstrap::redrawing`]): that takes a run's scores in different tasks for
/// independent, which is true where every task has policies of its own. Where one policy drives in all, its luck is shared,
/// and whole runs must be redrawn: [`Redrawn::WholeRuns`](crate::Redrawn). Not for fewer than three runs.
///
/// ```
/// use headway_stats::{Bootstrap, Estimator, Scores, stratified_bootstrap};
///
/// let scores = Scores::from_rows(&[[1.0, 10.0], [2.0, 20.0], [3.0, 30.0]])?;
/// let mean = stratified_bootstrap(&scores, Estimator::Mean, &Bootstrap::new(2_000, 0)?);
/// assert_eq!(mean.point, 11.0);
/// assert!(5.5 <= mean.low && mean.low < 8.0 && 14.0 < mean.high && mean.high <= 16.5);
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
pub fn stratified_bootstrap(scores: &Scores, estimator: Estimator, how: &Bootstrap) -> Interval {
    let n_tasks = scores.n_tasks();
    let (mut resample, mut means) = (scores.values().to_vec(), Vec::with_capacity(n_tasks));
    how.interval(estimator.of(scores), |rng| {
        how.redraw(rng, scores.values(), n_tasks, &mut resample);
        estimator.of_values(&mut resample, n_tasks, &mut means)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_iqm_cuts_whole_scores_only() {
        let iqm = |values: &[f64]| interquartile_mean(&mut values.to_vec());
        assert_eq!(iqm(&[9.0, 1.0, 2.0]), 4.0); // floor(0.75) = 0
        assert_eq!(iqm(&[9.0, 1.0, 2.0, 4.0]), 3.0);
        assert_eq!(iqm(&[9.0, 1.0, 2.0, 4.0, 6.0, 3.0, 5.0]), 4.0); // floor(1.75) = 1
        assert_eq!(iqm(&[7.0]), 7.0);
    }

    #[test]
    fn the_median_is_over_tasks() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), 2.5);
        assert_eq!(median(&mut [4.0]), 4.0);
        let scores = Scores::from_rows(&[[0.0, 0.0, 0.0], [0.0, 2.0, 8.0]]).unwrap();
        assert_eq!(Estimator::Median.of(&scores), 1.0);
    }

    #[test]
    fn two_runs_agree_with_the_exact_enumeration() {
        // Task means are 0, 1/2, 1 with 1/4, 1/2, 1/4; the mean of two tasks is 0 or 1 with 1/16 each, else between.
        let scores = Scores::from_rows(&[[0.0, 1.0], [1.0, 0.0]]).unwrap();
        let at = |percent| {
            let how = Bootstrap::default().with_confidence(crate::Confidence::percent(percent).unwrap());
            stratified_bootstrap(&scores, Estimator::Mean, &how).ends()
        };
        assert_eq!(at(95.0), (0.0, 1.0)); // 2.5 % < 1/16
        assert_eq!(at(80.0), (0.25, 0.75)); // 1/16 < 10 % < 5/16
        assert_eq!(at(30.0), (0.5, 0.5)); // 5/16 < 35 %
    }
}
