//! Scenarios in the world of one file.

use std::path::PathBuf;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::FilesSpec;
use super::other_end::{goal_for, start_for};
use crate::files::{self, FileError, FileProblem, WorldFile};
use crate::scenario::populate::populate;
use crate::scenario::{GoalRule, Scenario, generate};
use crate::{CrowdSpec, FieldError, Footprint, Point, Pose, SimError};

/// A file, read, with the start and the goal that the spec gives instead of its own.
#[derive(Debug, Clone)]
pub(super) struct OneFile {
    path: PathBuf,
    file: WorldFile,
    rule: GoalRule,
}

impl OneFile {
    pub(super) fn read(path: PathBuf, spec: &FilesSpec) -> Result<Self, SimError> {
        let mut file = files::read(&path, &spec.read)?;
        file.start = spec.start.map(|[x, y, yaw]| Pose::new([x, y].into(), yaw)).or(file.start);
        file.goal = spec.goal.map(Point::from).or(file.goal);
        Ok(Self { path, file, rule: spec.goal_rule() })
    }

    /// Refuses a rule that is not allowed in the room, and a start and a goal that are not free.
    pub(super) fn check(&self, footprint: &Footprint) -> Result<(), FieldError> {
        let WorldFile { world, start, goal, .. } = &self.file;
        let here = |allowed: &str| format!("{allowed}, in {}", self.path.display());
        self.rule.check(&world.room()).map_err(|e| FieldError {
            field: format!("start_goal_{}", e.field),
            allowed: here(&e.allowed),
            ..e
        })?;
        let place = |x: f64, y: f64| format!("({x}, {y})");
        if let Some(start) = start.filter(|s| !s.rotation.angle().is_finite() || world.collides(footprint, s)) {
            let value = place(start.translation.x, start.translation.y);
            return Err(FieldError::new("start", value, here("a place where the vehicle touches nothing")));
        }
        let is_free = |goal: &Point| {
            let room = world.distance(goal);
            room.is_finite() && room > 0.0
        };
        match goal.filter(|goal| !is_free(goal)) {
            Some(goal) => Err(FieldError::new("goal", place(goal.x, goal.y), here("outside of all obstacles"))),
            None => Ok(()),
        }
    }

    /// What the file holds and the world does not.
    pub(super) fn left_out(&self) -> impl Iterator<Item = String> {
        self.file.unsupported.iter().map(|what| format!("{}: {what}", self.path.display()))
    }

    /// A scenario, with what is not given drawn at random.
    pub(super) fn scenario(
        &self,
        footprint: &Footprint,
        mut ends: impl RngExt,
        crowd: Option<&CrowdSpec>,
        mut crowd_rng: ChaCha8Rng,
    ) -> Result<Scenario, SimError> {
        let (world, rule, rng) = (&self.file.world, &self.rule, &mut ends);
        let ends = match (self.file.start, self.file.goal) {
            (Some(start), Some(goal)) => Ok((start, goal)),
            (Some(start), None) => goal_for(&start, rule, world, footprint, rng).map(|goal| (start, goal)),
            (None, Some(goal)) => start_for(&goal, rule, world, footprint, rng).map(|start| (start, goal)),
            (None, None) => generate::start_and_goal(rule, world, footprint, rng),
        };
        let (start, goal) = ends.map_err(|e| self.refusal(e))?;
        let scenario = Scenario { world: world.clone(), start, goal, goal_rule: *rule, crowd: None };
        populate(scenario, crowd, footprint, &mut crowd_rng).map_err(|e| self.refusal(e))
    }

    /// What does not work out in this file.
    fn refusal(&self, error: SimError) -> SimError {
        let problem = Box::new(FileProblem::World(error));
        FileError { path: self.path.clone(), place: String::new(), problem }.into()
    }
}
