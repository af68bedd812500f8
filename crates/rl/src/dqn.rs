//! DQN and Double DQN: acting, remembering, and when to learn.

use std::io::{Read, Write};

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::error::check_len;
use crate::learner::{Learner, Weights};
use crate::n_step::NStepQueues;
use crate::network::Layer;
use crate::observations::Observations;
use crate::random::stream;
use crate::replay::{MiniBatch, Replay};
use crate::target::argmax;
use crate::{Agent, DqnSpec, Epsilon, LearningRate, Loss, Mode, Probe, RlError, StepBatch, checkpoint};

/// A deep Q-learning agent; the target rule of its spec makes it DQN or Double DQN.
///
/// Build it with [`DqnSpec::build`]. Steps flow from [`Agent::observe`] through one n-step queue per environment into
/// the replay; [`Agent::update`] draws minibatches from there. The same state, inputs and spec give the same bytes.
#[derive(Debug)]
pub struct Dqn {
    learning_rate: LearningRate,
    epsilon: Epsilon,
    batch_size: usize,
    update_every: u64,
    warm_up: u64,
    reward_scale: f32,
    /// The env steps of the whole training.
    n_steps: u64,
    pub(crate) n_envs: usize,
    pub(crate) n_env_steps: u64,
    pub(crate) learner: Learner,
    pub(crate) observations: Observations,
    pub(crate) queues: NStepQueues,
    pub(crate) replay: Replay,
    /// The minibatch of the latest gradient step, kept for its memory.
    batch: MiniBatch,
    pub(crate) exploration_rng: ChaCha8Rng,
    pub(crate) replay_rng: ChaCha8Rng,
}

impl Dqn {
    /// An agent from a valid spec and valid sizes.
    pub(crate) fn new(
        spec: &DqnSpec,
        obs_dim: usize,
        n_actions: usize,
        n_envs: usize,
        n_steps: u64,
        seed: u64,
    ) -> Result<Self, RlError> {
        Ok(Self {
            learning_rate: spec.learning_rate,
            epsilon: spec.epsilon,
            batch_size: spec.batch_size,
            update_every: spec.update_every,
            warm_up: spec.warm_up,
            reward_scale: spec.reward_scale as f32,
            n_steps,
            n_envs,
            n_env_steps: 0,
            learner: Learner::new(spec, obs_dim, n_actions, &mut stream(seed, "weights"))?,
            observations: Observations::new(obs_dim),
            queues: NStepQueues::new(n_envs, spec.n_step, spec.gamma as f32),
            replay: Replay::new(spec.replay_capacity),
            batch: MiniBatch::default(),
            exploration_rng: stream(seed, "exploration"),
            replay_rng: stream(seed, "replay"),
        })
    }

    /// The number of env steps observed.
    pub fn n_env_steps(&self) -> u64 {
        self.n_env_steps
    }

    /// The number of gradient steps taken.
    pub fn n_gradient_steps(&self) -> u64 {
        self.learner.n_gradient_steps()
    }

    /// The number of transitions in the replay.
    pub fn replay_len(&self) -> usize {
        self.replay.len()
    }

    /// The probability with which the next exploring action is random.
    pub fn epsilon(&self) -> f64 {
        self.epsilon.at(self.progress())
    }

    /// The learning rate of the next gradient step.
    pub fn learning_rate(&self) -> f64 {
        self.learning_rate.at(self.progress())
    }

    /// The Q-values `[n, n_actions]` of observations `[n, obs_dim]` by the averaged weights, in scaled reward.
    ///
    /// # Errors
    /// If `obs` is not a whole number of rows.
    pub fn q_values(&self, obs: &[f32]) -> Result<Vec<f32>, RlError> {
        self.check_rows(obs, obs.len() / self.learner.network.obs_dim())?;
        Ok(self.learner.q_values(Weights::Averaged, obs, <[f32]>::to_vec)?)
    }

    /// What the averaged weights do with observations `[n, obs_dim]`; none if there are none.
    ///
    /// # Errors
    /// If `obs` is not a whole number of rows.
    ///
    /// ```
    /// let agent = headway_rl::DqnSpec::default().build(2, 12, 1, 1, 0)?;
    /// let probe = agent.probe(&[0.5, -0.5])?.unwrap();
    /// assert_eq!((probe.action_entropy, probe.dead_units.len()), (0.0, 2)); // one observation, one action
    /// # Ok::<(), headway_rl::RlError>(())
    /// ```
    pub fn probe(&self, obs: &[f32]) -> Result<Option<Probe>, RlError> {
        self.check_rows(obs, obs.len() / self.learner.network.obs_dim())?;
        if obs.is_empty() {
            return Ok(None);
        }
        let probe = |activations: &[f32], n| Probe::of(&self.learner.network, activations, n);
        Ok(Some(self.learner.activations(Weights::Averaged, obs, probe)?))
    }

    /// The averaged weights, layer by layer: what greedy acting uses and a policy file holds.
    ///
    /// # Errors
    /// If the tensor library fails.
    ///
    /// ```
    /// let agent = headway_rl::DqnSpec::default().build(42, 12, 1, 1, 0)?;
    /// let sizes: Vec<_> = agent.layers()?.iter().map(|l| (l.weight.len(), l.bias.len())).collect();
    /// assert_eq!(sizes, [(42 * 64, 64), (64 * 64, 64), (64 * 12, 12)]);
    /// # Ok::<(), headway_rl::RlError>(())
    /// ```
    pub fn layers(&self) -> Result<Vec<Layer>, RlError> {
        Ok(self.learner.layers()?)
    }

    /// Puts given weights, such as another agent's [`Self::layers`], into the online, target and averaged networks.
    ///
    /// The optimiser's moments are forgotten; counters, replay and random streams stay.
    ///
    /// # Errors
    /// If the layers have another shape.
    pub fn start_from(&mut self, layers: &[Layer]) -> Result<(), RlError> {
        let widths = &self.learner.network.widths;
        check_len("layers", layers.len(), widths.len() - 1, || format!("widths {widths:?}"))?;
        for (layer, pair) in layers.iter().zip(widths.windows(2)) {
            check_len("weight", layer.weight.len(), pair[0] * pair[1], || format!("[{}, {}]", pair[1], pair[0]))?;
            check_len("bias", layer.bias.len(), pair[1], || format!("[{}]", pair[1]))?;
        }
        Ok(self.learner.start_from(layers)?)
    }

    /// The share of the training's env steps that lies behind; more than 1 beyond its end.
    fn progress(&self) -> f64 {
        self.n_env_steps as f64 / self.n_steps as f64
    }

    /// Whether the env steps since the warm-up have earned another gradient step.
    fn is_update_due(&self) -> bool {
        let n_earned = self.n_env_steps.saturating_sub(self.warm_up) / self.update_every;
        self.n_gradient_steps() < n_earned && self.replay.len() > 0
    }

    fn check_rows(&self, obs: &[f32], n: usize) -> Result<(), RlError> {
        let obs_dim = self.learner.network.obs_dim();
        check_len("obs", obs.len(), n * obs_dim, || format!("[n, obs_dim] = [{n}, {obs_dim}]"))
    }

    fn act_greedily(&self, weights: Weights, obs: &[f32], actions: &mut [u32]) -> Result<(), RlError> {
        let n_actions = self.learner.network.n_actions();
        Ok(self.learner.q_values(weights, obs, |q| {
            for (action, q) in actions.iter_mut().zip(q.chunks_exact(n_actions)) {
                *action = argmax(q) as u32;
            }
        })?)
    }

    /// Epsilon-greedy: replaces each greedy action by a uniform one with probability epsilon.
    fn explore(&mut self, obs: &[f32], actions: &mut [u32]) -> Result<(), RlError> {
        self.act_greedily(Weights::Online, obs, actions)?;
        let epsilon = self.epsilon();
        let n_actions = self.learner.network.n_actions() as u32;
        for action in actions {
            if self.exploration_rng.random::<f64>() < epsilon {
                *action = self.exploration_rng.random_range(0..n_actions);
            }
        }
        Ok(())
    }
}

impl Agent for Dqn {
    fn act(&mut self, obs: &[f32], mode: Mode, actions: &mut [u32]) -> Result<(), RlError> {
        self.check_rows(obs, actions.len())?;
        match mode {
            Mode::Explore => self.explore(obs, actions),
            Mode::Greedy => self.act_greedily(Weights::Averaged, obs, actions),
        }
    }

    fn observe(&mut self, batch: StepBatch<'_>) -> Result<(), RlError> {
        batch.validate(self.n_envs, self.learner.network.obs_dim(), self.learner.network.n_actions())?;
        for (env, mut step) in batch.rows(self.learner.network.obs_dim()).enumerate() {
            step.reward *= self.reward_scale;
            self.queues.push(env, &step, &mut self.observations, |observations, transition| {
                self.replay.push(observations, transition);
            });
        }
        self.n_env_steps += self.n_envs as u64;
        Ok(())
    }

    /// A gradient step is due for every `update_every` env steps after `warm_up`, as soon as the replay holds anything.
    fn update(&mut self) -> Result<Option<Loss>, RlError> {
        if !self.is_update_due() {
            return Ok(None);
        }
        self.replay.sample(&self.observations, self.batch_size, &mut self.replay_rng, &mut self.batch);
        let learning_rate = self.learning_rate();
        self.learner.step(&self.batch, learning_rate).map(Some)
    }

    fn save(&self, w: &mut dyn Write) -> Result<(), RlError> {
        checkpoint::save(self, w)
    }

    fn load(&mut self, r: &mut dyn Read) -> Result<(), RlError> {
        checkpoint::load(self, r)
    }
}
