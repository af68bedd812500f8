//! How long a grid may take, measured on short trials of some of its runs.

use std::collections::HashSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

use headway_policy::Policy;

use crate::Error;
use crate::candidate::Candidate;
use crate::evaluate::ScenarioSet;
use crate::plan::{Plan, Run};
use crate::spec::{EvaluateWorld, PolicySpec, RunSpec};
use crate::train::Training;

/// Runs that are tried at most, spread over the grid.
const N_TRIED: usize = 6;
/// How long a training is tried.
const TRAINING: Duration = Duration::from_millis(250);
/// How long making scenarios, and driving through them, is tried in each evaluation world.
const EVALUATION: Duration = Duration::from_millis(100);
/// Copies of the environment that a trial has at most: the time of an env step hardly depends on them.
const MAX_ENVS: usize = 256;
/// Env steps before the first gradient step of a trial, at most.
const MAX_WARM_UP: u64 = 1000;
/// Control steps that an episode of a trial has at most.
const MAX_STEPS: f64 = 2000.0;

/// What the runs of a grid cost on one core, seconds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cost {
    /// The training of one run.
    pub(super) training: f64,
    /// Driving through the evaluation episodes of one run, on average.
    pub(super) driving: f64,
    /// Making the evaluation scenarios of the whole grid: runs share them.
    pub(super) scenarios: f64,
    /// Bytes that the replay of a run takes, in the cell where it takes most.
    pub(super) replay_bytes: u64,
    /// How many runs were tried.
    pub(super) n_tried: usize,
}

/// What one run was found to cost, seconds, and one of its sets of scenarios.
struct Trial {
    training: f64,
    driving: f64,
    scenarios: f64,
}

/// Tries some runs of a plan with one seed; `n_seeds` is how many each of them stands for.
///
/// # Errors
/// If a training or an evaluation fails.
pub(super) fn cost(plan: &Plan<'_>, n_seeds: impl Fn(&Run<'_>) -> u64) -> Result<Cost, Error> {
    let stride = plan.runs.len().div_ceil(N_TRIED).max(1);
    let tried = plan.runs.iter().step_by(stride);
    let trials = tried.clone().map(|run| Ok((n_seeds(run) as f64, Trial::of(run.spec, &evaluations(run))?)));
    let trials = trials.collect::<Result<Vec<_>, Error>>()?;
    let n_runs: f64 = trials.iter().map(|(n, _)| n).sum();
    let mean = |of: fn(&Trial) -> f64| trials.iter().map(|(n, trial)| n * of(trial)).sum::<f64>() / n_runs;
    // A run that cells share drives for all of them, and may be one of those tried or not.
    let episodes_of_all = mean_episodes(plan.runs.iter(), &n_seeds);
    let driving_an_episode = mean(|trial| trial.driving) / mean_episodes(tried, &n_seeds);
    Ok(Cost {
        training: mean(|trial| trial.training),
        driving: driving_an_episode * episodes_of_all,
        scenarios: mean(|trial| trial.scenarios) * n_scenario_sets(plan) as f64,
        replay_bytes: replay_bytes(plan)?,
        n_tried: trials.len(),
    })
}

/// Evaluation episodes of a run, on average.
fn mean_episodes<'a, 'p: 'a>(runs: impl Iterator<Item = &'a Run<'p>>, n_seeds: impl Fn(&Run<'p>) -> u64) -> f64 {
    let (mut n_episodes, mut n_runs) = (0.0, 0.0);
    for run in runs {
        let n = n_seeds(run) as f64;
        n_runs += n;
        n_episodes += n * run.evaluations.iter().map(|of| of.spec.evaluate.n_episodes as f64).sum::<f64>();
    }
    n_episodes / n_runs
}

/// The worlds that a run is evaluated in, each with the spec that says how.
fn evaluations<'a>(run: &Run<'a>) -> Vec<(&'a RunSpec, &'a EvaluateWorld)> {
    run.evaluations.iter().map(|evaluation| (evaluation.spec, evaluation.world)).collect()
}

/// How many sets of scenarios there are to make.
fn n_scenario_sets(plan: &Plan<'_>) -> usize {
    plan.runs.iter().flat_map(|run| &run.evaluations).map(|of| &of.scenarios).collect::<HashSet<_>>().len()
}

/// The most that the replay of a run takes in any cell, bytes.
fn replay_bytes(plan: &Plan<'_>) -> Result<u64, Error> {
    let mut most = 0;
    for spec in plan.runs.iter().map(|run| run.spec).filter(|spec| spec.policy.is_learned()) {
        let obs_dim = spec.training().build().map_err(Error::failure)?.obs_dim();
        most = most.max(spec.agent.replay_bytes(obs_dim, spec.train.n_steps));
    }
    Ok(most)
}

impl Trial {
    fn of(spec: &RunSpec, evaluations: &[(&RunSpec, &EvaluateWorld)]) -> Result<Self, Error> {
        let (seconds_per_step, candidate) = match &spec.policy {
            PolicySpec::Learned {} => train(spec).map(|(time, policy)| (time, Candidate::policy(Arc::new(policy))))?,
            PolicySpec::File { path } => (0.0, Candidate::load(path)?),
            driver => (0.0, Candidate::driver_of(driver.driver().expect("all others are classical drivers"))),
        };
        let (mut driving, mut scenarios) = (0.0, 0.0);
        for (spec, world) in evaluations {
            let (making_one, driving_one) = evaluate(spec, world, &candidate.clone().shielded(spec.shield()))?;
            let n_episodes = spec.evaluate.n_episodes as f64;
            scenarios += making_one * n_episodes;
            driving += driving_one * n_episodes;
        }
        let training = seconds_per_step * spec.train.n_steps as f64;
        Ok(Self { training, driving, scenarios: scenarios / evaluations.len() as f64 })
    }
}

/// Seconds per env step of a training without its beginning, in which it neither learns nor asks the network; and the
/// policy that it comes to.
fn train(spec: &RunSpec) -> Result<(f64, Policy), Error> {
    let mut spec = spec.clone();
    let learns = spec.agent.warm_up < spec.train.n_steps;
    spec.train.n_envs = spec.train.n_envs.min(MAX_ENVS);
    spec.agent.epsilon.start = spec.agent.epsilon.end;
    spec.agent.warm_up = if learns { spec.agent.warm_up.min(MAX_WARM_UP) } else { spec.agent.warm_up };
    spec.train.n_steps = spec.train.n_steps.max(MAX_WARM_UP * 2);
    let mut training = Training::new(&spec, 0)?;
    while learns && training.n_env_steps() < spec.agent.warm_up {
        training.step()?;
    }
    let (n_before, start) = (training.n_env_steps(), Instant::now());
    loop {
        training.step()?;
        if training.is_over() || start.elapsed() >= TRAINING {
            let n_steps = training.n_env_steps() - n_before;
            return Ok((start.elapsed().as_secs_f64() / n_steps as f64, training.policy()?));
        }
    }
}

/// Seconds to make one scenario of an evaluation world, and to drive through one.
fn evaluate(spec: &RunSpec, world: &EvaluateWorld, candidate: &Candidate) -> Result<(f64, f64), Error> {
    let mut rules = spec.evaluation(world);
    rules.env.time_limit = rules.env.time_limit.min(MAX_STEPS * rules.vehicle.control_period);
    let (mdp, mut driver) = candidate.set_up(rules)?;
    let (set, making) = scenarios(|n| ScenarioSet::new(&mdp, n, spec.evaluate.seed))?;
    let start = Instant::now();
    let mut n_driven = 0;
    while n_driven < set.len() && start.elapsed() < EVALUATION {
        set.drive(&mdp, &mut *driver, n_driven, |_| ())?;
        n_driven += 1;
    }
    Ok((making, start.elapsed().as_secs_f64() / n_driven as f64))
}

/// As many scenarios as can be made in the time there is, and the seconds per scenario.
fn scenarios(make: impl Fn(usize) -> Result<ScenarioSet, Error>) -> Result<(ScenarioSet, f64), Error> {
    let mut n = 2;
    loop {
        let start = Instant::now();
        let set = make(n)?;
        let elapsed = start.elapsed();
        if elapsed * 3 >= EVALUATION || n >= 512 {
            return Ok((set, elapsed.as_secs_f64() / n as f64));
        }
        n *= 4;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::Grid;

    fn trial(spec: &RunSpec) -> Trial {
        Trial::of(spec, &spec.evaluate.worlds.iter().map(|world| (spec, world)).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn a_training_shorter_than_its_warm_up_is_tried_too() {
        let mut spec = RunSpec::default();
        (spec.train.n_steps, spec.evaluate.n_episodes) = (32, 10);
        let Trial { training, driving, scenarios } = trial(&spec);
        for seconds in [training, driving, scenarios] {
            assert!(seconds > 0.0 && seconds < 10.0, "{training} {driving} {scenarios}");
        }
    }

    #[test]
    fn a_trial_is_short_whatever_the_spec() {
        let mut spec = RunSpec::default();
        (spec.train.n_steps, spec.train.n_envs, spec.agent.warm_up) = (1_000_000_000_000, 65_536, 100_000_000_000);
        spec.evaluate.n_episodes = 10_000_000;
        spec.evaluate.worlds.iter_mut().for_each(|world| world.time_limit = 1e9);
        let start = Instant::now();
        assert!(trial(&spec).driving > 0.0);
        assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
    }

    /// Where one of two runs drives for three cells, each drives 40 episodes on average, whichever is tried.
    #[test]
    fn episodes_are_those_of_all_runs() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("grid.toml");
        let levels =
            "a = {}, b = { \"evaluate.seed\" = 1 }, c = { \"evaluate.seed\" = 2 }, d = { \"agent.gamma\" = 0.9 }";
        let text = format!("evaluate.n_episodes = 10\n[[axis]]\nname = \"x\"\nlevels = {{ {levels} }}");
        std::fs::write(&path, text).unwrap();
        let grid = Grid::load(&path, &[]).unwrap();
        let plan = Plan::new(&grid).unwrap();
        // Two worlds.
        assert_eq!(plan.runs.iter().map(|run| run.evaluations.len()).collect::<Vec<_>>(), [6, 2]);
        assert_eq!(mean_episodes(plan.runs.iter(), |_| 1), 40.0);
        assert_eq!(mean_episodes(plan.runs[1..].iter(), |_| 5), 20.0);
    }

    #[test]
    fn runs_that_share_a_world_share_its_scenarios() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("grid.toml");
        let level = |key: &str| format!("[[axis]]\nname = \"x\"\nlevels = {{ a = {{}}, b = {{ {key} }} }}");
        let n_sets = |key: &str| {
            std::fs::write(&path, level(key)).unwrap();
            n_scenario_sets(&Plan::new(&Grid::load(&path, &[]).unwrap()).unwrap())
        };
        assert_eq!(n_sets("\"agent.gamma\" = 0.9"), 2, "one for each world");
        assert_eq!(n_sets("\"evaluate.seed\" = 1"), 4);
        assert_eq!(n_sets("\"env.reach_radius\" = 1.0"), 4);
        assert_eq!(n_sets("\"env.time_limit\" = 1.0"), 2);
    }
}
