//! What `experiments run` has to do: scenarios that runs share, then the runs.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::Arc;

use headway_policy::Policy;

use super::run::note;
use crate::Error;
use crate::episode::EpisodeRecord;
use crate::evaluate::{ScenarioSet, for_policy};
use crate::jobs::{self, Display, Job, Progress};
use crate::plan::{Evaluation, Run, TrainTables, evaluation_key};
use crate::store::{RunInfo, State, Stopwatch, Store};
use crate::train::Training;

/// The work in an evaluation episode, in env steps of training: an episode without learning took 55 us where an env step
/// of training took 2.9 us (specs/default.toml).
const EPISODE_WORK: u64 = 20;

/// The held-out scenarios by name, made once for all runs that share them.
type Scenarios = BTreeMap<String, ScenarioSet>;

/// What is missing of a run.
pub(super) struct Task<'a> {
    run: &'a Run<'a>,
    trains: bool,
    evaluations: Vec<&'a Evaluation<'a>>,
}

/// Does all that is missing on `n_workers` threads: first the scenarios, then the runs, those with the most work first, so
/// that no thread is still busy with a long one when the others have run out.
///
/// # Errors
/// That of the first piece of work that failed.
pub(super) fn complete(tasks: Vec<Task<'_>>, store: &Store, n_workers: NonZeroUsize) -> Result<(), Error> {
    let scenarios = make_scenarios(&tasks, n_workers)?;
    let mut jobs: Vec<_> = tasks.into_iter().map(Task::into_job).collect();
    jobs.sort_by_key(|job| Reverse(job.work));
    jobs::run(&jobs, n_workers, Display::auto("runs"), |task, progress| task.complete(store, &scenarios, progress))?;
    Ok(())
}

fn make_scenarios(tasks: &[Task<'_>], n_workers: NonZeroUsize) -> Result<Scenarios, Error> {
    let mut missing = BTreeMap::new();
    for evaluation in tasks.iter().flat_map(|task| &task.evaluations) {
        missing.entry(scenarios_name(evaluation)?).or_insert(*evaluation);
    }
    let n_episodes = |evaluation: &Evaluation<'_>| evaluation.spec.evaluate.n_episodes as u64;
    let jobs: Vec<_> = missing.values().map(|input| Job { work: n_episodes(input), input }).collect();
    let sets = jobs::run(&jobs, n_workers, Display::auto("sets of scenarios"), |evaluation, _| {
        let Evaluation { spec, world, .. } = evaluation;
        let mdp = spec.evaluation(world).build().map_err(Error::failure)?;
        ScenarioSet::new(&mdp, spec.evaluate.n_episodes, spec.evaluate.seed)
    })?;
    Ok(missing.into_keys().zip(sets).collect())
}

/// A name for all that the scenarios of an evaluation depend on: the world, how many, the seed, the vehicle that must fit
/// through, and the goal's radius.
fn scenarios_name(Evaluation { spec, world, .. }: &Evaluation<'_>) -> Result<String, Error> {
    let key = evaluation_key(spec, world).id()?;
    Ok(format!("{key}/{:?}/{}", spec.vehicle.footprint, spec.env.reach_radius))
}

impl<'a> Task<'a> {
    /// What is missing, or damaged, which is said.
    pub(super) fn of(run: &'a Run<'a>, store: &Store) -> Result<Self, Error> {
        let folder = store.run(&run.id);
        if !is_whole(&folder.state()?) {
            return Ok(Self { run, trains: true, evaluations: run.evaluations.iter().collect() });
        }
        let mut evaluations = Vec::new();
        for evaluation in &run.evaluations {
            if !is_whole(&folder.evaluation(&evaluation.id).state()?) {
                evaluations.push(evaluation);
            }
        }
        Ok(Self { run, trains: false, evaluations })
    }

    pub(super) fn is_any(&self) -> bool {
        self.trains || !self.evaluations.is_empty()
    }

    fn into_job(self) -> Job<Self> {
        let n_episodes: usize = self.evaluations.iter().map(|evaluation| evaluation.spec.evaluate.n_episodes).sum();
        let n_steps = if self.trains { self.run.spec.train.n_steps } else { 0 };
        Job { work: n_steps + EPISODE_WORK * n_episodes as u64, input: self }
    }

    fn complete(&self, store: &Store, scenarios: &Scenarios, progress: &Progress<'_>) -> Result<(), Error> {
        self.work(store, scenarios, progress).map_err(|error| Error::Run {
            run: format!("{}, in {}", self.run.label, store.run(&self.run.id).path().display()),
            source: Box::new(error),
        })
    }

    fn work(&self, store: &Store, scenarios: &Scenarios, progress: &Progress<'_>) -> Result<(), Error> {
        if self.trains {
            train(self.run, store, progress)?;
        }
        let policy = Arc::new(Policy::load(&store.run(&self.run.id).policy_path()).map_err(Error::failure)?);
        for evaluation in &self.evaluations {
            let set = &scenarios[&scenarios_name(evaluation)?];
            let Evaluation { id, spec, world } = evaluation;
            let stopwatch = Stopwatch::start();
            let (mdp, mut driver) = for_policy(spec.evaluation(world), &policy)?;
            let drive = |index| {
                progress.advance(EPISODE_WORK);
                set.drive(&mdp, &mut driver, index, |_| ())
            };
            let episodes: Vec<EpisodeRecord> = (0..set.len()).map(drive).collect::<Result<_, _>>()?;
            let key = evaluation_key(spec, world);
            store.run(&self.run.id).evaluation(id).write(&key, &episodes, &stopwatch.stop())?;
        }
        Ok(())
    }
}

fn train(run: &Run<'_>, store: &Store, progress: &Progress<'_>) -> Result<(), Error> {
    let stopwatch = Stopwatch::start();
    let info = RunInfo::new(run.seed, run.spec.reward.version());
    let pending = store.run(&run.id).start(&TrainTables::of(run.spec), &info)?;
    let mut metrics = pending.metrics()?;
    let mut training = Training::new(run.spec, run.seed)?;
    while !training.is_over() {
        training.step()?;
        progress.advance(run.spec.train.n_envs as u64);
        if let Some(row) = training.metrics() {
            metrics.push(&row)?;
        }
    }
    pending.write_policy(&training.policy()?.to_bytes().map_err(Error::failure)?)?;
    pending.finish(&stopwatch.stop())?;
    Ok(())
}

/// Whether a folder is complete; says so if it was and is no more.
fn is_whole(state: &State) -> bool {
    if let State::Damaged { folder, what } = state {
        note(&format!("`{}` is damaged: {what}; it is made anew", folder.display()));
    }
    *state == State::Complete
}
