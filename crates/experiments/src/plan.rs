//! What a grid comes down to: which runs there are, each once, and where their results belong.

mod conflict;

use std::collections::HashMap;

use serde::Serialize;

use crate::Error;
use crate::spec::{EvaluateWorld, Grid, RunSpec};
use crate::store::{
    AxisLevel, Cell, EvaluationKey, GridAxis, Id, Index, IndexedEvaluation, IndexedRun, StoreError, TrainKey,
};

/// The runs of a grid, and the index that says where their results belong.
#[derive(Debug)]
pub(crate) struct Plan<'a> {
    grid: &'a Grid,
    pub(crate) runs: Vec<Run<'a>>,
    pub(crate) index: Index,
}

/// One training run, and the evaluations of its policy that any cell asks for.
#[derive(Debug)]
pub(crate) struct Run<'a> {
    pub(crate) spec: &'a RunSpec,
    /// The first cell that has the run, and the seed: `reward=R agent=DQN, seed 3`.
    pub(crate) label: String,
    pub(crate) seed: u64,
    pub(crate) id: Id,
    pub(crate) evaluations: Vec<Evaluation<'a>>,
}

/// One evaluation of a run.
#[derive(Debug)]
pub(crate) struct Evaluation<'a> {
    pub(crate) id: Id,
    pub(crate) spec: &'a RunSpec,
    pub(crate) world: &'a EvaluateWorld,
}

/// The tables of a run that its training depends on: all but `[evaluate]`.
#[derive(Debug, Serialize)]
pub(crate) struct TrainTables<'a> {
    world: &'a headway_sim::WorldSpec,
    vehicle: &'a headway_sim::VehicleSpec,
    lidar: &'a headway_sensors::LidarSpec,
    odometry: &'a headway_sensors::OdometrySpec,
    randomize: &'a headway_env::RandomizeSpec,
    env: &'a headway_env::EnvSpec,
    reward: &'a dyn headway_reward::Reward,
    agent: &'a headway_rl::DqnSpec,
    train: &'a crate::spec::TrainSpec,
}

impl<'a> TrainTables<'a> {
    pub(crate) fn of(spec: &'a RunSpec) -> Self {
        let RunSpec { world, vehicle, lidar, odometry, randomize, env, reward, agent, train, evaluate: _ } = spec;
        Self { world, vehicle, lidar, odometry, randomize, env, reward: &**reward, agent, train }
    }
}

/// The id of the training run of a spec with a seed.
///
/// # Errors
/// [`StoreError::Serialise`] if the spec has no TOML form.
pub(crate) fn train_id(spec: &RunSpec, seed: u64) -> Result<Id, StoreError> {
    TrainKey { spec: &TrainTables::of(spec), seed, reward_version: spec.reward.version() }.id()
}

/// What an evaluation depends on beside the trained policy.
pub(crate) fn evaluation_key<'a>(
    spec: &RunSpec,
    world: &'a EvaluateWorld,
) -> EvaluationKey<'a, headway_sim::WorldSpec> {
    let EvaluateWorld { name: _, time_limit, world } = world;
    EvaluationKey { n_episodes: spec.evaluate.n_episodes, seed: spec.evaluate.seed, time_limit: *time_limit, world }
}

impl<'a> Plan<'a> {
    /// The plan of a grid; touches no file.
    ///
    /// # Errors
    /// If a spec has no TOML form.
    pub(crate) fn new(grid: &'a Grid) -> Result<Self, Error> {
        let mut plan = Self { grid, runs: Vec::new(), index: index(grid) };
        let mut places = HashMap::new();
        for (cell, indexed) in grid.cells.iter().zip(0..) {
            let evaluations = evaluations(&cell.spec)?;
            plan.index.cells[indexed].evaluations = evaluations.iter().map(Evaluation::indexed).collect();
            for seed in grid.seeds.iter() {
                let id = train_id(&cell.spec, seed)?;
                plan.index.cells[indexed].runs.push(IndexedRun { seed, train_id: id.clone() });
                let place = *places.entry(id.clone()).or_insert(plan.runs.len());
                if place == plan.runs.len() {
                    plan.runs.push(Run::new(cell, seed, id));
                }
                plan.runs[place].also(&evaluations);
            }
        }
        Ok(plan)
    }
}

/// The index of a grid whose cells have no runs yet.
fn index(grid: &Grid) -> Index {
    let level = |(axis, level): &(String, String)| AxisLevel { axis: axis.clone(), level: level.clone() };
    let cells = grid.cells.iter().map(|cell| Cell {
        axes: cell.axes.iter().map(level).collect(),
        runs: Vec::new(),
        evaluations: Vec::new(),
    });
    let axes = grid
        .axes
        .iter()
        .map(|axis| GridAxis { name: axis.name.clone(), levels: axis.levels.keys().cloned().collect() });
    Index { name: grid.name.clone(), axes: axes.collect(), cells: cells.collect() }
}

/// The evaluations that a cell asks for.
fn evaluations(spec: &RunSpec) -> Result<Vec<Evaluation<'_>>, StoreError> {
    let evaluation = |world| Ok(Evaluation { id: evaluation_key(spec, world).id()?, spec, world });
    spec.evaluate.worlds.iter().map(evaluation).collect()
}

impl Evaluation<'_> {
    fn indexed(&self) -> IndexedEvaluation {
        IndexedEvaluation { world: self.world.name.clone(), eval_id: self.id.clone() }
    }
}

impl<'a> Run<'a> {
    fn new(cell: &'a crate::spec::Cell, seed: u64, id: Id) -> Self {
        Self { spec: &cell.spec, label: labelled(cell, seed), seed, id, evaluations: Vec::new() }
    }

    /// Adds the evaluations that the run does not yet have.
    fn also(&mut self, evaluations: &[Evaluation<'a>]) {
        for Evaluation { id, spec, world } in evaluations {
            if self.evaluations.iter().all(|known| known.id != *id) {
                self.evaluations.push(Evaluation { id: id.clone(), spec, world });
            }
        }
    }
}

/// A cell and a seed in words: `reward=R agent=DQN, seed 3`, or `seed 3` where there is no axis.
fn labelled(cell: &crate::spec::Cell, seed: u64) -> String {
    if cell.axes.is_empty() { format!("seed {seed}") } else { format!("{}, seed {seed}", cell.label()) }
}
