//! Q-learning with a table: eq. (1), and nothing else.

use std::io::{Read, Write};

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::checkpoint::{read, same, sound, write};
use crate::error::check_len;
use crate::random::stream;
use crate::spec::check;
use crate::{Agent, Loss, Mode, RlError, StepBatch, target};

/// The hyper-parameters of tabular Q-learning.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TabularSpec {
    /// The step size, in `(0, 1]`.
    pub alpha: f64,
    /// The discount per env step, in `[0, 1]`.
    pub gamma: f64,
    /// The constant probability of a random action, in `[0, 1]`.
    pub epsilon: f64,
}

/// Tabular Q-learning (Watkins 1989; eq. 1 of Liu et al.): the oracle that a network is checked against.
///
/// An observation is one-hot, or any row whose largest entry marks the state. The table starts at zero and is updated
/// within `observe`; `update` is never due. Greedy and exploring actions use the same table.
///
/// ```
/// use headway_rl::{Agent, StepBatch, TabularSpec};
/// let mut agent = TabularSpec { alpha: 0.5, gamma: 0.9, epsilon: 0.1 }.build(2, 2, 0)?;
/// agent.observe(StepBatch {
///     obs: &[1.0, 0.0], actions: &[1], rewards: &[4.0], next_obs: &[0.0, 1.0], terminated: &[true], truncated: &[false],
/// })?;
/// assert_eq!(agent.q(0), [0.0, 2.0]);
/// # Ok::<(), headway_rl::RlError>(())
/// ```
#[derive(Debug, Clone)]
pub struct TabularQ {
    spec: TabularSpec,
    n_states: usize,
    n_actions: usize,
    /// `[n_states, n_actions]`.
    q: Vec<f64>,
    exploration_rng: ChaCha8Rng,
}

impl Default for TabularSpec {
    fn default() -> Self {
        Self { alpha: 0.1, gamma: 0.95, epsilon: 0.1 }
    }
}

impl TabularSpec {
    /// Builds the agent for `n_states` states, which is also the length of an observation.
    ///
    /// # Errors
    /// If a field or an argument is out of its range.
    pub fn build(&self, n_states: usize, n_actions: usize, seed: u64) -> Result<TabularQ, RlError> {
        check("alpha", self.alpha, self.alpha > 0.0 && self.alpha <= 1.0, "(0, 1]")?;
        check("gamma", self.gamma, (0.0..=1.0).contains(&self.gamma), "[0, 1]")?;
        check("epsilon", self.epsilon, (0.0..=1.0).contains(&self.epsilon), "[0, 1]")?;
        check("n_states", n_states, n_states >= 1, "at least 1")?;
        check("n_actions", n_actions, n_actions >= 1 && u32::try_from(n_actions).is_ok(), "1..2^32")?;
        let q = vec![0.0; n_states * n_actions];
        Ok(TabularQ { spec: *self, n_states, n_actions, q, exploration_rng: stream(seed, "exploration") })
    }
}

impl TabularQ {
    /// The values `[n_actions]` of a state's actions.
    ///
    /// # Panics
    /// If there is no such state.
    pub fn q(&self, state: usize) -> &[f64] {
        &self.q[state * self.n_actions..][..self.n_actions]
    }

    fn greedy(&self, state: usize) -> u32 {
        let q = self.q(state);
        (1..q.len()).fold(0, |best, i| if q[i] > q[best] { i } else { best }) as u32
    }
}

impl Agent for TabularQ {
    fn act(&mut self, obs: &[f32], mode: Mode, actions: &mut [u32]) -> Result<(), RlError> {
        let n = actions.len();
        check_len("obs", obs.len(), n * self.n_states, || format!("[n, n_states] = [{n}, {}]", self.n_states))?;
        for (action, obs) in actions.iter_mut().zip(obs.chunks_exact(self.n_states)) {
            *action = match mode {
                Mode::Explore if self.exploration_rng.random::<f64>() < self.spec.epsilon => {
                    self.exploration_rng.random_range(0..self.n_actions as u32)
                }
                Mode::Explore | Mode::Greedy => self.greedy(target::argmax(obs)),
            };
        }
        Ok(())
    }

    fn observe(&mut self, batch: StepBatch<'_>) -> Result<(), RlError> {
        batch.validate(batch.actions.len(), self.n_states, self.n_actions)?;
        for step in batch.rows(self.n_states) {
            let discount = if step.terminated { 0.0 } else { self.spec.gamma };
            let at = target::argmax(step.obs) * self.n_actions + step.action as usize;
            let q_next = self.q(target::argmax(step.next_obs));
            self.q[at] = target::q_learning(self.q[at], self.spec.alpha, f64::from(step.reward), discount, q_next);
        }
        Ok(())
    }

    fn update(&mut self) -> Result<Option<Loss>, RlError> {
        Ok(None)
    }

    fn save(&self, mut w: &mut dyn Write) -> Result<(), RlError> {
        write(&mut w, &("headway-rl/tabular", self.n_states, self.n_actions))?;
        write(&mut w, &(&self.q, &self.exploration_rng))
    }

    fn load(&mut self, mut r: &mut dyn Read) -> Result<(), RlError> {
        let (agent, n_states, n_actions): (String, usize, usize) = read(&mut r)?;
        same("agent", &agent.as_str(), &"headway-rl/tabular")?;
        same("n_states", &n_states, &self.n_states)?;
        same("n_actions", &n_actions, &self.n_actions)?;
        let (q, exploration_rng): (Vec<f64>, ChaCha8Rng) = read(&mut r)?;
        sound("the table", q.len() == self.q.len())?;
        (self.q, self.exploration_rng) = (q, exploration_rng);
        Ok(())
    }
}
