//! The training loop: the only place where an environment and an agent meet.

mod behaviour;
mod interval;
mod metrics;
mod sample;

pub use behaviour::SPIN_WINDOW;
pub use metrics::MetricsRow;

use std::collections::BTreeMap;

use headway_env::{Env, NavEnv, Step};
use headway_policy::{Header, Layer, Normalisation, Policy};
use headway_rl::{Agent, Dqn, Mode, StepBatch};
use headway_sim::stream_seed;

use behaviour::Behaviour;
use interval::Interval;
use sample::ObsSample;

use crate::Error;
use crate::plan::train_id;
use crate::spec::RunSpec;
use crate::store::CODE_REVISION;

/// Under which key a policy's provenance holds the seed of its run.
pub const PROVENANCE_SEED: &str = "seed";
/// Under which key a policy's provenance holds the id of its run.
pub const PROVENANCE_TRAIN_ID: &str = "train_id";

/// A training run, from its first step to its policy.
///
/// Environment and agent draw from random streams of their own, all derived from the run's seed; equal specs and seeds
/// give equal policies, byte for byte.
///
/// ```
/// use headway_experiments::spec::RunSpec;
/// use headway_experiments::train::Training;
///
/// let mut spec = RunSpec::default();
/// spec.train.n_steps = 640;
/// let mut training = Training::new(&spec, 0)?;
/// while !training.is_over() {
///     training.step()?;
/// }
/// assert_eq!(training.policy()?.header().vehicle, spec.vehicle);
/// # Ok::<(), headway_experiments::Error>(())
/// ```
#[derive(Debug)]
pub struct Training<'a> {
    spec: &'a RunSpec,
    seed: u64,
    env: NavEnv,
    agent: Dqn,
    n_env_steps: u64,
    /// How many stages of the curriculum are over.
    stage: usize,
    /// The observations to act on, `[n_envs, obs_dim]`.
    obs: Vec<f32>,
    actions: Vec<u32>,
    step: Step,
    interval: Interval,
    behaviour: Behaviour,
    /// Observations of the interval, for a look at what the policy does with them.
    sample: ObsSample,
    /// The greatest absolute reward since the start, unscaled.
    max_abs_reward: f64,
}

impl<'a> Training<'a> {
    /// A run before its first step.
    ///
    /// # Errors
    /// If the spec is not allowed.
    pub fn new(spec: &'a RunSpec, seed: u64) -> Result<Self, Error> {
        let n_envs = spec.train.n_envs;
        let mut rules = spec.training();
        if let Some(first) = spec.train.curriculum.first() {
            rules.world = first.world.clone();
        }
        let mut env = NavEnv::new(rules.build().map_err(Error::failure)?, n_envs);
        let (obs_dim, n_actions) = (env.obs_dim(), env.n_actions());
        let agent_seed = stream_seed(seed, "agent", 0);
        let agent = spec.agent.build(obs_dim, n_actions, n_envs, spec.train.n_steps, agent_seed);
        let mut obs = vec![0.0; n_envs * obs_dim];
        env.reset(stream_seed(seed, "train", 0), &mut obs).map_err(Error::failure)?;
        Ok(Self {
            spec,
            seed,
            agent: agent.map_err(Error::failure)?,
            n_env_steps: 0,
            stage: 0,
            obs,
            actions: vec![0; n_envs],
            step: Step::new(n_envs, obs_dim),
            interval: Interval::default(),
            behaviour: Behaviour::new(env.navigators(), spec.vehicle.control_period),
            sample: ObsSample::new(n_envs, obs_dim, spec.train.log_every),
            max_abs_reward: 0.0,
            env,
        })
    }

    /// Env steps made, over all copies of the environment.
    #[must_use]
    pub fn n_env_steps(&self) -> u64 {
        self.n_env_steps
    }

    /// Whether all of the spec's env steps are made.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.n_env_steps >= self.spec.train.n_steps
    }

    /// One step of every copy of the environment, and the gradient steps that are due after it.
    ///
    /// # Errors
    /// If the environment or the agent fails.
    pub fn step(&mut self) -> Result<(), Error> {
        self.agent.act(&self.obs, Mode::Explore, &mut self.actions).map_err(Error::failure)?;
        self.follow_curriculum()?;
        self.env.step(&self.actions, &mut self.step).map_err(Error::failure)?;
        let step = &self.step;
        let batch = StepBatch {
            obs: &self.obs,
            actions: &self.actions,
            rewards: &step.rewards,
            next_obs: &step.next_obs,
            terminated: &step.terminated,
            truncated: &step.truncated,
        };
        self.agent.observe(batch).map_err(Error::failure)?;
        self.interval.count(step);
        self.behaviour.count(self.env.navigators(), step);
        self.sample.offer(&self.obs);
        self.max_abs_reward = step.rewards.iter().fold(self.max_abs_reward, |max, r| max.max(f64::from(r.abs())));
        self.n_env_steps += step.rewards.len() as u64;
        while let Some(loss) = self.agent.update().map_err(Error::failure)? {
            self.interval.count_update(&loss);
        }
        std::mem::swap(&mut self.obs, &mut self.step.obs);
        Ok(())
    }

    /// Goes on to the next world when a stage is over.
    fn follow_curriculum(&mut self) -> Result<(), Error> {
        let stages = &self.spec.train.curriculum;
        let progress = self.n_env_steps as f64 / self.spec.train.n_steps as f64;
        while stages.get(self.stage).is_some_and(|stage| progress >= stage.until) {
            self.stage += 1;
            let world = stages.get(self.stage).map_or(&self.spec.world, |stage| &stage.world);
            self.env.set_world(world).map_err(Error::failure)?;
        }
        Ok(())
    }

    /// The metrics since the last call, if an interval of the spec's length, or the training, is over.
    ///
    /// # Errors
    /// If the agent fails.
    pub fn metrics(&mut self) -> Result<Option<MetricsRow>, Error> {
        let is_due = self.interval.n_env_steps >= self.spec.train.log_every || self.is_over();
        if !is_due || self.interval.n_env_steps == 0 {
            return Ok(None);
        }
        let interval = std::mem::take(&mut self.interval);
        let behaviour = self.behaviour.take();
        let probe = self.agent.probe(self.sample.rows()).map_err(Error::failure)?;
        self.sample.clear();
        let [loss, mean_q, grad_norm] = interval.update_means();
        let agent = &self.spec.agent;
        Ok(Some(MetricsRow {
            env_steps: self.n_env_steps,
            gradient_steps: self.agent.n_gradient_steps(),
            reward_mean: interval.rewards / interval.n_env_steps as f64,
            n_reached: interval.n_reached,
            n_collisions: interval.n_collisions,
            n_timeouts: interval.n_timeouts,
            loss,
            mean_q,
            grad_norm,
            epsilon: self.agent.epsilon(),
            learning_rate: self.agent.learning_rate(),
            return_mean: behaviour.return_mean,
            arrived: interval.share_of_ends(interval.n_reached),
            timed_out: interval.share_of_ends(interval.n_timeouts),
            progress: behaviour.progress,
            abs_progress: behaviour.abs_progress,
            spinning: behaviour.spinning,
            action_entropy: probe.as_ref().map(|probe| probe.action_entropy),
            max_abs_q: probe.as_ref().map(|probe| probe.max_abs_q.into()),
            dead_units: probe.map_or_else(Vec::new, |probe| probe.dead_units),
            q_bound: Some(self.max_abs_reward * agent.reward_scale / (1.0 - agent.gamma))
                .filter(|bound| bound.is_finite()),
        }))
    }

    /// The greedy policy learned so far: the averaged weights, with all that driving by them needs, and, under
    /// [`PROVENANCE_TRAIN_ID`] and [`PROVENANCE_SEED`], the run that it comes from.
    ///
    /// # Errors
    /// If the weights are no longer finite.
    pub fn policy(&self) -> Result<Policy, Error> {
        let train_id = train_id(self.spec, self.seed)?;
        let header = Header {
            vehicle: self.spec.vehicle.clone(),
            lidar: self.spec.lidar.clone(),
            control: self.spec.env.control,
            actions: self.spec.env.actions.clone(),
            observation: self.spec.env.observation.clone(),
            route: self.spec.env.route.clone(),
            normalisation: Normalisation::default(),
            provenance: BTreeMap::from([
                ("code_revision".to_owned(), CODE_REVISION.to_owned()),
                ("env_steps".to_owned(), self.n_env_steps.to_string()),
                (PROVENANCE_SEED.to_owned(), self.seed.to_string()),
                (PROVENANCE_TRAIN_ID.to_owned(), train_id.to_string()),
            ]),
        };
        let layers = self.agent.layers().map_err(Error::failure)?;
        let layers = layers.into_iter().map(|layer| Layer { weight: layer.weight, bias: layer.bias });
        Policy::new(header, layers.collect()).map_err(Error::failure)
    }
}
