//! Every row of the report driven again, side by side.

use std::num::NonZeroUsize;
use std::thread::available_parallelism;

use super::Group;
use super::drives::Task;
use crate::Error;
use crate::jobs::{self, Display, Job};
use crate::report::Report;
use crate::store::Index;

/// One task per row of the report.
pub(super) fn tasks<'a>(index: &'a Index, cells: &[Group], report: &'a Report) -> Vec<Task<'a>> {
    let mut tasks = Vec::new();
    for (cell, indexed) in cells.iter().zip(&index.cells) {
        for (world, evaluation) in indexed.evaluations.iter().enumerate() {
            tasks.push(Task {
                row: tasks.len(),
                runs: &report.runs[cell.runs.clone()],
                world,
                name: &evaluation.world,
                eval_id: &evaluation.eval_id,
                levels: cell.levels.join(","),
                title: [&cell.levels[..], std::slice::from_ref(&evaluation.world)].concat().join(" · "),
            });
        }
    }
    tasks
}

/// What `work` makes of each task, on all cores; what failed is empty, and told in warnings.
pub(super) fn each<T: Default + Send>(
    tasks: Vec<Task<'_>>,
    work: impl Fn(&Task<'_>) -> Result<T, Error> + Sync,
) -> Result<(Vec<T>, Vec<String>), Error> {
    let jobs: Vec<_> = tasks.into_iter().map(|input| Job { input, work: 1 }).collect();
    let n_workers = available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let outcomes = jobs::run(&jobs, n_workers, Display::auto("rows of drives"), |task: &Task<'_>, progress| {
        progress.advance(1);
        Ok::<_, Error>(work(task))
    })?;
    let mut warnings = Vec::new();
    let mut results = Vec::new();
    for (outcome, job) in outcomes.into_iter().zip(&jobs) {
        results.push(outcome.unwrap_or_else(|error| {
            warnings.push(format!("{}: cannot be driven again: {error}", job.input.title));
            T::default()
        }));
    }
    Ok((results, warnings))
}

/// The warning that `n_otherwise` of `n` episodes went otherwise than recorded, if any did; `what` is from these drives.
pub(super) fn otherwise(n: usize, n_otherwise: usize, what: &str) -> Option<String> {
    (n_otherwise > 0).then(|| {
        format!(
            "{n_otherwise} of {n} episodes that were driven again went otherwise than recorded: by other code, or from \
             files that have changed since; {what} are those of today"
        )
    })
}
