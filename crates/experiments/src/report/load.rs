//! From a results folder to a report.

use std::collections::BTreeMap;
use std::path::Path;

use super::{Collapsed, Interval, Policy, Report, Row, RunRow};
use crate::collapse::{Collapse, of_evaluation};
use crate::episode::SeedSummary;
use crate::store::{Cell, Id, Index, IndexedRun, RESULTS_VERSION, RunFolder, RunInfo, State, StoreError, damage};

/// The report on the grid in the results folder at `root`, as far as it has come; needs no lock.
///
/// Folders that are damaged count as unfinished, and a warning names them.
///
/// # Errors
/// [`StoreError::NoFolder`] and [`StoreError::NoIndex`] if `root` is no results folder; [`StoreError::Io`] and
/// [`StoreError::Parse`] if a file of a complete run cannot be read or is not what this version writes.
pub fn load(root: &Path) -> Result<Report, StoreError> {
    let index = Index::load(root)?;
    let mut found = Found::default();
    let (mut rows, mut runs) = (Vec::new(), Vec::new());
    for cell in &index.cells {
        let loaded: Vec<RunRow> = cell.runs.iter().map(|run| found.run(root, cell, run)).collect::<Result<_, _>>()?;
        for (k, evaluation) in cell.evaluations.iter().enumerate() {
            let seeds: Vec<SeedSummary> = loaded.iter().filter_map(|run| run.summaries[k].1).collect();
            let row = Row::of_seeds(cell.axes.clone(), evaluation.world.clone(), &seeds);
            rows.push(Row { collapsed: Collapsed::in_world(&loaded, &evaluation.world), ..row });
        }
        runs.extend(loaded);
    }
    // Cells may share a run, which is complete when it is in all of them.
    let completeness = runs.iter().fold(BTreeMap::new(), |mut all, run| {
        *all.entry(&run.train_id).or_insert(true) &= run.is_complete();
        all
    });
    let (n_complete, n_runs) = (completeness.values().filter(|is_complete| **is_complete).count(), completeness.len());
    let axes = index.axes.into_iter().map(|axis| axis.name).collect();
    let warnings = found.warnings();
    Ok(Report { axes, rows, runs, interval: Interval::Seeds, n_complete, n_runs, warnings })
}

/// What a reader of the runs must know.
#[derive(Default)]
struct Found {
    infos: BTreeMap<Id, RunInfo>,
    /// A line for each damaged folder; cells may share it.
    damage: Vec<String>,
}

impl Found {
    fn run(&mut self, root: &Path, cell: &Cell, run: &IndexedRun) -> Result<RunRow, StoreError> {
        let folder = RunFolder::new(root, &run.train_id);
        let state = folder.state()?;
        let is_trained = self.is_whole(&state);
        if is_trained {
            self.infos.insert(run.train_id.clone(), folder.info()?);
        }
        let mut summaries = Vec::new();
        for evaluation in &cell.evaluations {
            let episodes = folder.evaluation(&evaluation.eval_id);
            let is_there = is_trained && self.is_whole(&episodes.state()?);
            let summary = is_there.then(|| episodes.episodes()).transpose()?;
            summaries.push((evaluation.world.clone(), summary.map(|episodes| SeedSummary::of(&episodes))));
        }
        let policy = match state {
            State::Complete if folder.policy_path().is_file() => Policy::At(folder.policy_path()),
            State::Complete => Policy::NotTrained,
            State::Damaged { .. } => Policy::Damaged,
            State::Unfinished => Policy::Unfinished,
        };
        let collapse = if matches!(policy, Policy::At(_)) { collapse(&folder, &summaries)? } else { Vec::new() };
        let (axes, train_id) = (cell.axes.clone(), run.train_id.clone());
        Ok(RunRow { axes, seed: run.seed, train_id, summaries, policy, collapse })
    }

    fn is_whole(&mut self, state: &State) -> bool {
        if let State::Damaged { folder, what } = state {
            let line = damage(folder, what);
            if !self.damage.contains(&line) {
                self.damage.push(line);
            }
        }
        *state == State::Complete
    }

    /// What sets some of the runs apart from the others, or all of them from this program, and what is damaged.
    fn warnings(self) -> Vec<String> {
        let versions = counts(self.infos.values().map(|info| info.results_version.to_string()));
        let revisions = counts(self.infos.values().map(|info| info.revision.clone()));
        let mut warnings = self.damage;
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
}

/// What the training left as its verdict, and what the evaluations say.
fn collapse(folder: &RunFolder, summaries: &[(String, Option<SeedSummary>)]) -> Result<Vec<Collapse>, StoreError> {
    let mut found = folder.collapse()?.unwrap_or_default();
    found.extend(summaries.iter().filter_map(|(world, summary)| of_evaluation(world, summary.as_ref()?)));
    Ok(found)
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
