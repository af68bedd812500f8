//! From a results folder to a report.

use std::collections::BTreeMap;
use std::path::Path;

use super::{Interval, Report, Row};
use crate::episode::SeedSummary;
use crate::store::{Cell, EvaluationFolder, Index, IndexedEvaluation, RESULTS_VERSION, RunFolder, RunInfo, StoreError};

/// The report on the grid in the results folder at `root`, as far as it has come; needs no lock.
///
/// # Errors
/// [`StoreError::NoIndex`] if `root` is no results folder; [`StoreError::Io`] and [`StoreError::Parse`] if a file of a
/// complete run is missing or not what this version writes.
pub fn load(root: &Path) -> Result<Report, StoreError> {
    let index = Index::load(root)?;
    let (mut rows, mut infos, mut n_complete, mut n_runs) = (Vec::new(), Vec::new(), 0, 0);
    for cell in &index.cells {
        let runs: Vec<_> = cell.runs.iter().map(|run| RunFolder::new(root, &run.train_id)).collect();
        for run in runs.iter().filter(|run| run.is_complete()) {
            infos.push(run.info()?);
            n_complete += usize::from(is_evaluated(run, cell));
        }
        n_runs += runs.len();
        for evaluation in &cell.evaluations {
            rows.push(Row::of_seeds(cell.axes.clone(), evaluation.world.clone(), &summaries(&runs, evaluation)?));
        }
    }
    let axes = index.axes.into_iter().map(|axis| axis.name).collect();
    Ok(Report { axes, rows, interval: Interval::Seeds, n_complete, n_runs, warnings: warnings(&infos) })
}

fn is_evaluated(run: &RunFolder, cell: &Cell) -> bool {
    cell.evaluations.iter().all(|evaluation| run.evaluation(&evaluation.eval_id).is_complete())
}

fn summaries(runs: &[RunFolder], evaluation: &IndexedEvaluation) -> Result<Vec<SeedSummary>, StoreError> {
    runs.iter()
        .filter(|run| run.is_complete())
        .map(|run| run.evaluation(&evaluation.eval_id))
        .filter(EvaluationFolder::is_complete)
        .map(|folder| Ok(SeedSummary::of(&folder.episodes()?)))
        .collect()
}

/// What sets some of the runs apart from the others, or all of them from this program.
fn warnings(infos: &[RunInfo]) -> Vec<String> {
    let versions = counts(infos.iter().map(|info| info.results_version.to_string()));
    let revisions = counts(infos.iter().map(|info| info.revision.clone()));
    let mut warnings = Vec::new();
    if versions.len() > 1 {
        warnings.push(format!("runs of several results versions: {}", listed(&versions)));
    } else if versions.keys().any(|version| *version != RESULTS_VERSION.to_string()) {
        warnings.push(format!(
            "all runs are of results version {}; this program makes {RESULTS_VERSION}",
            listed(&versions)
        ));
    }
    if revisions.len() > 1 {
        warnings.push(format!("runs of several code revisions: {}", listed(&revisions)));
    }
    warnings
}

fn counts(values: impl Iterator<Item = String>) -> BTreeMap<String, usize> {
    values.fold(BTreeMap::new(), |mut counts, value| {
        *counts.entry(value).or_default() += 1;
        counts
    })
}

fn listed(counts: &BTreeMap<String, usize>) -> String {
    let parts: Vec<_> = counts.iter().map(|(value, n)| format!("{value} ({n} runs)")).collect();
    parts.join(", ")
}
