//! `experiments run`: trains and evaluates what a spec stands for and is not yet there.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use std::thread::available_parallelism;

use headway_policy::Policy;

use super::args::RunArgs;
use super::print;
use crate::Error;
use crate::episode::EpisodeRecord;
use crate::evaluate::{ScenarioSet, for_policy};
use crate::jobs::{self, Display, Job, Progress};
use crate::once_map::OnceMap;
use crate::plan::{Evaluation, Plan, Run, TrainTables, evaluation_key};
use crate::report;
use crate::spec::Grid;
use crate::store::{Id, Index, RunFolder, RunInfo, State, Stopwatch, Store};
use crate::train::Training;

/// The work in an evaluation episode, in env steps of training: an episode of 30 to 80 control steps without learning
/// took 0.23 ms where a step of training took 5.3 us (specs/quick.toml).
const EPISODE_WORK: u64 = 40;

/// Trains and evaluates every run of the grid that is not yet in the results folder, then prints the report.
///
/// # Errors
/// Whatever is wrong with the spec or the folder, or the first run that failed.
pub fn execute(args: &RunArgs, out: &mut dyn Write) -> Result<(), Error> {
    let grid = Grid::load(&args.spec, &args.set)?;
    let folder = args.out.clone().unwrap_or_else(|| Path::new("results").join(&grid.name));
    let plan = Plan::new(&grid)?;
    plan.check_against(&folder)?; // before anything is created
    let store = Store::open(&folder)?;
    plan.check_against(&folder)?; // now that nobody else writes to it
    note_what_leaves(&folder, &plan.index);
    store.write_index(&plan.index)?;
    let tasks: Vec<Task<'_>> = plan.runs.iter().map(|run| Task::of(run, &store)).collect::<Result<_, _>>()?;
    let missing: Vec<Job<Task<'_>>> = tasks.into_iter().filter(Task::is_any).map(Task::into_job).collect();
    if missing.is_empty() {
        note(&format!("nothing to do: all {} runs are there", plan.runs.len()));
    } else {
        let n_workers = args.jobs.or_else(|| available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);
        let scenarios = Scenarios::default();
        jobs::run(&missing, n_workers, Display::auto(), |task, progress| task.complete(&store, &scenarios, progress))?;
    }
    let (text, folder) = (report::load(&folder)?.table(), folder.display());
    print(out, &format!("{text}\nresults in {folder}\nevery run and its policy: experiments report {folder} --runs\n"))
}

/// The held-out scenarios, made once for all runs that share them.
type Scenarios = OnceMap<String, ScenarioSet>;

/// What is missing of a run.
struct Task<'a> {
    run: &'a Run<'a>,
    trains: bool,
    evaluations: Vec<&'a Evaluation<'a>>,
}

impl<'a> Task<'a> {
    /// What is missing, or damaged, which is said.
    fn of(run: &'a Run<'a>, store: &Store) -> Result<Self, Error> {
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

    fn is_any(&self) -> bool {
        self.trains || !self.evaluations.is_empty()
    }

    fn into_job(self) -> Job<Self> {
        let n_episodes: usize = self.evaluations.iter().map(|evaluation| evaluation.spec.evaluate.n_episodes).sum();
        let n_steps = if self.trains { self.run.spec.train.n_steps } else { 0 };
        Job { work: n_steps + EPISODE_WORK * n_episodes as u64, input: self }
    }

    /// Does it.
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
        for Evaluation { id, spec, world } in &self.evaluations {
            let (mdp, mut driver) = for_policy(spec.evaluation(world), &policy)?;
            let key = evaluation_key(spec, world);
            // What a scenario depends on: the world, the seed, and the vehicle that must fit through.
            let name = format!("{}/{:?}/{}", key.id()?, mdp.vehicle().footprint().shape(), mdp.reach_radius());
            let set = scenarios.get(name, || ScenarioSet::new(&mdp, key.n_episodes, key.seed))?;
            let stopwatch = Stopwatch::start(); // the scenarios are nobody's own
            let drive = |index| {
                progress.advance(EPISODE_WORK);
                set.drive(&mdp, &mut driver, index, |_| ())
            };
            let episodes: Vec<EpisodeRecord> = (0..set.len()).map(drive).collect::<Result<_, _>>()?;
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

/// Says how many finished runs the report will no longer show.
fn note_what_leaves(folder: &Path, index: &Index) {
    let Ok(held) = Index::load(folder) else { return };
    let mut ids: Vec<&Id> = held.cells.iter().flat_map(|cell| &cell.runs).map(|run| &run.train_id).collect();
    ids.sort();
    ids.dedup(); // cells may share a run
    let stays = |id: &Id| index.cells.iter().flat_map(|cell| &cell.runs).any(|run| run.train_id == *id);
    let n_leaving = ids.iter().filter(|id| !stays(id) && RunFolder::new(folder, id).has_finished()).count();
    if n_leaving > 0 {
        note(&format!("{n_leaving} runs of the folder are not in this spec: they stay there, but not in the report"));
    }
}

/// Says something beside the output; where even stderr is closed, nobody misses it.
fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}
