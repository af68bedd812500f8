//! The seam between those who learn and those who run the loop.

use std::io::{Read, Write};

use crate::{RlError, StepBatch};

/// How an agent chooses: to learn, or to show what it has learned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Epsilon-greedy by the weights being learned; consumes the exploration stream.
    Explore,
    /// The best action by the averaged weights; draws nothing, changes nothing.
    Greedy,
}

/// The figures of one gradient step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    /// The mean loss of the minibatch before the step, in (scaled reward)^2.
    pub value: f32,
    /// The mean Q(s, a) of the minibatch's actions before the step, in scaled reward.
    pub mean_q: f32,
    /// The Euclidean norm of the whole gradient before clipping.
    pub grad_norm: f32,
    /// The learning rate the step was taken with.
    pub learning_rate: f32,
}

/// A learner that chooses actions for rows of observations and hears what came of them.
///
/// All arrays are row-major. The loop calls `act`, steps its environments, calls `observe`, then `update` until it
/// returns `None`. Agents own their n-step queues and replay, and never touch an environment.
pub trait Agent {
    /// Chooses one action per row: `obs` is `[n, obs_dim]`, `actions` is `[n]`, for any `n`.
    ///
    /// # Errors
    /// If the two shapes do not agree.
    fn act(&mut self, obs: &[f32], mode: Mode, actions: &mut [u32]) -> Result<(), RlError>;

    /// Takes in one step of every environment; row `i` always belongs to environment `i`.
    ///
    /// # Errors
    /// If a shape, an action, or a number is not allowed; the agent is then unchanged.
    fn observe(&mut self, batch: StepBatch<'_>) -> Result<(), RlError>;

    /// Takes one gradient step if one is due, else returns `None`.
    ///
    /// # Errors
    /// If the loss or its gradient is no longer finite.
    fn update(&mut self) -> Result<Option<Loss>, RlError>;

    /// Writes everything that changes while training, so that `load` continues as if nothing had happened.
    ///
    /// # Errors
    /// If the stream fails.
    fn save(&self, w: &mut dyn Write) -> Result<(), RlError>;

    /// Replaces the whole state by one that `save` wrote; reads not a byte further.
    ///
    /// # Errors
    /// If the stream fails, is damaged, or belongs to an agent of another shape; the agent is then unchanged.
    fn load(&mut self, r: &mut dyn Read) -> Result<(), RlError>;
}
