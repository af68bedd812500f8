//! The matrix of scores.

use crate::StatsError;

/// Scores of N runs (training seeds) in M tasks (worlds, scenarios), `[n_runs, n_tasks]`, row-major; finite and not
/// empty.
///
/// Scores that are averaged over tasks must mean the same in each: success rates, or returns divided by a reference.
///
/// ```
/// use headway_stats::Scores;
///
/// let scores = Scores::new(2, 3, vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.6])?;
/// assert_eq!(scores.run(1), [0.4, 0.5, 0.6]);
/// let refusal = Scores::from_rows(&[vec![0.1, 0.2], vec![0.3]]).unwrap_err();
/// assert_eq!(refusal.to_string(), "run 1 has 1 scores: must be 2, as many as run 0");
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Scores {
    n_tasks: usize,
    values: Vec<f64>,
}

impl Scores {
    /// The scores `values`, run by run.
    ///
    /// # Errors
    /// If a side is 0, the values do not fill the matrix, or one is not finite.
    pub fn new(n_runs: usize, n_tasks: usize, values: Vec<f64>) -> Result<Self, StatsError> {
        for (what, n) in [("runs", n_runs), ("tasks", n_tasks)] {
            if n == 0 {
                return Err(StatsError::Empty { what });
            }
        }
        if n_runs.checked_mul(n_tasks) != Some(values.len()) {
            return Err(StatsError::Shape { found: values.len(), n_runs, n_tasks });
        }
        match values.iter().position(|value| !value.is_finite()) {
            Some(i) => Err(StatsError::Score { run: i / n_tasks, task: i % n_tasks, value: values[i] }),
            None => Ok(Self { n_tasks, values }),
        }
    }

    /// The scores of runs, each with a score per task.
    ///
    /// # Errors
    /// If there is no run or no task, the runs differ in length, or a score is not finite.
    pub fn from_rows(rows: &[impl AsRef<[f64]>]) -> Result<Self, StatsError> {
        let expected = rows.first().ok_or(StatsError::Empty { what: "runs" })?.as_ref().len();
        let mut values = Vec::with_capacity(rows.len() * expected);
        for (run, row) in rows.iter().map(AsRef::as_ref).enumerate() {
            if row.len() != expected {
                return Err(StatsError::Ragged { run, found: row.len(), expected });
            }
            values.extend_from_slice(row);
        }
        Self::new(rows.len(), expected, values)
    }

    /// Number of runs, N.
    pub fn n_runs(&self) -> usize {
        self.values.len() / self.n_tasks
    }

    /// Number of tasks, M.
    pub fn n_tasks(&self) -> usize {
        self.n_tasks
    }

    /// All scores, row-major.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The scores of one run, task by task.
    ///
    /// # Panics
    /// If there is no such run.
    pub fn run(&self, run: usize) -> &[f64] {
        &self.values[run * self.n_tasks..][..self.n_tasks]
    }

    /// The mean score of each run over the tasks.
    pub fn run_means(&self) -> Vec<f64> {
        self.values.chunks_exact(self.n_tasks).map(|row| row.iter().sum::<f64>() / self.n_tasks as f64).collect()
    }

    /// The mean score in each task over the runs.
    pub fn task_means(&self) -> Vec<f64> {
        let mut means = Vec::new();
        task_means(&self.values, self.n_tasks, &mut means);
        means
    }
}

/// Writes the mean of each column of row-major `values` to `means`.
pub(crate) fn task_means(values: &[f64], n_tasks: usize, means: &mut Vec<f64>) {
    means.clear();
    means.resize(n_tasks, 0.0);
    for row in values.chunks_exact(n_tasks) {
        means.iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
    }
    let n_runs = (values.len() / n_tasks) as f64;
    means.iter_mut().for_each(|sum| *sum /= n_runs);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_go_along_rows_and_columns() {
        let scores = Scores::from_rows(&[[1.0, 2.0, 6.0], [3.0, 4.0, 8.0]]).unwrap();
        assert_eq!((scores.n_runs(), scores.n_tasks()), (2, 3));
        assert_eq!(scores.run_means(), [3.0, 5.0]);
        assert_eq!(scores.task_means(), [2.0, 3.0, 7.0]);
    }

    #[test]
    fn refusals_name_the_place_and_what_is_allowed() {
        let message = |result: Result<Scores, StatsError>| result.unwrap_err().to_string();
        assert_eq!(message(Scores::new(0, 2, Vec::new())), "runs: must be at least one");
        assert_eq!(message(Scores::from_rows(&[[0.0; 0]])), "tasks: must be at least one");
        assert_eq!(message(Scores::new(2, 2, vec![0.0; 3])), "values = 3 of them: must be 2 runs x 2 tasks");
        let nan = Scores::from_rows(&[[0.0, 1.0], [f64::NAN, 1.0]]);
        assert_eq!(message(nan), "score of run 1 in task 0 = NaN: must be finite");
        assert!(Scores::new(usize::MAX, 2, vec![0.0]).is_err());
    }
}
