//! Every row of the report driven again, side by side.

use std::num::NonZeroUsize;
use std::path::Path;
use std::thread::available_parallelism;

use super::Group;
use super::choice::Choice;
use super::drives::{Driven, Task, Trajectories};
use crate::Error;
use crate::jobs::{self, Display, Job};
use crate::report::Report;
use crate::store::Index;

/// Drives again, row by row; what failed is told in warnings.
pub(super) fn drive(
    root: &Path,
    choice: &Choice,
    with: Trajectories,
    index: &Index,
    cells: &[Group],
    report: &Report,
) -> Result<(Vec<Driven>, Vec<String>), Error> {
    let levels: Vec<String> = cells.iter().map(|cell| cell.levels.join(",")).collect();
    let titles: Vec<String> = report
        .rows
        .iter()
        .map(|row| {
            let names: Vec<&str> =
                row.axes.iter().map(|level| level.level.as_str()).chain([row.world.as_str()]).collect();
            names.join(" · ")
        })
        .collect();
    let mut tasks = Vec::new();
    for (cell, indexed) in index.cells.iter().enumerate() {
        for (world, evaluation) in indexed.evaluations.iter().enumerate() {
            let row = tasks.len();
            let input = Task {
                row,
                runs: &report.runs[cells[cell].runs.clone()],
                world,
                name: &evaluation.world,
                eval_id: &evaluation.eval_id,
                levels: &levels[cell],
                title: &titles[row],
            };
            tasks.push(Job { input, work: 1 });
        }
    }
    let n_workers = available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let outcomes = jobs::run(&tasks, n_workers, Display::auto("rows of drives"), |task: &Task<'_>, progress| {
        progress.advance(1);
        Ok::<_, Error>(task.drive(root, choice, with))
    })?;
    let mut warnings = Vec::new();
    let mut driven = Vec::new();
    for (outcome, title) in outcomes.into_iter().zip(&titles) {
        driven.push(outcome.unwrap_or_else(|error| {
            warnings.push(format!("{title}: cannot be driven again: {error}"));
            Driven::default()
        }));
    }
    let sum = |count: fn(&Driven) -> usize| driven.iter().map(count).sum::<usize>();
    let (n, n_otherwise) = (sum(|driven| driven.n_driven), sum(|driven| driven.n_otherwise));
    if n_otherwise > 0 {
        warnings.push(format!(
            "{n_otherwise} of {n} episodes that were driven again went otherwise than recorded: by other code, or from \
             files that have changed since; drives and speeds over clearance are those of today"
        ));
    }
    Ok((driven, warnings))
}
