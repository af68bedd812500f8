//! One row of the training metrics.

use serde::{Deserialize, Serialize};

/// A row of a run's training metrics: what happened since the row before. Means over nothing are empty, and so is what the version
/// that wrote the row did not measure.
///
/// Rewards are as the reward pays them, values and losses are scaled by `agent.reward_scale`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MetricsRow {
    /// Env steps since the start, over all copies of the environment.
    pub env_steps: u64,
    /// Gradient steps since the start.
    pub gradient_steps: u64,
    /// Mean reward of a step, unscaled.
    pub reward_mean: f64,
    /// Goals reached, exploration included.
    pub n_reached: u64,
    /// Collisions, exploration included.
    pub n_collisions: u64,
    /// Episodes cut by the time limit.
    pub n_timeouts: u64,
    /// Mean loss of the gradient steps, in squared scaled rewards.
    pub loss: Option<f64>,
    /// Mean value of the actions learned from, in scaled rewards.
    pub mean_q: Option<f64>,
    /// Mean norm of the gradient before clipping.
    pub grad_norm: Option<f64>,
    /// Probability of a random action at the end of the interval.
    pub epsilon: f64,
    /// Learning rate at the end of the interval.
    pub learning_rate: f64,
    /// Mean sum of an episode's rewards, unscaled and not discounted, over the episodes that ended.
    #[serde(default)]
    pub return_mean: Option<f64>,
    /// Share of goals that were reached, in \[0, 1\]: of all that ended in reaching, collision or time limit.
    #[serde(default)]
    pub arrived: Option<f64>,
    /// Share of goals that the time limit cut off, in \[0, 1\].
    #[serde(default)]
    pub timed_out: Option<f64>,
    /// Mean speed of approach to the goal, m/s; negative where it went away.
    #[serde(default)]
    pub progress: Option<f64>,
    /// Mean of the absolute value of that speed, m/s: well above [`progress`](Self::progress) where vehicles go to and fro.
    #[serde(default)]
    pub abs_progress: Option<f64>,
    /// Share of time spent spinning, in \[0, 1\]: a full turn or more within [`SPIN_WINDOW`](super::SPIN_WINDOW) without getting away.
    #[serde(default)]
    pub spinning: Option<f64>,
    /// Entropy of the greedy actions on observations of the interval, in \[0, 1\]: see [`headway_rl::Probe`].
    #[serde(default)]
    pub action_entropy: Option<f64>,
    /// Of each hidden layer the share of units that none of these observations opens, in \[0, 1\]; in files divided by blanks.
    #[serde(default, with = "blank_separated")]
    pub dead_units: Vec<f64>,
    /// Greatest `|Q|` of these observations and any action, in scaled rewards.
    #[serde(default)]
    pub max_abs_q: Option<f64>,
    /// Greatest return that the rewards seen since the start can give, in scaled rewards: `max |r| / (1 - gamma)`; none if
    /// there is no bound.
    #[serde(default)]
    pub q_bound: Option<f64>,
}

impl MetricsRow {
    /// Every number that the row has, by its name; hidden layers count from 1, as in `dead_units/1`.
    ///
    /// What is plotted over env steps: the env steps themselves are not among them.
    pub fn scalars(&self) -> Vec<(String, f64)> {
        let count = |n: u64| Some(n as f64);
        let named = [
            ("gradient_steps", count(self.gradient_steps)),
            ("reward_mean", Some(self.reward_mean)),
            ("n_reached", count(self.n_reached)),
            ("n_collisions", count(self.n_collisions)),
            ("n_timeouts", count(self.n_timeouts)),
            ("loss", self.loss),
            ("mean_q", self.mean_q),
            ("grad_norm", self.grad_norm),
            ("epsilon", Some(self.epsilon)),
            ("learning_rate", Some(self.learning_rate)),
            ("return_mean", self.return_mean),
            ("arrived", self.arrived),
            ("timed_out", self.timed_out),
            ("progress", self.progress),
            ("abs_progress", self.abs_progress),
            ("spinning", self.spinning),
            ("action_entropy", self.action_entropy),
            ("max_abs_q", self.max_abs_q),
            ("q_bound", self.q_bound),
        ];
        let named = named.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?)));
        let dead_units = (1..).zip(&self.dead_units).map(|(layer, share)| (format!("dead_units/{layer}"), *share));
        named.chain(dead_units).collect()
    }
}

/// Numbers in one field of a CSV file.
mod blank_separated {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(numbers: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
        let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
        serializer.serialize_str(&numbers.join(" "))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.split_whitespace().map(str::parse).collect::<Result<_, _>>().map_err(D::Error::custom)
    }
}
