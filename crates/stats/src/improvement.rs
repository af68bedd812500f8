//! How likely one arm is to beat another.

use crate::{Bootstrap, Interval, Scores, StatsError};

/// The probability that a run of X beats a run of Y in a task, averaged over the tasks:
/// `P = 1/M sum_m U_m / (N_x N_y)`, where `U_m` counts the pairs of runs in which X scores more, and ties by half (Mann
/// & Whitney, 1947; Agarwal et al., 2021, section 4.3).
///
/// It is in [0, 1], 1/2 where neither is better, and says nothing of *how much* better. Runs are not paired: where both
/// arms drove the same scenarios from the same seeds, [`paired_differences`](crate::paired_differences) sees smaller
/// effects.
///
/// # Errors
/// If the arms differ in the number of tasks; that of runs may differ.
///
/// ```
/// use headway_stats::{Scores, probability_of_improvement};
///
/// let x = Scores::from_rows(&[[0.9, 0.5], [0.8, 0.5]])?;
/// let y = Scores::from_rows(&[[0.7, 0.5], [0.8, 0.5], [0.9, 0.5]])?;
/// // Task 0: 0.9 beats two and ties one, 0.8 beats one and ties one: 4 of 6. Task 1: all ties.
/// assert!((probability_of_improvement(&x, &y)? - (4.0 / 6.0 + 0.5) / 2.0).abs() < 1e-15);
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
pub fn probability_of_improvement(x: &Scores, y: &Scores) -> Result<f64, StatsError> {
    let mut pair = Pair::new(x, y)?;
    pair.set(x.values(), y.values());
    Ok(pair.probability())
}

/// The [probability of improvement](probability_of_improvement) with its bootstrap interval: in every resample the runs of
/// both arms are redrawn, independently of each other, within each task or whole, as `how` says
/// ([`Bootstrap::redrawing`]).
///
/// X is better beyond the luck of the seeds where the interval lies above 1/2. Not for fewer than three runs of either
/// arm. Where one policy drives in all tasks, redraw whole runs: within each task, the interval comes out too narrow or too
/// wide.
///
/// # Errors
/// If the arms differ in the number of tasks.
///
/// ```
/// use headway_stats::{Bootstrap, Scores, improvement_bootstrap};
///
/// let x = Scores::from_rows(&[[0.9], [0.8], [0.85], [0.7]])?;
/// let y = Scores::from_rows(&[[0.6], [0.75], [0.5], [0.65]])?;
/// let better = improvement_bootstrap(&x, &y, &Bootstrap::default())?;
/// assert_eq!(better.point, 15.0 / 16.0);
/// assert!(better.low > 0.5 && better.high == 1.0);
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
pub fn improvement_bootstrap(x: &Scores, y: &Scores, how: &Bootstrap) -> Result<Interval, StatsError> {
    let mut pair = Pair::new(x, y)?;
    let (mut redrawn_x, mut redrawn_y) = (x.values().to_vec(), y.values().to_vec());
    let point = probability_of_improvement(x, y)?;
    Ok(how.interval(point, |rng| {
        how.redraw(rng, x.values(), x.n_tasks(), &mut redrawn_x);
        how.redraw(rng, y.values(), y.n_tasks(), &mut redrawn_y);
        pair.set(&redrawn_x, &redrawn_y);
        pair.probability()
    }))
}

/// Two arms' scores task by task: the runs of a task lie side by side.
struct Pair {
    n_tasks: usize,
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Pair {
    fn new(x: &Scores, y: &Scores) -> Result<Self, StatsError> {
        let n_tasks = x.n_tasks();
        if n_tasks != y.n_tasks() {
            return Err(StatsError::Mismatch { what: "tasks", first: n_tasks, second: y.n_tasks() });
        }
        Ok(Self { n_tasks, x: vec![0.0; x.values().len()], y: vec![0.0; y.values().len()] })
    }

    fn set(&mut self, x: &[f64], y: &[f64]) {
        transpose(x, self.n_tasks, &mut self.x);
        transpose(y, self.n_tasks, &mut self.y);
    }

    fn probability(&self) -> f64 {
        let (n_x, n_y) = (self.x.len() / self.n_tasks, self.y.len() / self.n_tasks);
        let tasks = self.x.chunks_exact(n_x).zip(self.y.chunks_exact(n_y));
        let shares =
            tasks.map(|(x, y)| x.iter().map(|x| twice_wins(*x, y)).sum::<u64>() as f64 / (2 * n_x * n_y) as f64);
        shares.sum::<f64>() / self.n_tasks as f64
    }
}

/// Writes row-major `values` to `columns`, column by column.
fn transpose(values: &[f64], n_tasks: usize, columns: &mut [f64]) {
    let n_runs = values.len() / n_tasks;
    for (run, row) in values.chunks_exact(n_tasks).enumerate() {
        row.iter().enumerate().for_each(|(task, value)| columns[task * n_runs + run] = *value);
    }
}

/// Two for each of `y` below `x`, one for each that equals it: branch-free, so that it is done many at once.
fn twice_wins(x: f64, y: &[f64]) -> u64 {
    y.iter().map(|y| u64::from(x > *y) + u64::from(x >= *y)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arms_must_share_their_tasks() {
        let one = Scores::from_rows(&[[0.0]]).unwrap();
        let two = Scores::from_rows(&[[0.0, 0.0]]).unwrap();
        let error = probability_of_improvement(&one, &two).unwrap_err();
        assert_eq!(error.to_string(), "tasks of the second arm = 2: must be 1, as of the first");
        assert!(improvement_bootstrap(&two, &one, &Bootstrap::default()).is_err());
    }

    #[test]
    fn single_runs_have_an_interval_of_no_width() {
        let x = Scores::from_rows(&[[1.0, 1.0, 0.0, 2.0]]).unwrap();
        let y = Scores::from_rows(&[[0.0, 1.0, 1.0, 1.0]]).unwrap();
        let interval = improvement_bootstrap(&x, &y, &Bootstrap::new(50, 0).unwrap()).unwrap();
        assert_eq!(interval, Interval { point: 0.625, low: 0.625, high: 0.625 });
    }
}
