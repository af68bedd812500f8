//! Worlds from files as data.

use std::path::PathBuf;

use rand::RngExt;
use rand::seq::SliceRandom;
use serde::{Deserialize, Serialize};

use super::{GoalRule, Scenario, generate};
use crate::check::fraction;
use crate::files::{self, FileSpec, WorldFile};
use crate::{FieldError, Footprint, Point, Pose, SimError, stream};

/// Scenarios in worlds from files, each in one of them.
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
    /// If a folder cannot be listed, or there is no world file at all.
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
        Ok(found)
    }

    /// Those of the asked part.
    fn chosen(&self) -> Result<Vec<PathBuf>, SimError> {
        fraction("test_share", self.test_share)?;
        let all = self.files()?;
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.shuffle(&mut stream(self.split_seed, "split", 0));
        let n_test = (self.test_share * all.len() as f64).round() as usize;
        let mut chosen = match self.part {
            FilePart::All => order,
            FilePart::Test => order[..n_test].to_vec(),
            FilePart::Train => order[n_test..].to_vec(),
        };
        if chosen.is_empty() {
            let n = all.len();
            let allowed = format!("such that some of the {n} files are left for part = {:?}", self.part);
            return Err(FieldError::new("test_share", self.test_share, allowed.to_lowercase()).into());
        }
        chosen.sort_unstable();
        Ok(chosen.into_iter().map(|index| all[index].clone()).collect())
    }

    /// Reads the files and checks that a vehicle can start in each of them.
    pub(super) fn build(&self, footprint: &Footprint) -> Result<Files, SimError> {
        let mut read = Vec::new();
        for path in self.chosen()? {
            let mut file = files::read(&path, &self.read)?;
            file.start = self.start.map(|[x, y, yaw]| Pose::new([x, y].into(), yaw)).or(file.start);
            file.goal = self.goal.map(Point::from).or(file.goal);
            let in_file = |field, value: String, allowed: &str| {
                SimError::from(FieldError::new(field, value, format!("{allowed} in {}", path.display())))
            };
            self.goal_rule().check(&file.world.room()).map_err(|e| in_file("goal_rule", e.to_string(), "allowed"))?;
            if let Some(start) = file.start.filter(|start| file.world.collides(footprint, start)) {
                let place = format!("({}, {})", start.translation.x, start.translation.y);
                return Err(in_file("start", place, "a place where the vehicle touches nothing,"));
            }
            let is_blocked = |goal: &Point| {
                let room = file.world.distance(goal);
                room.is_nan() || room <= 0.0
            };
            if let Some(goal) = file.goal.filter(is_blocked) {
                return Err(in_file("goal", format!("({}, {})", goal.x, goal.y), "outside of all obstacles"));
            }
            read.push(file);
        }
        Ok(Files { spec: self.clone(), files: read })
    }
}

/// The files, read.
#[derive(Debug, Clone)]
pub(super) struct Files {
    spec: FilesSpec,
    files: Vec<WorldFile>,
}

impl Files {
    /// A scenario in one of the files.
    pub(super) fn scenario(
        &self,
        footprint: &Footprint,
        mut layout: impl RngExt,
        mut ends: impl RngExt,
    ) -> Result<Scenario, SimError> {
        let file = &self.files[layout.random_range(0..self.files.len())];
        let (world, goal_rule) = (file.world.clone(), self.spec.goal_rule());
        let (start, goal) = match (file.start, file.goal) {
            (Some(start), Some(goal)) => (start, goal),
            (start, goal) => {
                let (drawn_start, drawn_goal) = generate::start_and_goal(&goal_rule, &world, footprint, &mut ends)?;
                (start.unwrap_or(drawn_start), goal.unwrap_or(drawn_goal))
            }
        };
        Ok(Scenario { world, start, goal, goal_rule, crowd: None })
    }
}
