//! What a results folder says: success, collisions, timeouts and speeds of every cell in every world, with intervals.

mod axes;
mod chart;
mod collapsed;
mod contrast;
mod csv;
mod figures;
mod json;
pub(crate) mod layout;
mod load;
mod page;
mod runs;
mod study;
mod table;

pub use collapsed::{Collapsed, CollapsedSeed};
pub use contrast::{Contrast, Contrasts, Difference, LevelSettings, SomeSettings, WORLD};
pub use figures::{Figure, FigureFormat, WrittenFigures};
pub use load::load;
pub use runs::{Policy, RunRow};
pub use study::{Choice, ControlStep, Drive, DriveSteps, Form, Pick, Scene, Study, Trace, Trajectories, steps};

use headway_stats::{Bootstrap, Confidence, Estimate, over_units, wilson};

use crate::episode::{EpisodeRecord, Metric, SeedSummary};
use crate::store::AxisLevel;

/// The width of terminal tables, in characters.
pub const TABLE_WIDTH: usize = 120;

/// A report, made by [`load`] from a results folder or by [`of_policy`] from the episodes of a single policy.
///
/// [`table`](Self::table), [`json`](Self::json) and [`csv`](Self::csv) show the same rows; [`notes`](Self::notes) says
/// what a reader must know before trusting them, and stands below the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// The names of the axes, in the order of the grid.
    pub axes: Vec<String>,
    /// One row per cell and evaluation world, in the order of the grid.
    pub rows: Vec<Row>,
    /// One row per run, cell by cell, seed by seed; none of a single policy.
    pub runs: Vec<RunRow>,
    /// What the intervals are.
    pub interval: Interval,
    /// Number of runs of which the policy and all evaluations are there; a run that cells share counts once.
    pub n_complete: usize,
    /// Number of runs of the grid; a run that cells share counts once.
    pub n_runs: usize,
    /// Reasons to distrust the comparison: damaged folders, runs of several revisions or versions.
    pub warnings: Vec<String>,
}

/// What the intervals of a report are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interval {
    /// 95 % percentile bootstrap over the training seeds.
    Seeds,
    /// None over seeds, for there is one policy; its rates have 95 % Wilson score intervals over its episodes.
    Episodes,
}

/// The metrics of one cell in one evaluation world.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The cell's levels, in the order of the axes.
    pub axes: Vec<AxisLevel>,
    /// The name of the evaluation world.
    pub world: String,
    /// Number of seeds that were evaluated.
    pub n_seeds: usize,
    /// Number of episodes of all seeds together.
    pub n_episodes: usize,
    /// The estimates, in the order of [`Metric::ALL`].
    pub estimates: [Estimate; Metric::ALL.len()],
    /// In the same order: the 95 % Wilson score interval over the episodes, low and high, of the rates of a single policy.
    pub wilson: [Option<(f64, f64)>; Metric::ALL.len()],
    /// Which of the cell's seeds collapsed: by their training, or in this world.
    pub collapsed: Collapsed,
}

impl Row {
    /// The row of a cell, from the summary of each of its seeds.
    pub fn of_seeds(axes: Vec<AxisLevel>, world: String, seeds: &[SeedSummary]) -> Self {
        let over_seeds = |metric: Metric| over_units(seeds.iter().map(|seed| metric.of(seed)), &Bootstrap::default());
        Self {
            axes,
            world,
            n_seeds: seeds.len(),
            n_episodes: seeds.iter().map(|seed| seed.n_episodes).sum(),
            estimates: Metric::ALL.map(over_seeds),
            wilson: [None; Metric::ALL.len()],
            collapsed: Collapsed::default(),
        }
    }

    /// The estimate of a metric.
    pub fn estimate(&self, metric: Metric) -> Estimate {
        self.estimates[place(metric)]
    }

    /// The interval of a metric, low and high: over the seeds, or else over the episodes of a single policy.
    pub fn interval(&self, metric: Metric) -> Option<(f64, f64)> {
        let Estimate { low, high, .. } = self.estimate(metric);
        low.zip(high).or(self.wilson[place(metric)])
    }
}

/// The place of a metric in [`Metric::ALL`].
fn place(metric: Metric) -> usize {
    Metric::ALL.iter().position(|m| *m == metric).expect("ALL holds every metric")
}

/// The report on a single policy: one row per world, from the world's name and the episodes driven in it.
///
/// ```
/// use headway_experiments::episode::{EpisodeMeter, Outcome, Sample};
/// use headway_experiments::report::of_policy;
///
/// let mut meter = EpisodeMeter::new(2.0);
/// let step = Sample { speed_before: 1.0, speed_after: 1.0, dt: 4.0, distance: 4.0, clearance: 3.0, free_range: 5.0 };
/// meter.push(&step);
/// let report = of_policy(&[("room", vec![meter.finish(0, Outcome::Success, 4.0)])]);
/// assert!(report.csv().starts_with("world,seeds,episodes,success,success_low,success_high,"));
/// ```
pub fn of_policy(worlds: &[(impl AsRef<str>, Vec<EpisodeRecord>)]) -> Report {
    let rows = worlds.iter().map(|(world, episodes)| policy_row(world.as_ref(), episodes)).collect();
    Report {
        axes: Vec::new(),
        rows,
        runs: Vec::new(),
        interval: Interval::Episodes,
        n_complete: 1,
        n_runs: 1,
        warnings: Vec::new(),
    }
}

fn policy_row(world: &str, episodes: &[EpisodeRecord]) -> Row {
    let mut row = Row::of_seeds(Vec::new(), world.to_owned(), &[SeedSummary::of(episodes)]);
    row.wilson = Metric::ALL.map(|metric| {
        let outcome = metric.outcome()?;
        let n = episodes.iter().filter(|e| e.outcome == outcome).count();
        wilson(n, episodes.len(), Confidence::default()).ok().map(headway_stats::Interval::ends)
    });
    row
}

impl Report {
    /// What a reader must know before trusting the numbers, one line each: unfinished runs, damage and mixed versions.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.n_complete < self.n_runs {
            notes.push(format!("unfinished: {} of {} runs are complete", self.n_complete, self.n_runs));
        }
        notes.extend(self.warnings.iter().map(|warning| format!("warning: {warning}")));
        notes
    }
}
