//! A results folder as Parquet files: episodes, training metrics and control steps, one table of each over all runs.
//!
//! `docs/data.md` has their columns. Files hold no times and depend on nothing but the results: the same folder gives the same bytes.

mod column;
mod tables;

use std::fs;
use std::path::{Path, PathBuf};

use crate::Error;
use crate::report::{self, Choice, Policy, Report};
use crate::store::{Index, RunFolder};
use column::{Column, parquet};
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
    pub n_bytes: usize,
}

impl Export {
    /// Writes the tables of the results folder at `root`, as far as it has come, into `folder`, which it creates if need be; the steps
    /// are those of the episodes that `choice` names, driven again on all cores.
    ///
    /// # Errors
    /// As [`report::load`] and [`report::steps`], before anything is written; [`Error::Io`] if a file cannot be written.
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
        let episodes = episodes(root, &index, &report)?;
        let training = training(root, &report)?;
        let (drives, warnings) = report::steps(root, &report, choice)?;
        let n_steps = drives.iter().map(|drive| drive.steps.len()).sum();
        fs::create_dir_all(folder).map_err(|error| Error::io("create the folder", folder, error))?;
        let files = vec![
            write(folder, "episodes", episodes.len(), &tables::episodes(&report.axes, &episodes))?,
            write(folder, "training", training.len(), &tables::training(&report.axes, &training))?,
            write(folder, "steps", n_steps, &tables::steps(&report, &drives))?,
        ];
        report.warnings.extend(warnings);
        Ok(Self { files, notes: report.notes() })
    }
}

fn write(folder: &Path, name: &str, n_rows: usize, columns: &[Column]) -> Result<ExportedFile, Error> {
    let path = folder.join(name).with_extension("parquet");
    let bytes = parquet(name, columns).map_err(Error::failure)?;
    fs::write(&path, &bytes).map_err(|error| Error::io("write", &path, error))?;
    Ok(ExportedFile { path, n_rows, n_bytes: bytes.len() })
}

/// The episodes of all evaluations that are there, in the order of the report's runs.
fn episodes<'a>(root: &Path, index: &'a Index, report: &'a Report) -> Result<Vec<Episode<'a>>, Error> {
    let mut episodes = Vec::new();
    let evaluations = index.cells.iter().flat_map(|cell| cell.runs.iter().map(|_| &cell.evaluations));
    for (run, evaluations) in report.runs.iter().zip(evaluations) {
        let folder = RunFolder::new(root, &run.train_id);
        for ((world, summary), evaluation) in run.summaries.iter().zip(evaluations) {
            if summary.is_some() {
                let records = folder.evaluation(&evaluation.eval_id).episodes()?;
                episodes.extend(records.into_iter().map(|record| Episode { run, world, record }));
            }
        }
    }
    Ok(episodes)
}

/// The metrics of all runs that are trained, in the order of the report's runs.
fn training<'a>(root: &Path, report: &'a Report) -> Result<Vec<Interval<'a>>, Error> {
    let mut intervals = Vec::new();
    for run in report.runs.iter().filter(|run| matches!(run.policy, Policy::At(_))) {
        let rows = RunFolder::new(root, &run.train_id).metrics()?;
        intervals.extend(rows.into_iter().map(|row| Interval { run, row }));
    }
    Ok(intervals)
}
