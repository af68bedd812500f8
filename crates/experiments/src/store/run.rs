//! The folders of runs and of their evaluations.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::atomic::{fresh_folder, write_atomically};
use super::done::{self, State, TIMING, read_if_there};
use super::error::{StoreError, at, unreadable, unserialisable};
use super::{CODE_REVISION, EvaluationKey, Id, RESULTS_VERSION, Timing};
use crate::collapse::Collapse;
use crate::episode::EpisodeRecord;
use crate::train::MetricsRow;

const SPEC: &str = "spec.toml";
const INFO: &str = "run.json";
const METRICS: &str = "metrics.csv";
const COLLAPSE: &str = "collapse.json";
const POLICY: &str = "policy.safetensors";
const EPISODES: &str = "episodes.csv";

/// What a run's spec does not say: `run.json`. Never a time, so that equal runs are equal byte by byte.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunInfo {
    /// The seed.
    pub seed: u64,
    /// The [`RESULTS_VERSION`] of the code that made the run.
    pub results_version: u32,
    /// The version of the reward.
    pub reward_version: u32,
    /// The [`CODE_REVISION`] of the code that made the run.
    pub revision: String,
}

impl RunInfo {
    /// The info of a run made by this code.
    pub fn new(seed: u64, reward_version: u32) -> Self {
        Self { seed, results_version: RESULTS_VERSION, reward_version, revision: CODE_REVISION.to_owned() }
    }
}

/// The folder of a training run, which may not exist yet.
///
/// Anyone may read it; whoever writes to it holds the [`Store`](super::Store) meanwhile.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunFolder {
    path: PathBuf,
}

impl RunFolder {
    /// The folder of the run `id` in the results folder `root`; touches nothing.
    pub fn new(root: &Path, id: &Id) -> Self {
        Self { path: root.join("runs").join(id.as_str()) }
    }

    /// The folder's path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The path of the policy file.
    pub fn policy_path(&self) -> PathBuf {
        self.path.join(POLICY)
    }

    /// The path of the training metrics.
    pub fn metrics_path(&self) -> PathBuf {
        self.path.join(METRICS)
    }

    /// Whether the run has finished, and whether all that it left is still as it was written.
    ///
    /// # Errors
    /// [`StoreError::Io`] if a file is there and cannot be read.
    pub fn state(&self) -> Result<State, StoreError> {
        done::state(&self.path)
    }

    /// Whether the run has finished and everything is there as it was written.
    pub fn is_complete(&self) -> bool {
        matches!(self.state(), Ok(State::Complete))
    }

    /// Whether the run has finished once, whatever has become of its files.
    pub fn has_finished(&self) -> bool {
        done::is_marked(&self.path)
    }

    /// Starts the run afresh: removes what an interrupted one left, evaluations included, and writes `spec.toml` and
    /// `run.json`.
    ///
    /// # Errors
    /// [`StoreError::Io`], [`StoreError::Serialise`] if the spec has no TOML form.
    pub fn start<S: Serialize + ?Sized>(&self, spec: &S, info: &RunInfo) -> Result<PendingRun, StoreError> {
        fresh_folder(&self.path)?;
        write_toml(&self.path.join(SPEC), spec)?;
        write_json(&self.path.join(INFO), info)?;
        Ok(PendingRun { folder: self.clone() })
    }

    /// The run's resolved training spec, `spec.toml`.
    ///
    /// # Errors
    /// [`StoreError::Io`], [`StoreError::Parse`].
    pub fn spec(&self) -> Result<toml::Table, StoreError> {
        read_toml(&self.path.join(SPEC))
    }

    /// The run's `run.json`.
    ///
    /// # Errors
    /// [`StoreError::Io`], [`StoreError::Parse`].
    pub fn info(&self) -> Result<RunInfo, StoreError> {
        read_json(&self.path.join(INFO))
    }

    /// The run's `timing.json`.
    ///
    /// # Errors
    /// [`StoreError::Io`], [`StoreError::Parse`].
    pub fn timing(&self) -> Result<Timing, StoreError> {
        read_json(&self.path.join(TIMING))
    }

    /// The rows of the run's `metrics.csv`, as far as they are written; none if nothing is, or nothing is trained.
    ///
    /// # Errors
    /// [`StoreError::Io`], and [`StoreError::Parse`] if a whole line is not what this version reads.
    pub fn metrics(&self) -> Result<Vec<MetricsRow>, StoreError> {
        let path = self.path.join(METRICS);
        let Some(mut bytes) = read_if_there(&path)? else { return Ok(Vec::new()) };
        // A line that is still being written has no end.
        bytes.truncate(bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1));
        csv::Reader::from_reader(&bytes[..]).deserialize().collect::<Result<_, _>>().map_err(unreadable(&path))
    }

    /// How the policy had collapsed by the end of its training: the run's `collapse.json`; none if an earlier version made the
    /// run, or nothing is trained.
    ///
    /// # Errors
    /// [`StoreError::Io`], [`StoreError::Parse`].
    pub fn collapse(&self) -> Result<Option<Vec<Collapse>>, StoreError> {
        let path = self.path.join(COLLAPSE);
        let bytes = read_if_there(&path)?;
        bytes.map(|bytes| serde_json::from_slice(&bytes).map_err(unreadable(&path))).transpose()
    }

    /// The folder of one of the run's evaluations, which may not exist yet.
    pub fn evaluation(&self, id: &Id) -> EvaluationFolder {
        EvaluationFolder { path: self.path.join("evaluations").join(id.as_str()) }
    }
}

/// A run that has started and not finished.
#[derive(Debug)]
pub struct PendingRun {
    folder: RunFolder,
}

impl PendingRun {
    /// Starts `metrics.csv`.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn metrics(&self) -> Result<MetricsWriter, StoreError> {
        let path = self.folder.path.join(METRICS);
        let file = File::create(&path).map_err(at("create", &path))?;
        Ok(MetricsWriter { writer: csv::Writer::from_writer(file), path })
    }

    /// Writes the policy file.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn write_policy(&self, bytes: &[u8]) -> Result<(), StoreError> {
        let path = self.folder.policy_path();
        fs::write(&path, bytes).map_err(at("write", &path))
    }

    /// Writes `collapse.json`: how the policy had collapsed by the end.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn write_collapse(&self, verdict: &[Collapse]) -> Result<(), StoreError> {
        write_json(&self.folder.path.join(COLLAPSE), &verdict)
    }

    /// Writes `timing.json` and, last, marks the run as complete.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn finish(self, timing: &Timing) -> Result<RunFolder, StoreError> {
        write_json(&self.folder.path.join(TIMING), timing)?;
        done::mark_complete(&self.folder.path)?;
        Ok(self.folder)
    }
}

/// The writer of a run's `metrics.csv`.
#[derive(Debug)]
pub struct MetricsWriter {
    writer: csv::Writer<File>,
    path: PathBuf,
}

impl MetricsWriter {
    /// Appends a row, visible to readers at once; the first row's field names become the header.
    ///
    /// # Errors
    /// [`StoreError::Serialise`] if the row is no flat struct or cannot be written.
    pub fn push(&mut self, row: &impl Serialize) -> Result<(), StoreError> {
        self.writer.serialize(row).map_err(unserialisable(&self.path))?;
        self.writer.flush().map_err(at("write", &self.path))
    }
}

/// The folder of an evaluation, which may not exist yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EvaluationFolder {
    path: PathBuf,
}

impl EvaluationFolder {
    /// The folder's path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the evaluation has finished, and whether all that it left is still as it was written.
    ///
    /// # Errors
    /// [`StoreError::Io`] if a file is there and cannot be read.
    pub fn state(&self) -> Result<State, StoreError> {
        done::state(&self.path)
    }

    /// Whether the evaluation has finished and everything is there as it was written.
    pub fn is_complete(&self) -> bool {
        matches!(self.state(), Ok(State::Complete))
    }

    /// Whether the evaluation has finished once, whatever has become of its files.
    pub fn has_finished(&self) -> bool {
        done::is_marked(&self.path)
    }

    /// Writes the whole evaluation, in place of what an interrupted one left.
    ///
    /// # Errors
    /// [`StoreError::Io`], [`StoreError::Serialise`] if the world's spec has no TOML form.
    pub fn write<W>(
        &self,
        key: &EvaluationKey<'_, W>,
        episodes: &[EpisodeRecord],
        timing: &Timing,
    ) -> Result<(), StoreError>
    where
        W: Serialize + ?Sized,
    {
        fresh_folder(&self.path)?;
        write_toml(&self.path.join(SPEC), key)?;
        let path = self.path.join(EPISODES);
        let mut writer = csv::Writer::from_path(&path).map_err(unserialisable(&path))?;
        episodes.iter().try_for_each(|episode| writer.serialize(episode)).map_err(unserialisable(&path))?;
        writer.flush().map_err(at("write", &path))?;
        write_json(&self.path.join(TIMING), timing)?;
        done::mark_complete(&self.path)
    }

    /// The evaluation's key, `spec.toml`.
    ///
    /// # Errors
    /// [`StoreError::Io`], [`StoreError::Parse`].
    pub fn spec(&self) -> Result<toml::Table, StoreError> {
        read_toml(&self.path.join(SPEC))
    }

    /// The evaluation's `timing.json`.
    ///
    /// # Errors
    /// [`StoreError::Io`], [`StoreError::Parse`].
    pub fn timing(&self) -> Result<Timing, StoreError> {
        read_json(&self.path.join(TIMING))
    }

    /// The episodes, in the order of the scenarios.
    ///
    /// # Errors
    /// [`StoreError::Parse`] if `episodes.csv` is missing or not what this version writes.
    pub fn episodes(&self) -> Result<Vec<EpisodeRecord>, StoreError> {
        let path = self.path.join(EPISODES);
        let mut reader = csv::Reader::from_path(&path).map_err(unreadable(&path))?;
        reader.deserialize().collect::<Result<_, _>>().map_err(unreadable(&path))
    }
}

fn write_toml(path: &Path, value: &(impl Serialize + ?Sized)) -> Result<(), StoreError> {
    let text = toml::to_string(value).map_err(unserialisable(path))?;
    write_atomically(path, text.as_bytes())
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<(), StoreError> {
    let text = serde_json::to_string_pretty(value).map_err(unserialisable(path))?;
    write_atomically(path, (text + "\n").as_bytes())
}

fn read_toml(path: &Path) -> Result<toml::Table, StoreError> {
    let text = fs::read_to_string(path).map_err(at("read", path))?;
    toml::from_str(&text).map_err(unreadable(path))
}

fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T, StoreError> {
    let bytes = fs::read(path).map_err(at("read", path))?;
    serde_json::from_slice(&bytes).map_err(unreadable(path))
}
