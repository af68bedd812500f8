//! All that a page or a set of figures shows of a results folder, computed.

mod again;
mod asked;
mod bands;
mod choice;
mod clearance;
mod comparison;
mod curves;
mod drives;
mod redrive;
mod settings;
mod steps;
mod trace;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

pub(super) use bands::Point;
pub use choice::{Choice, Pick};
pub(super) use clearance::N_EPISODES as N_CLEARANCE_EPISODES;
pub(super) use comparison::{Aggregate, Comparison, MIN_SEEDS_TOLD, Ranking};
pub(super) use curves::Quantity;
pub(super) use drives::{ASKED, Driven};
pub use drives::{Drive, Trajectories};
pub(super) use settings::{Setting, Settings};
pub use steps::{ControlStep, DriveSteps, steps};
pub use trace::{Form, Scene, Trace};

use super::{Contrasts, Policy, Report, RunRow, WORLD, load};
use crate::Error;
use crate::store::{Cell, Index, RunFolder};

/// A results folder as pages and figures show it: the report, its learning curves, comparisons of its cells, and episodes
/// that were driven again.
#[derive(Debug)]
pub struct Study {
    /// The grid's name.
    pub name: String,
    /// The results folder.
    pub folder: PathBuf,
    /// The report.
    pub report: Report,
    /// One per cell of the grid.
    pub(super) cells: Vec<Group>,
    /// One per row of the report.
    pub(super) places: Vec<Place>,
    /// Number of complete runs by [`RESULTS_VERSION`](crate::store::RESULTS_VERSION), and by code revision.
    pub(super) versions: Counts,
    pub(super) revisions: Counts,
    /// The learning curves of the cells that trained.
    pub(super) curves: Vec<Curves>,
    pub(super) comparisons: Vec<Comparison>,
    pub(super) rankings: Vec<Ranking>,
    /// One for each axis with several levels, and for the worlds if there are several.
    pub(super) contrasts: Vec<Contrasts>,
    /// What sets the cells apart.
    pub(super) settings: Vec<Settings>,
    /// One per row of the report.
    pub(super) driven: Vec<Driven>,
}

/// How many runs have each value.
pub(super) type Counts = BTreeMap<String, usize>;

/// A cell of the grid.
#[derive(Debug)]
pub(super) struct Group {
    /// Its levels, in the order of the axes.
    pub(super) levels: Vec<String>,
    /// Those of them that some other cell does not share.
    pub(super) distinct: Vec<String>,
    /// Its runs in the report.
    pub(super) runs: Range<usize>,
}

/// What a row of the report is about.
#[derive(Debug)]
pub(super) struct Place {
    pub(super) cell: usize,
    /// The place of the world among the cell's.
    pub(super) world: usize,
    pub(super) eval_id: String,
}

/// The curves of one quantity, a curve per cell; empty where the cell trained nothing.
#[derive(Debug)]
pub(super) struct Curves {
    pub(super) quantity: Quantity,
    pub(super) by_cell: Vec<Vec<Point>>,
}

impl Study {
    /// The study of the results folder at `root`, as far as it has come. Drives again, on all cores, what `choice` asks for
    /// and the first episodes of every run.
    ///
    /// What cannot be driven again, for want of a world file, say, is left out, and a note tells.
    ///
    /// # Errors
    /// As [`load`]; and if an episode is asked for that is not there.
    ///
    /// ```
    /// use headway_experiments::report::{Choice, Study, Trajectories};
    /// let missing = Study::load("no/results".as_ref(), &Choice::default(), Trajectories::Dropped).unwrap_err();
    /// assert!(missing.to_string().contains("no/results"));
    /// ```
    pub fn load(root: &Path, choice: &Choice, with: Trajectories) -> Result<Self, Error> {
        let index = Index::load(root)?;
        let mut report = load(root)?;
        let cells = groups(&index);
        asked::check(choice, &index, &report)?;
        let places = index.cells.iter().enumerate().flat_map(|(cell, indexed)| {
            let place = move |(world, id): (usize, String)| Place { cell, world, eval_id: id };
            indexed.evaluations.iter().map(|evaluation| evaluation.eval_id.to_string()).enumerate().map(place)
        });
        let places: Vec<Place> = places.collect();
        let (versions, revisions) = provenance(root, &report)?;
        let curves = learning_curves(root, &cells, &report)?;
        let runs: Vec<&[RunRow]> = cells.iter().map(|cell| &report.runs[cell.runs.clone()]).collect();
        let (comparisons, rankings) = (Comparison::all(&runs)?, Ranking::all(&runs)?);
        let contrasts = contrasts(&report);
        let settings = settings::settings(root, &index, &cells, &report.runs)?;
        let tasks = again::tasks(&index, &cells, &report);
        let (driven, warnings) = again::each(tasks, |task| task.drive(root, choice, with))?;
        report.warnings.extend(warnings);
        report.warnings.extend(otherwise(&driven));
        let folder = root.to_owned();
        Ok(Self {
            name: index.name,
            folder,
            report,
            cells,
            places,
            versions,
            revisions,
            curves,
            comparisons,
            rankings,
            contrasts,
            settings,
            driven,
        })
    }

    /// The episodes that are shown, in the order of the rows.
    pub fn drives(&self) -> impl Iterator<Item = &Drive> {
        self.driven.iter().flat_map(|driven| &driven.drives)
    }

    /// What a cell is called.
    pub(super) fn label(&self, cell: usize) -> String {
        let distinct = &self.cells[cell].distinct;
        if distinct.is_empty() { self.name.clone() } else { distinct.join(" · ") }
    }

    /// The worlds of any cell, each once.
    pub(super) fn worlds(&self) -> Vec<&str> {
        let mut worlds = Vec::new();
        for row in &self.report.rows {
            if !worlds.contains(&row.world.as_str()) {
                worlds.push(&row.world);
            }
        }
        worlds
    }

    /// The numbers of the rows about a world.
    pub(super) fn rows_of(&self, world: &str) -> Vec<usize> {
        let rows = self.report.rows.iter().enumerate();
        rows.filter(|(_, row)| row.world == world).map(|(number, _)| number).collect()
    }
}

fn groups(index: &Index) -> Vec<Group> {
    let mut first = 0;
    let is_shared = |axis: usize| index.cells.iter().all(|cell| cell.axes[axis] == index.cells[0].axes[axis]);
    let group = |cell: &Cell| {
        let runs = first..first + cell.runs.len();
        first = runs.end;
        let levels: Vec<String> = cell.axes.iter().map(|level| level.level.clone()).collect();
        let distinct = levels.iter().enumerate().filter(|(axis, _)| !is_shared(*axis)).map(|(_, level)| level.clone());
        Group { distinct: distinct.collect(), levels, runs }
    };
    index.cells.iter().map(group).collect()
}

/// The contrasts over everything of which there is one.
fn contrasts(report: &Report) -> Vec<Contrasts> {
    let all = report.axes.iter().map(String::as_str).chain([WORLD]);
    all.filter_map(|over| report.contrasts(over, None).ok()).collect()
}

fn otherwise(driven: &[Driven]) -> Option<String> {
    let sum = |count: fn(&Driven) -> usize| driven.iter().map(count).sum();
    let (n, n_otherwise) = (sum(|driven| driven.n_driven), sum(|driven| driven.n_otherwise));
    again::otherwise(n, n_otherwise, "drives and speeds over clearance")
}

fn provenance(root: &Path, report: &Report) -> Result<(Counts, Counts), Error> {
    let (mut versions, mut revisions) = (Counts::new(), Counts::new());
    for run in report.runs.iter().filter(|run| matches!(run.policy, Policy::At(_) | Policy::NotTrained)) {
        let info = RunFolder::new(root, &run.train_id).info()?;
        *versions.entry(info.results_version.to_string()).or_default() += 1;
        *revisions.entry(info.revision).or_default() += 1;
    }
    Ok((versions, revisions))
}

fn learning_curves(root: &Path, cells: &[Group], report: &Report) -> Result<Vec<Curves>, Error> {
    let mut rows = Vec::new();
    for cell in cells {
        let trained = report.runs[cell.runs.clone()].iter().filter(|run| matches!(run.policy, Policy::At(_)));
        let paths = trained.map(|run| RunFolder::new(root, &run.train_id).metrics_path());
        // Policies may come without the metrics of their training.
        let read = paths.filter(|path| path.is_file()).map(|path| curves::read(&path));
        rows.push(read.collect::<Result<Vec<_>, Error>>()?);
    }
    let of = |quantity| Curves { quantity, by_cell: rows.iter().map(|runs| curves::curve(quantity, runs)).collect() };
    Ok(Quantity::ALL
        .map(of)
        .into_iter()
        .filter(|curves| curves.by_cell.iter().any(|curve| !curve.is_empty()))
        .collect())
}
