//! What can go wrong in this crate.

/// Why numbers were refused: where they stand, what they are, and what is allowed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StatsError {
    /// A score that is no finite number.
    #[error("score of run {run} in task {task} = {value}: must be finite")]
    Score {
        /// The run's place, from 0.
        run: usize,
        /// The task's place, from 0.
        task: usize,
        /// The score as given.
        value: f64,
    },
    /// A value of a cluster that is no finite number.
    #[error("value {place} of cluster {cluster} = {value}: must be finite")]
    Value {
        /// The cluster's place, from 0.
        cluster: usize,
        /// The value's place in its cluster, from 0.
        place: usize,
        /// The value as given.
        value: f64,
    },
    /// A run with more or fewer scores than the first.
    #[error("run {run} has {found} scores: must be {expected}, as many as run 0")]
    Ragged {
        /// The run's place, from 0.
        run: usize,
        /// How many scores it has.
        found: usize,
        /// How many the first run has.
        expected: usize,
    },
    /// Values that do not fill their matrix.
    #[error("values = {found} of them: must be {n_runs} runs x {n_tasks} tasks")]
    Shape {
        /// How many values there are.
        found: usize,
        /// The matrix's rows.
        n_runs: usize,
        /// The matrix's columns.
        n_tasks: usize,
    },
    /// Nothing where at least one is needed.
    #[error("{what}: must be at least one")]
    Empty {
        /// What is missing.
        what: &'static str,
    },
    /// Two arms that were not measured on the same tasks or, for a paired difference, with the same seeds.
    #[error("{what} of the second arm = {second}: must be {first}, as of the first")]
    Mismatch {
        /// What differs.
        what: &'static str,
        /// How many the first arm has.
        first: usize,
        /// How many the second arm has.
        second: usize,
    },
    /// A number outside what it may be.
    #[error("{what} = {value}: must be {allowed}")]
    Number {
        /// Which number.
        what: &'static str,
        /// The number as given.
        value: f64,
        /// What is allowed, in words.
        allowed: &'static str,
    },
    /// More successes than trials.
    #[error("successes = {successes}: must be from 0 to the number of trials, {n}")]
    Successes {
        /// The successes as given.
        successes: usize,
        /// The number of trials.
        n: usize,
    },
}
