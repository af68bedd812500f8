//! `experiments run`: trains and evaluates what a spec stands for and is not yet there.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::io::Write;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::available_parallelism;

use headway_policy::{Driver, Policy};
use serde::Serialize;

use super::args::RunArgs;
use super::print;
use crate::Error;
use crate::evaluate::{ScenarioSet, for_policy};
use crate::jobs::{self, Display, Job, Progress};
use crate::report;
use crate::spec::{EvaluateWorld, Grid, RunSpec};
use crate::store::{
    AxisLevel, Cell, EvaluationKey, GridAxis, Id, Index, IndexedEvaluation, IndexedRun, RunInfo, Stopwatch, Store,
    TrainKey,
};
use crate::train::Training;

/// Trains and evaluates every run of the grid that is not yet in the results folder, then prints the report.
///
/// # Errors
/// Whatever is wrong with the spec or the folder, or the first run that failed.
pub fn execute(args: &RunArgs, out: &mut dyn Write) -> Result<(), Error> {
    let grid = Grid::load(&args.spec, &args.set)?;
    let folder = args.out.clone().unwrap_or_else(|| Path::new("results").join(&grid.name));
    let plan = Plan::new(&grid)?;
    let store = Store::open(&folder)?;
    store.write_index(&plan.index)?;
    let missing: Vec<Job<&Run<'_>>> = plan.runs.iter().filter(|run| !run.is_complete(&store)).map(Run::job).collect();
    let n_workers = args.jobs.or_else(|| available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);
    let scenarios = ScenarioCache::default();
    jobs::run(&missing, n_workers, Display::auto(), |run, progress| run.complete(&store, &scenarios, progress))?;
    let text = report::load(&folder)?.table();
    print(out, &format!("{text}\nresults in {}\n", folder.display()))
}

/// What a grid comes down to: which runs there are, each once, and where their results belong.
struct Plan<'a> {
    runs: Vec<Run<'a>>,
    index: Index,
}

/// One training run, and the evaluations of its policy that any cell asks for.
struct Run<'a> {
    spec: &'a RunSpec,
    seed: u64,
    id: Id,
    evaluations: Vec<(Id, &'a RunSpec, &'a EvaluateWorld)>,
}

/// The tables of a run that its training depends on: all but `[evaluate]`.
#[derive(Serialize)]
struct TrainTables<'a> {
    world: &'a headway_sim::WorldSpec,
    vehicle: &'a headway_sim::VehicleSpec,
    lidar: &'a headway_sensors::LidarSpec,
    env: &'a headway_env::EnvSpec,
    reward: &'a dyn headway_reward::Reward,
    agent: &'a headway_rl::DqnSpec,
    train: &'a crate::spec::TrainSpec,
}

impl<'a> TrainTables<'a> {
    fn of(spec: &'a RunSpec) -> Self {
        let RunSpec { world, vehicle, lidar, env, reward, agent, train, evaluate: _ } = spec;
        Self { world, vehicle, lidar, env, reward: &**reward, agent, train }
    }
}

/// What an evaluation depends on beside the trained policy.
fn evaluation_key<'a>(spec: &RunSpec, world: &'a EvaluateWorld) -> EvaluationKey<'a, headway_sim::WorldSpec> {
    let EvaluateWorld { name: _, time_limit, world } = world;
    EvaluationKey { n_episodes: spec.evaluate.n_episodes, seed: spec.evaluate.seed, time_limit: *time_limit, world }
}

impl<'a> Plan<'a> {
    fn new(grid: &'a Grid) -> Result<Self, Error> {
        let mut runs: Vec<Run<'a>> = Vec::new();
        let mut places = HashMap::new();
        let mut cells = Vec::new();
        for cell in &grid.cells {
            let worlds = &cell.spec.evaluate.worlds;
            let ids: Vec<Id> =
                worlds.iter().map(|world| evaluation_key(&cell.spec, world).id()).collect::<Result<_, _>>()?;
            let mut indexed = Vec::new();
            for seed in grid.seeds.iter() {
                let key =
                    TrainKey { spec: &TrainTables::of(&cell.spec), seed, reward_version: cell.spec.reward.version() };
                let id = key.id()?;
                let place = *places.entry(id.clone()).or_insert(runs.len());
                if place == runs.len() {
                    runs.push(Run { spec: &cell.spec, seed, id: id.clone(), evaluations: Vec::new() });
                }
                for (eval_id, world) in ids.iter().zip(worlds) {
                    if runs[place].evaluations.iter().all(|(known, ..)| known != eval_id) {
                        runs[place].evaluations.push((eval_id.clone(), &cell.spec, world));
                    }
                }
                indexed.push(IndexedRun { seed, train_id: id });
            }
            let evaluations = worlds.iter().zip(ids);
            cells.push(Cell {
                axes: cell.axes.iter().cloned().map(|(axis, level)| AxisLevel { axis, level }).collect(),
                runs: indexed,
                evaluations: evaluations
                    .map(|(world, eval_id)| IndexedEvaluation { world: world.name.clone(), eval_id })
                    .collect(),
            });
        }
        let axes = grid
            .axes
            .iter()
            .map(|axis| GridAxis { name: axis.name.clone(), levels: axis.levels.keys().cloned().collect() });
        let index = Index { name: grid.name.clone(), axes: axes.collect(), cells };
        Ok(Self { runs, index })
    }
}

impl Run<'_> {
    /// Work that an evaluation episode counts for in the progress, env steps.
    const EPISODE_STEPS: u64 = 30;

    fn is_complete(&self, store: &Store) -> bool {
        let folder = store.run(&self.id);
        folder.is_complete() && self.evaluations.iter().all(|(id, ..)| folder.evaluation(id).is_complete())
    }

    fn job(&self) -> Job<&Self> {
        let n_episodes: usize = self.evaluations.iter().map(|(_, spec, _)| spec.evaluate.n_episodes).sum();
        Job { input: self, n_steps: self.spec.train.n_steps + Self::EPISODE_STEPS * n_episodes as u64 }
    }

    /// Does what is missing of the run.
    fn complete(&self, store: &Store, scenarios: &ScenarioCache, progress: &Progress<'_>) -> Result<(), Error> {
        let folder = store.run(&self.id);
        if folder.is_complete() {
            progress.advance(self.spec.train.n_steps);
        } else {
            self.train(store, progress)?;
        }
        let policy = Policy::load(&folder.policy_path()).map_err(Error::failure)?;
        let policy = Arc::new(policy);
        for (id, spec, world) in &self.evaluations {
            let evaluation = folder.evaluation(id);
            if !evaluation.is_complete() {
                let mdp = for_policy(spec.evaluation(world), &policy)?;
                let mut driver = Driver::new(Arc::clone(&policy)).map_err(Error::failure)?;
                let key = evaluation_key(spec, world);
                let set = scenarios.get(&key, &mdp)?;
                evaluation.write(&key, &set.drive_all(&mdp, &mut driver)?)?;
            }
            progress.advance(Self::EPISODE_STEPS * spec.evaluate.n_episodes as u64);
        }
        Ok(())
    }

    fn train(&self, store: &Store, progress: &Progress<'_>) -> Result<(), Error> {
        let stopwatch = Stopwatch::start();
        let info = RunInfo::new(self.seed, self.spec.reward.version());
        let pending = store.run(&self.id).start(&TrainTables::of(self.spec), &info)?;
        let mut metrics = pending.metrics()?;
        let mut training = Training::new(self.spec, self.seed)?;
        while !training.is_over() {
            training.step()?;
            progress.advance(self.spec.train.n_envs as u64);
            if let Some(row) = training.metrics() {
                metrics.push(&row)?;
            }
        }
        pending.write_policy(&training.policy()?.to_bytes().map_err(Error::failure)?)?;
        pending.finish(&stopwatch.stop())?;
        Ok(())
    }
}

/// The held-out scenarios, made once for all runs that share them.
#[derive(Default)]
struct ScenarioCache {
    sets: Mutex<HashMap<String, Arc<OnceLock<Arc<ScenarioSet>>>>>,
}

impl ScenarioCache {
    /// The scenarios of an evaluation for the vehicle of `mdp`.
    fn get(
        &self,
        key: &EvaluationKey<'_, headway_sim::WorldSpec>,
        mdp: &headway_env::Mdp,
    ) -> Result<Arc<ScenarioSet>, Error> {
        // What a scenario depends on: the world, the seed, and the vehicle that must fit through.
        let name = format!("{}/{:?}/{}", key.id()?, mdp.vehicle().footprint().shape(), mdp.reach_radius());
        let slot = match self.sets.lock().unwrap_or_else(PoisonError::into_inner).entry(name) {
            Entry::Occupied(entry) => Arc::clone(entry.get()),
            Entry::Vacant(entry) => Arc::clone(entry.insert(Arc::default())),
        };
        if let Some(set) = slot.get() {
            return Ok(Arc::clone(set));
        }
        // Two workers may both make it the first time; they make the same.
        let set = Arc::new(ScenarioSet::new(mdp, key.n_episodes, key.seed)?);
        Ok(Arc::clone(slot.get_or_init(|| set)))
    }
}
