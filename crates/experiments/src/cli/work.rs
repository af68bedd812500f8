//! What `experiments run` has to do: scenarios that runs share, then the runs.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::num::NonZeroUsize;
use std::ops::Range;

use super::run::note;
use crate::Error;
use crate::candidate::Candidate;
use crate::episode::EpisodeRecord;
use crate::evaluate::ScenarioSet;
use crate::jobs::{self, Display, Job, Progress};
use crate::plan::{Evaluation, Run, TrainTables, seed_and_reward};
use crate::spec::{PolicySpec, RunSpec};
use crate::store::{RunInfo, State, Stopwatch, Store};
use crate::train::Training;

/// The work in an evaluation episode, in the unit of [`step_work`]: some 55 us.
const EPISODE_WORK: u64 = 5000;
/// How many scenarios are made at a time: some tenths of a second.
const SCENARIO_BATCH: usize = 1000;

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

/// Makes the scenarios in batches, so that no thread waits for another one's whole set.
fn make_scenarios(tasks: &[Task<'_>], n_workers: NonZeroUsize) -> Result<Scenarios, Error> {
    let mut missing = BTreeMap::new();
    for evaluation in tasks.iter().flat_map(|task| &task.evaluations) {
        missing.entry(evaluation.scenarios.clone()).or_insert(*evaluation);
    }
    let mut jobs = Vec::new();
    for (name, evaluation) in &missing {
        let n = evaluation.spec.evaluate.n_episodes;
        let batches = (0..n).step_by(SCENARIO_BATCH).map(|first| first..n.min(first + SCENARIO_BATCH));
        jobs.extend(batches.map(|batch| Job { work: batch.len() as u64, input: (name, *evaluation, batch) }));
    }
    let batches = jobs::run(&jobs, n_workers, Display::auto("batches of scenarios"), |(_, evaluation, batch), _| {
        scenario_batch(evaluation, batch.clone())
    })?;
    let mut scenarios = Scenarios::new();
    for (job, batch) in jobs.into_iter().zip(batches) {
        match scenarios.entry(job.input.0.clone()) {
            Entry::Vacant(entry) => drop(entry.insert(batch)),
            Entry::Occupied(mut entry) => entry.get_mut().append(batch),
        }
    }
    Ok(scenarios)
}

fn scenario_batch(Evaluation { spec, world, .. }: &Evaluation<'_>, batch: Range<usize>) -> Result<ScenarioSet, Error> {
    let mdp = spec.evaluation(world).build().map_err(Error::failure)?;
    ScenarioSet::part(&mdp, batch.clone(), spec.evaluate.seed).map_err(|error| Error::Run {
        run: format!("scenarios {} to {} of the evaluation world `{}`", batch.start, batch.end - 1, world.name),
        source: Box::new(error),
    })
}

/// The work in an env step of a training, in tens of nanoseconds or so: the step itself, its beams, and its share of a
/// gradient step, by the figures of `docs/benchmarks.md`.
fn step_work(spec: &RunSpec) -> u64 {
    let (agent, n_beams) = (&spec.agent, spec.lidar.n_beams as f64);
    let mut n_weights = 0.0;
    let mut n_in = n_beams + 6.0;
    for n_out in agent.hidden.iter().map(|width| *width as f64) {
        n_weights += n_in * n_out;
        n_in = n_out;
    }
    let gradient = n_weights * agent.batch_size as f64 / agent.update_every as f64;
    (80.0 + n_beams / 6.0 + gradient / 100.0) as u64
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
        let training = if self.trains && self.run.spec.policy.is_learned() {
            self.run.spec.train.n_steps.saturating_mul(step_work(self.run.spec))
        } else {
            0
        };
        Job { work: training.saturating_add(EPISODE_WORK * n_episodes as u64), input: self }
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
        let candidate = self.candidate(store)?;
        for evaluation in &self.evaluations {
            let Evaluation { id, key, scenarios: name, spec, world } = evaluation;
            let set = &scenarios[name];
            let stopwatch = Stopwatch::start();
            let candidate = candidate.clone().shielded(spec.shield());
            let (mdp, mut driver) = candidate.set_up(spec.evaluation(world))?;
            let drive = |index| {
                progress.advance(EPISODE_WORK);
                set.drive(&mdp, &mut *driver, index, |_| ())
            };
            let episodes: Vec<EpisodeRecord> = (0..set.len()).map(drive).collect::<Result<_, _>>()?;
            store.run(&self.run.id).evaluation(id).write(key, &episodes, &stopwatch.stop())?;
        }
        Ok(())
    }

    /// Who drives.
    fn candidate(&self, store: &Store) -> Result<Candidate, Error> {
        match &self.run.spec.policy {
            PolicySpec::Learned {} => Candidate::load(&store.run(&self.run.id).policy_path()),
            PolicySpec::File { path } => Candidate::load(path),
            driver => Ok(Candidate::driver_of(driver.driver().expect("all others are classical drivers"))),
        }
    }
}

/// Trains, if anything is to be trained, and leaves the run's folder behind.
fn train(run: &Run<'_>, store: &Store, progress: &Progress<'_>) -> Result<(), Error> {
    let stopwatch = Stopwatch::start();
    let (seed, reward_version) = seed_and_reward(run.spec, run.seed);
    let pending = store.run(&run.id).start(&TrainTables::of(run.spec)?, &RunInfo::new(seed, reward_version))?;
    if !run.spec.policy.is_learned() {
        pending.finish(&stopwatch.stop())?;
        return Ok(());
    }
    let mut metrics = pending.metrics()?;
    let mut training = Training::new(run.spec, run.seed)?;
    let work_a_step = run.spec.train.n_envs as u64 * step_work(run.spec);
    while !training.is_over() {
        training.step()?;
        progress.advance(work_a_step);
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
