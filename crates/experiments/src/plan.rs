//! What a grid comes down to: which runs there are, each once, and where their results belong.

mod conflict;

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use headway_sim::WorldSpec;
use serde::Serialize;

use crate::Error;
use crate::spec::{EvaluateSpec, EvaluateWorld, Grid, PolicySpec, RunSpec};
use crate::store::{
    AxisLevel, Cell, EvaluationKey, GridAxis, Id, Index, IndexedEvaluation, IndexedRun, TrainKey, digest,
};

/// The runs of a grid, and the index that says where their results belong.
#[derive(Debug)]
pub(crate) struct Plan<'a> {
    grid: &'a Grid,
    pub(crate) runs: Vec<Run<'a>>,
    pub(crate) index: Index,
}

/// One run, and the evaluations of who drives in it that any cell asks for.
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
#[derive(Debug, Clone)]
pub(crate) struct Evaluation<'a> {
    pub(crate) id: Id,
    pub(crate) key: EvaluationKey<'a, WorldSpec>,
    /// See [`scenarios_name`].
    pub(crate) scenarios: String,
    pub(crate) spec: &'a RunSpec,
    pub(crate) world: &'a EvaluateWorld,
}

/// The tables that a run depends on: of a policy that is trained all but `[policy]` and `[evaluate]`, of any other those that it
/// drives by.
#[derive(Debug, Serialize)]
pub(crate) struct TrainTables<'a> {
    /// SHA-256 of the files that take part: those of training worlds, or a policy's.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    files: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    policy: Option<&'a crate::spec::PolicySpec>,
    #[serde(skip_serializing_if = "Option::is_none")]
    world: Option<&'a headway_sim::WorldSpec>,
    vehicle: &'a headway_sim::VehicleSpec,
    lidar: &'a headway_sensors::LidarSpec,
    odometry: &'a headway_sensors::OdometrySpec,
    randomize: &'a headway_env::RandomizeSpec,
    env: &'a headway_env::EnvSpec,
    #[serde(skip_serializing_if = "Option::is_none")]
    reward: Option<&'a dyn headway_reward::Reward>,
    #[serde(skip_serializing_if = "Option::is_none")]
    agent: Option<&'a headway_rl::DqnSpec>,
    #[serde(skip_serializing_if = "Option::is_none")]
    train: Option<&'a crate::spec::TrainSpec>,
}

impl<'a> TrainTables<'a> {
    /// Those of a spec.
    ///
    /// # Errors
    /// If a file that takes part cannot be read.
    pub(crate) fn of(spec: &'a RunSpec) -> Result<Self, Error> {
        let RunSpec { world, vehicle, lidar, odometry, randomize, env, policy, reward, agent, train, evaluate: _ } =
            spec;
        let is_learned = policy.is_learned();
        let files = match policy {
            PolicySpec::Learned {} => {
                let stages = train.curriculum.iter().map(|stage| &stage.world);
                std::iter::once(world).chain(stages).map(digests_of).collect::<Result<Vec<_>, _>>()?.concat()
            }
            PolicySpec::File { path } => vec![digest_of(path)?],
            _ => Vec::new(),
        };
        Ok(Self {
            files,
            policy: (!is_learned).then_some(policy),
            world: is_learned.then_some(world),
            vehicle,
            lidar,
            odometry,
            randomize,
            env,
            reward: is_learned.then_some(&**reward),
            agent: is_learned.then_some(agent),
            train: is_learned.then_some(train),
        })
    }
}

/// SHA-256 of the files that scenarios of a world come from; none of a world that needs no files.
fn digests_of(world: &WorldSpec) -> Result<Vec<String>, Error> {
    let files = world.files().map_err(|error| Error::Input(error.to_string()))?;
    files.iter().map(|path| digest_of(path)).collect()
}

/// SHA-256 of a file, and of the picture that it names if it is a map.
fn digest_of(path: &Path) -> Result<String, Error> {
    let read = |path: &Path| fs::read(path).map_err(|error| Error::io("read", path, error));
    let mut bytes = read(path)?;
    if let Some(image) = image_of(path, &bytes).filter(|image| image.is_file()) {
        bytes.extend(read(&image)?);
    }
    Ok(digest(&bytes))
}

/// The picture that a map of map_server names.
fn image_of(path: &Path, bytes: &[u8]) -> Option<PathBuf> {
    path.extension().filter(|ending| *ending == "yaml" || *ending == "yml")?;
    let text = std::str::from_utf8(bytes).ok()?;
    let name = text.lines().find_map(|line| line.strip_prefix("image:"))?;
    Some(path.parent()?.join(name.trim().trim_matches(['"', '\''])))
}

/// The id of the run of a spec with a seed, which makes no difference where nothing is trained.
///
/// # Errors
/// If a file that takes part cannot be read, or the spec has no TOML form.
pub(crate) fn train_id(spec: &RunSpec, seed: u64) -> Result<Id, Error> {
    let (seed, reward_version) = seed_and_reward(spec, seed);
    Ok(TrainKey { spec: &TrainTables::of(spec)?, seed, reward_version }.id()?)
}

/// The seed and the version of the reward that count; zeros where nothing is trained.
pub(crate) fn seed_and_reward(spec: &RunSpec, seed: u64) -> (u64, u32) {
    if spec.policy.is_learned() { (seed, spec.reward.version()) } else { (0, 0) }
}

/// What an evaluation depends on beside who drives.
///
/// # Errors
/// If a world file cannot be read.
pub(crate) fn evaluation_key<'a>(
    spec: &RunSpec,
    world: &'a EvaluateWorld,
) -> Result<EvaluationKey<'a, WorldSpec>, Error> {
    let EvaluateWorld { name: _, time_limit, world } = world;
    let EvaluateSpec { n_episodes, seed, shield: _, worlds: _ } = &spec.evaluate;
    Ok(EvaluationKey {
        n_episodes: *n_episodes,
        seed: *seed,
        time_limit: *time_limit,
        files: digests_of(world)?,
        shield: spec.shield(),
        world,
    })
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
            for seed in grid.seeds_of(&cell.spec) {
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
fn evaluations(spec: &RunSpec) -> Result<Vec<Evaluation<'_>>, Error> {
    let evaluation = |world| {
        let key = evaluation_key(spec, world)?;
        Ok(Evaluation { id: key.id()?, scenarios: scenarios_name(spec, &key)?, key, spec, world })
    };
    spec.evaluate.worlds.iter().map(evaluation).collect()
}

/// A name for all that the scenarios of an evaluation depend on: the world, how many, the seed, the vehicle that must fit
/// through, and the goal's radius.
///
/// # Errors
/// If the world has no TOML form.
pub(crate) fn scenarios_name(spec: &RunSpec, key: &EvaluationKey<'_, WorldSpec>) -> Result<String, Error> {
    // Neither the time limit nor a shield makes a difference.
    let key = EvaluationKey { time_limit: 1.0, shield: None, ..key.clone() }.id()?;
    Ok(format!("{key}/{:?}/{}", spec.vehicle.footprint, spec.env.reach_radius))
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
        for evaluation in evaluations {
            if self.evaluations.iter().all(|known| known.id != evaluation.id) {
                self.evaluations.push(evaluation.clone());
            }
        }
    }
}

/// A cell and a seed in words: `reward=R agent=DQN, seed 3`, or `seed 3` where there is no axis.
fn labelled(cell: &crate::spec::Cell, seed: u64) -> String {
    if cell.axes.is_empty() { format!("seed {seed}") } else { format!("{}, seed {seed}", cell.label()) }
}
