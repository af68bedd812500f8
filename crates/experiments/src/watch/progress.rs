//! How far runs have come, by their folders.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::collapse::{Collapse, of_evaluation, of_training};
use crate::episode::SeedSummary;
use crate::store::{AxisLevel, Cell, Id, Index, IndexedRun, RunFolder, State, StoreError, damage};
use crate::train::MetricsRow;

/// Time without news after which a run counts as stalled, unless its rows take longer than that anyway.
const PATIENCE: Duration = Duration::from_secs(60);
/// How many times as long as the mean row the next one may take.
const PATIENCE_ROWS: f64 = 5.0;

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// It has not begun.
    Waiting,
    /// It trains.
    Training,
    /// It was begun, and nothing has come of it for long: it may have been interrupted.
    Stalled,
    /// It is trained, and is being evaluated or about to be.
    Evaluating,
    /// All that the grid wants of it is there.
    Done,
    /// A file in its folder is not what was written.
    Damaged,
}

/// One run of a grid as its folder shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct RunProgress {
    /// The cell's levels, in the order of the axes.
    pub axes: Vec<AxisLevel>,
    /// The training seed.
    pub seed: u64,
    /// How far it is.
    pub stage: Stage,
    /// Env steps of the whole training; none before it begins, or where nothing is trained.
    pub n_steps: Option<u64>,
    /// The rows of its metrics up to now.
    pub rows: Vec<MetricsRow>,
    /// Env steps per second: over the whole training, or up to the last row.
    pub steps_per_second: Option<f64>,
    /// The success in each world in which it was evaluated, in \[0, 1\], in the order of the cell's.
    pub success: Vec<Option<f64>>,
    /// How it has collapsed, as far as one can see.
    pub collapse: Vec<Collapse>,
    /// What is damaged, if it is, and what can be done.
    pub damage: Option<String>,
}

/// A reader of a results folder that looks again and again; what is finished it reads but once.
#[derive(Debug)]
pub struct Watcher {
    root: PathBuf,
    done: HashMap<(usize, Id), RunProgress>,
}

impl Watcher {
    /// One for the results folder at `root`; reads nothing yet.
    pub fn new(root: &Path) -> Self {
        Self { root: root.to_owned(), done: HashMap::new() }
    }

    /// The grid and its runs, cell by cell, as they are now.
    ///
    /// # Errors
    /// If the folder holds no results, or a file in it cannot be read.
    pub fn look(&mut self) -> Result<(Index, Vec<RunProgress>), StoreError> {
        let index = Index::load(&self.root)?;
        let mut runs = Vec::new();
        for (number, cell) in index.cells.iter().enumerate() {
            for run in &cell.runs {
                runs.push(self.run(number, cell, run)?);
            }
        }
        Ok((index, runs))
    }

    fn run(&mut self, number: usize, cell: &Cell, run: &IndexedRun) -> Result<RunProgress, StoreError> {
        let key = (number, run.train_id.clone());
        let n_worlds = cell.evaluations.len();
        // A grid that was extended has evaluations that were not there before.
        if let Some(done) = self.done.get(&key).filter(|done| done.success.len() == n_worlds) {
            return Ok(done.clone());
        }
        let folder = RunFolder::new(&self.root, &run.train_id);
        let progress = RunProgress::read(&folder, cell, run.seed);
        let progress = progress.or_else(|error| Ok(RunProgress::damaged(cell, run.seed, error.into_damage()?)))?;
        if progress.stage == Stage::Done {
            self.done.insert(key, progress.clone());
        }
        Ok(progress)
    }
}

impl RunProgress {
    fn read(folder: &RunFolder, cell: &Cell, seed: u64) -> Result<Self, StoreError> {
        let is_trained = folder.has_finished();
        let summaries = if is_trained { summaries(folder, cell)? } else { vec![None; cell.evaluations.len()] };
        let begun = modified(&folder.path().join("run.json"));
        let rows = if begun.is_some() { folder.metrics()? } else { Vec::new() };
        let clock = Clock::of(folder, begun);
        let stage = match begun {
            None => Stage::Waiting,
            Some(_) if is_trained && summaries.iter().all(Option::is_some) => Stage::Done,
            Some(_) if is_trained => Stage::Evaluating,
            Some(_) if clock.is_stalled(rows.len()) => Stage::Stalled,
            Some(_) => Stage::Training,
        };
        if let Some(damage) = is_trained.then(|| damage_of(folder, cell)).transpose()?.flatten() {
            return Ok(Self::damaged(cell, seed, damage));
        }
        let mut collapse = of_training(&rows);
        if !rows.is_empty() {
            let worlds = cell.evaluations.iter().map(|evaluation| &evaluation.world).zip(&summaries);
            collapse.extend(worlds.filter_map(|(world, summary)| of_evaluation(world, summary.as_ref()?)));
        }
        Ok(Self {
            axes: cell.axes.clone(),
            seed,
            stage,
            n_steps: if begun.is_some() { n_steps(folder) } else { None },
            steps_per_second: clock.rate(&rows, folder, is_trained),
            rows,
            success: summaries.iter().map(|summary| summary.and_then(|summary| summary.success)).collect(),
            collapse,
            damage: None,
        })
    }

    /// A run of which a file is not what was written; what it had come to is not known.
    fn damaged(cell: &Cell, seed: u64, damage: String) -> Self {
        Self {
            axes: cell.axes.clone(),
            seed,
            stage: Stage::Damaged,
            n_steps: None,
            rows: Vec::new(),
            steps_per_second: None,
            success: vec![None; cell.evaluations.len()],
            collapse: Vec::new(),
            damage: Some(damage),
        }
    }

    /// The share of the training that is over, in \[0, 1\]; none where nothing is trained.
    pub fn share(&self) -> Option<f64> {
        let made = self.rows.last().map_or(0, |row| row.env_steps);
        self.n_steps.map(|n| (made as f64 / n as f64).min(1.0))
    }

    /// The time that the rest of the training will take, s.
    pub fn seconds_left(&self) -> Option<f64> {
        let left = self.n_steps?.saturating_sub(self.rows.last()?.env_steps);
        (self.stage == Stage::Training).then_some(left as f64 / self.steps_per_second?)
    }
}

/// When a run began and last wrote something.
struct Clock {
    begun: Option<SystemTime>,
    last: Option<SystemTime>,
}

impl Clock {
    fn of(folder: &RunFolder, begun: Option<SystemTime>) -> Self {
        Self { begun, last: modified(&folder.path().join("metrics.csv")) }
    }

    /// Seconds from the beginning to the last row.
    fn trained(&self) -> Option<f64> {
        Some(self.last?.duration_since(self.begun?).ok()?.as_secs_f64())
    }

    fn rate(&self, rows: &[MetricsRow], folder: &RunFolder, is_trained: bool) -> Option<f64> {
        let finished = || is_trained.then(|| folder.timing().ok()).flatten().map(|timing| timing.wall_seconds);
        let seconds = finished().or_else(|| self.trained())?;
        (seconds > 0.0).then_some(rows.last()?.env_steps as f64 / seconds)
    }

    fn is_stalled(&self, n_rows: usize) -> bool {
        let silent = self.last.or(self.begun).and_then(|last| last.elapsed().ok()).unwrap_or_default();
        let per_row = self.trained().unwrap_or(0.0) / n_rows.max(1) as f64;
        silent > PATIENCE.max(Duration::from_secs_f64(PATIENCE_ROWS * per_row))
    }
}

fn modified(path: &Path) -> Option<SystemTime> {
    fs::metadata(path).and_then(|metadata| metadata.modified()).ok()
}

fn summaries(folder: &RunFolder, cell: &Cell) -> Result<Vec<Option<SeedSummary>>, StoreError> {
    let summary = |id: &Id| {
        let evaluation = folder.evaluation(id);
        evaluation.has_finished().then(|| Ok(SeedSummary::of(&evaluation.episodes()?))).transpose()
    };
    cell.evaluations.iter().map(|evaluation| summary(&evaluation.eval_id)).collect()
}

/// What of a run that has finished, and of its evaluations, is no longer what was written.
fn damage_of(folder: &RunFolder, cell: &Cell) -> Result<Option<String>, StoreError> {
    let evaluations = cell.evaluations.iter().map(|evaluation| folder.evaluation(&evaluation.eval_id).state());
    for state in std::iter::once(folder.state()).chain(evaluations) {
        if let State::Damaged { folder, what } = state? {
            return Ok(Some(damage(&folder, &what)));
        }
    }
    Ok(None)
}

/// `train.n_steps` of the run's spec, if something is trained.
fn n_steps(folder: &RunFolder) -> Option<u64> {
    let spec = folder.spec().ok()?;
    spec.get("train")?.get("n_steps")?.as_integer()?.try_into().ok()
}
