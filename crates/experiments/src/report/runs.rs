//! The runs of a results folder, one line each: where each policy lies, and what it is worth.

mod records;

use std::path::PathBuf;

use super::Report;
use super::layout::{Align, Column, lines};
use super::table::{UNDEFINED, number};
use crate::collapse::Collapse;
use crate::episode::{Metric, SeedSummary};
use crate::store::{AxisLevel, Id};

/// One run of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRow {
    /// The cell's levels, in the order of the axes.
    pub axes: Vec<AxisLevel>,
    /// The training seed.
    pub seed: u64,
    /// The run's id; cells that do not differ in training share a run.
    pub train_id: Id,
    /// The worlds of the cell's evaluations, each with its summary if it is there.
    pub summaries: Vec<(String, Option<SeedSummary>)>,
    /// Where the policy lies.
    pub policy: Policy,
    /// How the policy collapsed, by its training and by its evaluation in each world; nothing of one that was not trained.
    pub collapse: Vec<Collapse>,
}

/// Where the policy of a run lies.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Policy {
    /// In this file.
    At(PathBuf),
    /// The run trained none: a classical driver drives, or a policy from elsewhere.
    NotTrained,
    /// The run was finished, but its folder is damaged.
    Damaged,
    /// The run is not finished.
    Unfinished,
}

impl RunRow {
    /// Whether the policy and all evaluations are there.
    pub fn is_complete(&self) -> bool {
        matches!(self.policy, Policy::At(_) | Policy::NotTrained)
            && self.summaries.iter().all(|(_, summary)| summary.is_some())
    }

    /// How the policy collapsed as far as a world is concerned: by its training, and by its evaluation there.
    pub fn collapse_in(&self, world: &str) -> impl Iterator<Item = &Collapse> {
        self.collapse.iter().filter(move |collapse| collapse.concerns(world))
    }

    fn success(&self, world: &str) -> String {
        let summary = self.summaries.iter().find(|(name, _)| name == world).and_then(|(_, summary)| *summary);
        let success = summary.and_then(|summary| Metric::Success.of(&summary));
        success.map_or_else(|| UNDEFINED.to_owned(), |success| number(success, Metric::Success.quantity()))
    }
}

impl Report {
    /// The runs as a text table with a line each: the cell, the seed, the id, the success in each world, the policy's path;
    /// then the [`notes`](Self::notes).
    pub fn runs_table(&self) -> String {
        let mut columns: Vec<Column> =
            self.axes.iter().enumerate().map(|(k, axis)| self.axis_of_runs(k, axis)).collect();
        columns.push(self.run_column(Align::Right, ["seed", ""], |run| run.seed.to_string()));
        columns.push(self.run_column(Align::Left, ["id", ""], |run| run.train_id.to_string()));
        for world in self.worlds() {
            columns.push(self.run_column(Align::Right, [world, "success %"], |run| run.success(world)));
        }
        columns.push(self.run_column(Align::Left, ["policy", ""], |run| match &run.policy {
            Policy::At(path) => path.display().to_string(),
            Policy::NotTrained => "none trained".to_owned(),
            Policy::Damaged => "damaged".to_owned(),
            Policy::Unfinished => "unfinished".to_owned(),
        }));
        let mut text = lines(&columns.iter().collect::<Vec<_>>(), 2);
        text.extend(self.notes());
        text.join("\n") + "\n"
    }

    fn axis_of_runs(&self, k: usize, axis: &str) -> Column {
        self.run_column(Align::Left, [axis, ""], |run| run.axes[k].level.clone())
    }

    fn run_column(&self, align: Align, header: [&str; 2], cell: impl Fn(&RunRow) -> String) -> Column {
        Column { align, cells: header.map(str::to_owned).into_iter().chain(self.runs.iter().map(cell)).collect() }
    }

    /// The worlds of any run, each once.
    fn worlds(&self) -> Vec<&str> {
        let mut worlds = Vec::new();
        for (world, _) in self.runs.iter().flat_map(|run| &run.summaries) {
            if !worlds.contains(&world.as_str()) {
                worlds.push(world);
            }
        }
        worlds
    }
}
