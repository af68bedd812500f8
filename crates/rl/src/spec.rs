//! The hyper-parameters of [`Dqn`] as plain data.

use std::fmt::Debug;

use serde::{Deserialize, Serialize};

use crate::{Dqn, Epsilon, LearningRate, LossFn, RlError, TargetRule};

/// The hyper-parameters of DQN and Double DQN: the table `[agent]` of a spec.
///
/// The defaults learn goal-directed driving among obstacles in about 50 000 env steps; `docs/dqn.md` gives the source of
/// each. Intervals say in what: an *env step* is one step of one environment, so a batch of 32 environments makes 32.
///
/// ```
/// use headway_rl::{DqnSpec, TargetRule};
/// let spec = DqnSpec { target: TargetRule::DoubleDqn, ..DqnSpec::default() };
/// let agent = spec.build(42, 12, 32, 50_000, 0)?;
/// assert_eq!(agent.epsilon(), 1.0);
///
/// let wrong = DqnSpec { gamma: 1.2, ..DqnSpec::default() };
/// let message = wrong.build(42, 12, 32, 50_000, 0).unwrap_err().to_string();
/// assert_eq!(message, "agent.gamma = 1.2: allowed is [0, 1]");
/// # Ok::<(), headway_rl::RlError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DqnSpec {
    /// The target rule: `"dqn"` or `"double_dqn"`.
    pub target: TargetRule,
    /// The widths of the hidden layers, at most 16 of them, each 1 to 65 536; none makes Q linear in the observation.
    pub hidden: Vec<usize>,
    /// The discount per env step, in `[0, 1]`.
    pub gamma: f64,
    /// The number of rewards summed before the target bootstraps; at least 1.
    pub n_step: usize,
    /// The learning rate along the training.
    pub learning_rate: LearningRate,
    /// The optimiser's constants.
    pub adam: AdamSpec,
    /// The loss of one TD error.
    pub loss: LossFn,
    /// What happens to large gradients.
    pub grad_clip: GradientClip,
    /// The number of transitions per gradient step, drawn with replacement; 1 to 1 000 000.
    pub batch_size: usize,
    /// The number of env steps per gradient step; at least 1. Half of `n_envs` makes two gradient steps due per batch.
    pub update_every: u64,
    /// The number of env steps before updates begin to become due.
    pub warm_up: u64,
    /// The number of transitions the replay holds; at least `batch_size`. Memory grows with what is stored: observations
    /// are kept once, so that a transition takes `4 obs_dim + 24` bytes, and the end of an episode `4 obs_dim + 4` more.
    pub replay_capacity: usize,
    /// How the target network follows the online network.
    pub target_network: TargetUpdate,
    /// The probability of a random action along the training.
    pub epsilon: Epsilon,
    /// The rate of the moving average of weights that greedy acting and policy files use, in `(0, 1]`; 1 is no average.
    pub average: f64,
    /// The factor on every reward before it is stored; > 0.
    pub reward_scale: f64,
}

/// The constants of Adam (Kingma and Ba 2015).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AdamSpec {
    /// The decay of the mean gradient, in `[0, 1)`.
    pub beta1: f64,
    /// The decay of the mean squared gradient, in `[0, 1)`.
    pub beta2: f64,
    /// What is added to the root of the mean square; > 0.
    pub eps: f64,
}

/// What happens to gradients before the optimiser sees them.
// The empty braces let serde reject unknown keys beside `type`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum GradientClip {
    /// Nothing.
    Off {},
    /// Scaled down to a Euclidean norm, over all weights together, of at most `max`.
    Norm {
        /// The largest norm; > 0.
        max: f64,
    },
}

/// How the target network follows the online network.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum TargetUpdate {
    /// `target <- (1 - tau) target + tau online` after every gradient step (Lillicrap et al. 2016).
    Soft {
        /// The fraction, in `(0, 1]`.
        tau: f64,
    },
    /// `target <- online` after every `every`-th gradient step (Mnih et al. 2015).
    Hard {
        /// The interval in gradient steps; at least 1.
        every: u64,
    },
}

impl Default for DqnSpec {
    fn default() -> Self {
        Self {
            target: TargetRule::Dqn,
            hidden: vec![64, 64],
            gamma: 0.95,
            n_step: 3,
            learning_rate: LearningRate { start: 0.003, end: 0.0003 },
            adam: AdamSpec::default(),
            loss: LossFn::Huber { delta: 1.0 },
            grad_clip: GradientClip::Off {},
            batch_size: 64,
            update_every: 32,
            warm_up: 500,
            replay_capacity: 200_000,
            target_network: TargetUpdate::Soft { tau: 0.01 },
            epsilon: Epsilon { start: 1.0, end: 0.02, fraction: 0.3 },
            average: 0.005,
            reward_scale: 0.01,
        }
    }
}

impl Default for AdamSpec {
    fn default() -> Self {
        Self { beta1: 0.9, beta2: 0.999, eps: 1e-8 }
    }
}

impl GradientClip {
    /// The factor that brings a gradient of this norm within the limit.
    ///
    /// ```
    /// use headway_rl::GradientClip;
    /// let clip = GradientClip::Norm { max: 2.0 };
    /// assert_eq!([clip.factor(1.0), clip.factor(2.0), clip.factor(8.0)], [1.0, 1.0, 0.25]);
    /// assert_eq!(GradientClip::Off {}.factor(8.0), 1.0);
    /// ```
    pub fn factor(self, norm: f32) -> f32 {
        match self {
            Self::Norm { max } if norm > max as f32 => max as f32 / norm,
            _ => 1.0,
        }
    }
}

impl DqnSpec {
    /// Builds the agent for `n_envs` environments with rows of `obs_dim` numbers and actions `0..n_actions`.
    ///
    /// `n_steps` is the number of env steps of the whole training, which the schedules are fractions of.
    ///
    /// # Errors
    /// If a field or an argument is out of its range.
    pub fn build(
        &self,
        obs_dim: usize,
        n_actions: usize,
        n_envs: usize,
        n_steps: u64,
        seed: u64,
    ) -> Result<Dqn, RlError> {
        self.validate()?;
        check("obs_dim", obs_dim, obs_dim >= 1, "at least 1")?;
        check("n_actions", n_actions, n_actions >= 1 && u32::try_from(n_actions).is_ok(), "1..2^32")?;
        check("n_envs", n_envs, n_envs >= 1, "at least 1")?;
        check("n_steps", n_steps, n_steps >= 1, "at least 1")?;
        Dqn::new(self, obs_dim, n_actions, n_envs, n_steps, seed)
    }

    /// The memory of the replay at the end of a training of `n_steps` env steps, bytes: for each of the last
    /// `replay_capacity` transitions 20 bytes and one observation, of `4 obs_dim + 4`.
    ///
    /// All else that an agent holds is small beside it. The end of an episode takes one observation more, so this is never
    /// exceeded by more than a factor of two, and by a few per cent where episodes are some tens of steps long.
    ///
    /// ```
    /// let spec = headway_rl::DqnSpec::default();
    /// assert_eq!(spec.replay_bytes(42, 100_000), 100_000 * (20 + 4 * 42 + 4));
    /// assert_eq!(spec.replay_bytes(42, u64::MAX), 200_000 * 192);
    /// ```
    #[must_use]
    pub fn replay_bytes(&self, obs_dim: usize, n_steps: u64) -> u64 {
        n_steps.min(self.replay_capacity as u64).saturating_mul(24 + 4 * obs_dim as u64)
    }

    /// Checks every field; `build` does so too.
    ///
    /// # Errors
    /// The first field out of its range, with its value and what is allowed.
    pub fn validate(&self) -> Result<(), RlError> {
        let widths = self.hidden.len() <= 16 && self.hidden.iter().all(|width| (1..=65_536).contains(width));
        check("hidden", &self.hidden, widths, "at most 16 widths, each 1..=65_536")?;
        check("gamma", self.gamma, (0.0..=1.0).contains(&self.gamma), "[0, 1]")?;
        check("n_step", self.n_step, (1..=1000).contains(&self.n_step), "1..=1000")?;
        check("learning_rate.start", self.learning_rate.start, positive(self.learning_rate.start), "> 0")?;
        let end = self.learning_rate.end;
        check("learning_rate.end", end, end == 0.0 || positive(end), ">= 0")?;
        self.adam.validate()?;
        self.validate_kinds()?;
        check("batch_size", self.batch_size, (1..=1_000_000).contains(&self.batch_size), "1..=1_000_000")?;
        check("update_every", self.update_every, self.update_every >= 1, "at least 1")?;
        let fits = self.replay_capacity >= self.batch_size && u32::try_from(self.replay_capacity).is_ok();
        check("replay_capacity", self.replay_capacity, fits, "batch_size..2^32")?;
        check("epsilon.start", self.epsilon.start, (0.0..=1.0).contains(&self.epsilon.start), "[0, 1]")?;
        check("epsilon.end", self.epsilon.end, (0.0..=1.0).contains(&self.epsilon.end), "[0, 1]")?;
        check("epsilon.fraction", self.epsilon.fraction, fraction(self.epsilon.fraction), "(0, 1]")?;
        check("average", self.average, fraction(self.average), "(0, 1]")?;
        check("reward_scale", self.reward_scale, positive(self.reward_scale), "> 0")
    }

    fn validate_kinds(&self) -> Result<(), RlError> {
        if let LossFn::Huber { delta } = self.loss {
            check("loss.delta", delta, positive(delta), "> 0")?;
        }
        if let GradientClip::Norm { max } = self.grad_clip {
            check("grad_clip.max", max, positive(max), "> 0")?;
        }
        match self.target_network {
            TargetUpdate::Soft { tau } => check("target_network.tau", tau, fraction(tau), "(0, 1]"),
            TargetUpdate::Hard { every } => check("target_network.every", every, every >= 1, "at least 1"),
        }
    }
}

impl AdamSpec {
    fn validate(&self) -> Result<(), RlError> {
        check("adam.beta1", self.beta1, (0.0..1.0).contains(&self.beta1), "[0, 1)")?;
        check("adam.beta2", self.beta2, (0.0..1.0).contains(&self.beta2), "[0, 1)")?;
        check("adam.eps", self.eps, positive(self.eps), "> 0")
    }
}

/// Fails with the field, its value and what is allowed, unless `ok`.
pub(crate) fn check(field: &'static str, value: impl Debug, ok: bool, allowed: &'static str) -> Result<(), RlError> {
    if ok {
        return Ok(());
    }
    Err(RlError::Spec { field, value: format!("{value:?}"), allowed })
}

/// Whether a number is finite and above zero, also once it is an `f32`.
fn positive(x: f64) -> bool {
    x as f32 > 0.0 && (x as f32).is_finite()
}

fn fraction(x: f64) -> bool {
    positive(x) && x <= 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spec_survives_toml_and_an_empty_table_is_the_default() {
        let spec =
            DqnSpec { target_network: TargetUpdate::Hard { every: 100 }, loss: LossFn::Mse {}, ..DqnSpec::default() };
        assert_eq!(toml::from_str::<DqnSpec>(&toml::to_string(&spec).unwrap()).unwrap(), spec);
        assert_eq!(toml::from_str::<DqnSpec>("").unwrap(), DqnSpec::default());
    }

    #[test]
    fn unknown_keys_are_refused_at_every_level() {
        for text in [
            "gama = 0.9",
            "adam = { beta3 = 0.1 }",
            "epsilon = { start = 1.0, end = 0.0, fraction = 0.5, shape = 1 }",
            "loss = { type = \"mse\", delta = 1.0 }",
            "grad_clip = { type = \"off\", max = 1.0 }",
            "target_network = { type = \"soft\", tau = 0.1, every = 3 }",
            "target = \"dueling\"",
        ] {
            assert!(toml::from_str::<DqnSpec>(text).is_err(), "{text}");
        }
    }

    #[test]
    fn every_field_is_checked_and_named() {
        for (text, message) in [
            ("hidden = [64, 0]", "agent.hidden = [64, 0]: allowed is at most 16 widths, each 1..=65_536"),
            ("hidden = [65537]", "agent.hidden = [65537]: allowed is at most 16 widths, each 1..=65_536"),
            (
                "hidden = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1]",
                "agent.hidden = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1]: allowed is at most 16 widths, each \
                 1..=65_536",
            ),
            ("gamma = -0.1", "agent.gamma = -0.1: allowed is [0, 1]"),
            ("n_step = 0", "agent.n_step = 0: allowed is 1..=1000"),
            ("learning_rate = { start = 0.0, end = 0.0 }", "agent.learning_rate.start = 0.0: allowed is > 0"),
            ("learning_rate = { start = 0.1, end = -1.0 }", "agent.learning_rate.end = -1.0: allowed is >= 0"),
            ("adam = { beta1 = 1.0 }", "agent.adam.beta1 = 1.0: allowed is [0, 1)"),
            ("adam = { beta2 = 1.5 }", "agent.adam.beta2 = 1.5: allowed is [0, 1)"),
            ("adam = { eps = 0.0 }", "agent.adam.eps = 0.0: allowed is > 0"),
            ("loss = { type = \"huber\", delta = 0.0 }", "agent.loss.delta = 0.0: allowed is > 0"),
            ("grad_clip = { type = \"norm\", max = inf }", "agent.grad_clip.max = inf: allowed is > 0"),
            ("batch_size = 0", "agent.batch_size = 0: allowed is 1..=1_000_000"),
            ("batch_size = 1_000_001", "agent.batch_size = 1000001: allowed is 1..=1_000_000"),
            ("update_every = 0", "agent.update_every = 0: allowed is at least 1"),
            ("replay_capacity = 63", "agent.replay_capacity = 63: allowed is batch_size..2^32"),
            ("target_network = { type = \"soft\", tau = 0.0 }", "agent.target_network.tau = 0.0: allowed is (0, 1]"),
            (
                "target_network = { type = \"hard\", every = 0 }",
                "agent.target_network.every = 0: allowed is at least 1",
            ),
            ("epsilon = { start = 2.0, end = 0.0, fraction = 0.5 }", "agent.epsilon.start = 2.0: allowed is [0, 1]"),
            ("epsilon = { start = 1.0, end = nan, fraction = 0.5 }", "agent.epsilon.end = NaN: allowed is [0, 1]"),
            ("epsilon = { start = 1.0, end = 0.0, fraction = 0.0 }", "agent.epsilon.fraction = 0.0: allowed is (0, 1]"),
            ("average = 0.0", "agent.average = 0.0: allowed is (0, 1]"),
            ("reward_scale = nan", "agent.reward_scale = NaN: allowed is > 0"),
        ] {
            let spec: DqnSpec = toml::from_str(text).unwrap();
            assert_eq!(spec.validate().unwrap_err().to_string(), message);
        }
        let spec = DqnSpec::default();
        assert_eq!(spec.build(0, 1, 1, 1, 0).unwrap_err().to_string(), "agent.obs_dim = 0: allowed is at least 1");
        assert!(
            spec.build(1, 0, 1, 1, 0).is_err()
                && spec.build(1, 1, 0, 1, 0).is_err()
                && spec.build(1, 1, 1, 0, 0).is_err()
        );
    }
}
