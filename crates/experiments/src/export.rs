//! A results folder as Parquet files: episodes, training metrics and control steps, one table of each over all runs.
//!
//! `docs/data.md` has their columns. Files hold no times and depend on nothing but the results: the same folder gives the same bytes.

mod column;
mod table;
mod tables;

use std::fs;
use std::path::{Path, PathBuf};

use crate::Error;
use crate::report::{self, Choice, Policy, Report};
use crate::store::{Index, RunFolder};
use table::{Table, WholeTable};
use tables::{Episode, Interval};

/// What an export left behind.
#[derive(Debug)]
pub struct Export {
    /// The files: `episodes.parquet`, `training.parquet` and `steps.parquet`.
    pub files: Vec<ExportedFile>,
    /// What a reader must know before trusting the numbers, one line each.
    pub notes: Vec<String>,
}

/// A file of an export.
#[derive(Debug)]
pub struct ExportedFile {
    /// Where it is.
    pub path: PathBuf,
    /// Number of rows.
    pub n_rows: usize,
    /// Its size, bytes.
    pub n_bytes: u64,
}

impl Export {
    /// Writes the tables of the results folder at `root`, as far as it has come, into `folder`, which it creates if need be; the steps
    /// are those of the episodes that `choice` names, driven again on all cores.
    ///
    /// # Errors
    /// As [`report::load`] and [`report::steps`], and [`Error::Input`] if a folder stands where a table belongs, before anything is
    /// written; [`Error::Io`] if a file cannot be written. Tables that were there stay as they are until all new ones are whole
    /// beside them, and nothing half-written is left: only if the system then refuses one of the renames do older tables stand beside newer ones.
    ///
    /// ```
    /// use headway_experiments::export::Export;
    /// use headway_experiments::report::Choice;
    /// let missing = Export::write("no/results".as_ref(), "tables".as_ref(), &Choice::default()).unwrap_err();
    /// assert_eq!(missing.to_string(), "there is no folder `no/results`");
    /// assert!(!std::path::Path::new("tables").exists());
    /// ```
    pub fn write(root: &Path, folder: &Path, choice: &Choice) -> Result<Self, Error> {
        let index = Index::load(root)?;
        let mut report = report::load(root)?;
        check_places(folder)?;
        let (drives, warnings) = report::steps(root, &report, choice)?;
        fs::create_dir_all(folder).map_err(|error| Error::io("create the folder", folder, error))?;
        let episodes = Table::create(folder, "episodes", &tables::episodes(&report.axes, &[]))?;
        let episodes =
            episodes.fill(episodes_of_runs(root, &index, &report), |rows| tables::episodes(&report.axes, rows))?;
        let training = Table::create(folder, "training", &tables::training(&report.axes, &[]))?;
        let training = training.fill(metrics_of_runs(root, &report), |rows| tables::training(&report.axes, rows))?;
        let (columns, n_steps) = (tables::steps(&report, &drives), drives.iter().map(|drive| drive.steps.len()).sum());
        let mut steps = Table::create(folder, "steps", &columns)?;
        steps.push(&columns, n_steps)?;
        let whole = [episodes, training, steps].into_iter().map(Table::close).collect::<Result<Vec<_>, _>>()?;
        let files = whole.into_iter().map(WholeTable::place).collect::<Result<_, _>>()?;
        report.warnings.extend(warnings);
        Ok(Self { files, notes: report.notes() })
    }
}

/// Refuses folders where tables belong: nothing can be put in their places.
fn check_places(folder: &Path) -> Result<(), Error> {
    let mut places = ["episodes", "training", "steps"].map(|name| table::path_of(folder, name)).into_iter();
    match places.find(|place| place.is_dir()) {
        Some(place) => Err(Error::Input(format!("`{}` is a folder; a table belongs there", place.display()))),
        None => Ok(()),
    }
}

/// The episodes of each evaluation that is there, in the order of the report's runs.
fn episodes_of_runs<'a>(
    root: &Path,
    index: &'a Index,
    report: &'a Report,
) -> impl Iterator<Item = Result<Vec<Episode<'a>>, Error>> {
    let evaluations = index.cells.iter().flat_map(|cell| cell.runs.iter().map(|_| &cell.evaluations));
    let evaluations = report.runs.iter().zip(evaluations).flat_map(|(run, evaluations)| {
        let worlds = run.summaries.iter().zip(evaluations).filter(|((_, summary), _)| summary.is_some());
        worlds.map(move |((world, _), evaluation)| (run, world, &evaluation.eval_id))
    });
    evaluations.map(move |(run, world, id)| {
        let records = RunFolder::new(root, &run.train_id).evaluation(id).episodes()?;
        Ok(records.into_iter().map(|record| Episode { run, world, record }).collect())
    })
}

/// The metrics of each run that is trained, in the order of the report's runs.
fn metrics_of_runs<'a>(root: &Path, report: &'a Report) -> impl Iterator<Item = Result<Vec<Interval<'a>>, Error>> {
    report.runs.iter().filter(|run| matches!(run.policy, Policy::At(_))).map(move |run| {
        let rows = RunFolder::new(root, &run.train_id).metrics()?;
        Ok(rows.into_iter().map(|row| Interval { run, row }).collect())
    })
}
