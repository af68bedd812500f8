//! Worlds from files as data.

mod one_file;
mod other_end;
mod split;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use super::populate::check_crowd;
use super::{GoalRule, Scenario};
use crate::check::fraction;
use crate::files::{self, FileSpec};
use crate::{CrowdSpec, FieldError, Footprint, SimError, stream};
use one_file::OneFile;

/// Scenarios in worlds from files, each in one of them.
///
/// Files are split by draws from `split_seed` and their names without folder and ending (of equal names, also which of
/// them in the order of the paths it is): the rounded `test_share` of them with the lowest draws are for tests. So the
/// same folder elsewhere is split alike, and a file of a new name moves at most one of the others to the other side.
///
/// What is not given of start and goal is drawn anew for each scenario, at least `start_goal_distance` from the other
/// and joined to it by a path as wide as the vehicle's circumscribed circle: a given start or goal from which only
/// narrower ones lead away is refused. Where both are given, whether a path joins them is not checked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FilesSpec {
    /// World files and folders of them, from the working directory.
    pub paths: Vec<PathBuf>,
    /// Which of them.
    pub part: FilePart,
    /// The share of the files that are for tests, 0 to 1, rounded to whole files.
    pub test_share: f64,
    /// By which seed files are drawn for tests.
    pub split_seed: u64,
    /// Where the vehicle starts, `[x, y, yaw]` in metres and radians. If not given, where the file says, or else at random.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<[f64; 3]>,
    /// Where it is to go, `[x, y]` in metres; likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub goal: Option<[f64; 2]>,
    /// Least straight distance of random starts and goals, metres.
    pub start_goal_distance: f64,
    /// Least clearance of random starts and goals, metres, at least 0.01.
    pub start_goal_clearance: f64,
    /// How files are read.
    pub read: FileSpec,
    /// What moves in the worlds, beside what stands in the files; nothing if not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crowd: Option<CrowdSpec>,
}

/// Which of the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FilePart {
    /// All.
    #[default]
    All,
    /// Those that are not for tests.
    Train,
    /// Those that are.
    Test,
}

impl Default for FilesSpec {
    fn default() -> Self {
        Self {
            paths: Vec::new(),
            part: FilePart::All,
            test_share: 0.2,
            split_seed: 0,
            start: None,
            goal: None,
            start_goal_distance: 4.0,
            start_goal_clearance: 0.2,
            read: FileSpec::default(),
            crowd: None,
        }
    }
}

impl FilesSpec {
    /// What random starts and goals satisfy.
    #[must_use]
    pub fn goal_rule(&self) -> GoalRule {
        GoalRule { distance: self.start_goal_distance, clearance: self.start_goal_clearance }
    }

    /// The files, in the order of the paths and within a folder of their names and numbers, before they are split.
    ///
    /// # Errors
    /// If a folder cannot be listed, there is no world file at all, or one of them is named twice: it could be on both
    /// sides of the split.
    pub fn files(&self) -> Result<Vec<PathBuf>, SimError> {
        let mut found = Vec::new();
        for path in &self.paths {
            if path.is_dir() { found.extend(files::list(path)?) } else { found.push(path.clone()) }
        }
        if found.is_empty() {
            let paths: Vec<String> = self.paths.iter().map(|path| path.display().to_string()).collect();
            let allowed = "world files (.world, .sdf, .yaml), or folders that hold some";
            return Err(FieldError::new("paths", format!("[{}]", paths.join(", ")), allowed).into());
        }
        refuse_twins(&found)?;
        Ok(found)
    }

    /// Those of the asked part.
    fn chosen(&self) -> Result<Vec<PathBuf>, SimError> {
        fraction("test_share", self.test_share)?;
        let all = self.files()?;
        let n = all.len();
        let n_test = (self.test_share * n as f64).round() as usize;
        let chosen = split::part(all, self.part, n_test, self.split_seed);
        if chosen.is_empty() {
            let allowed = format!("such that some of the {n} files are left for part = {:?}", self.part);
            return Err(FieldError::new("test_share", self.test_share, allowed.to_lowercase()).into());
        }
        Ok(chosen)
    }

    /// Reads the files and makes a scenario in each, so that none is met for the first time in the midst of a run.
    pub(super) fn build(&self, footprint: &Footprint) -> Result<Files, SimError> {
        check_crowd(self.crowd.as_ref())?;
        let files = self.chosen()?.into_iter().map(|path| OneFile::read(path, self)).collect::<Result<Vec<_>, _>>()?;
        for file in &files {
            file.check(footprint)?;
            let [ends, crowd] = ["trial-ends", "trial-crowd"].map(|name| stream(0, name, 0));
            file.scenario(footprint, ends, self.crowd.as_ref(), crowd)?;
        }
        Ok(Files { files, crowd: self.crowd.clone() })
    }
}

/// Refuses a file that is there twice, be it by another path.
fn refuse_twins(paths: &[PathBuf]) -> Result<(), FieldError> {
    let mut seen = HashMap::<PathBuf, &Path>::new();
    for path in paths {
        // What cannot be found is refused when it is read.
        let real = path.canonicalize().unwrap_or_else(|_| path.clone());
        if let Some(twin) = seen.insert(real, path) {
            let allowed = format!("named once: it is the same file as {}", twin.display());
            return Err(FieldError::new("paths", path.display(), allowed));
        }
    }
    Ok(())
}

/// The files, read.
#[derive(Debug, Clone)]
pub(super) struct Files {
    files: Vec<OneFile>,
    crowd: Option<CrowdSpec>,
}

impl Files {
    /// What the files hold and the worlds do not, file by file.
    pub(super) fn left_out(&self) -> impl Iterator<Item = String> {
        self.files.iter().flat_map(OneFile::left_out)
    }

    /// A scenario in one of the files.
    pub(super) fn scenario(
        &self,
        footprint: &Footprint,
        mut layout: impl RngExt,
        ends: impl RngExt,
        crowd: ChaCha8Rng,
    ) -> Result<Scenario, SimError> {
        let file = &self.files[layout.random_range(0..self.files.len())];
        file.scenario(footprint, ends, self.crowd.as_ref(), crowd)
    }
}
