//! The seam between environments and those who learn in them.

use std::io::{Read, Write};

use headway_reward::Event;

use crate::EnvError;
use crate::error::check_len;

/// `n` copies of one Markov decision process in lock-step, row-major.
///
/// A copy whose episode ends is reset at once: its row of `obs` then belongs to the next episode, its row
/// of `next_obs` to the one that ended.
pub trait Env {
    /// How many copies.
    fn n_envs(&self) -> usize;

    /// Numbers in an observation.
    fn obs_dim(&self) -> usize;

    /// Actions to choose from, numbered from 0.
    fn n_actions(&self) -> usize;

    /// Starts every copy anew and writes their observations, shape `[n_envs, obs_dim]`. Equal seeds give
    /// equal episodes.
    ///
    /// # Errors
    /// If a start could not be made.
    fn reset(&mut self, seed: u64, obs: &mut [f32]) -> Result<(), EnvError>;

    /// Takes an action in every copy.
    ///
    /// # Errors
    /// If an action does not exist, or a next episode could not be started.
    fn step(&mut self, actions: &[u32], out: &mut Step) -> Result<(), EnvError>;

    /// Writes all that changes while stepping.
    ///
    /// # Errors
    /// If the stream cannot be written to.
    fn save(&self, to: &mut dyn Write) -> Result<(), EnvError>;

    /// Reads what [`Env::save`] wrote, after which the environment goes on as the saved one would.
    ///
    /// # Errors
    /// If the stream cannot be read or belongs to an environment of another size.
    fn load(&mut self, from: &mut dyn Read) -> Result<(), EnvError>;
}

/// What one step of `n` environments gave; reused from step to step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Step {
    /// Observations after the step, before any reset: `[n_envs, obs_dim]`.
    pub next_obs: Vec<f32>,
    /// Rewards, `[n_envs]`.
    pub rewards: Vec<f32>,
    /// Whether the process ended (collision, goal): no value lies beyond. `[n_envs]`.
    pub terminated: Vec<bool>,
    /// Whether the time limit cut the episode: the process would have gone on. Never with `terminated`.
    /// `[n_envs]`.
    pub truncated: Vec<bool>,
    /// What happened, if anything; under a new goal for every one reached, `Reach` comes without
    /// `terminated`. `[n_envs]`.
    pub events: Vec<Option<Event>>,
    /// Observations to act on next, after any reset: `[n_envs, obs_dim]`.
    pub obs: Vec<f32>,
}

impl Step {
    /// Room for a step of `n_envs` environments.
    #[must_use]
    pub fn new(n_envs: usize, obs_dim: usize) -> Self {
        Self {
            next_obs: vec![0.0; n_envs * obs_dim],
            rewards: vec![0.0; n_envs],
            terminated: vec![false; n_envs],
            truncated: vec![false; n_envs],
            events: vec![None; n_envs],
            obs: vec![0.0; n_envs * obs_dim],
        }
    }

    /// Refuses a step made for environments of another number or size.
    pub(crate) fn check(&self, n_envs: usize, obs_dim: usize) -> Result<(), EnvError> {
        check_len("out.next_obs", self.next_obs.len(), n_envs * obs_dim)?;
        check_len("out.rewards", self.rewards.len(), n_envs)?;
        check_len("out.terminated", self.terminated.len(), n_envs)?;
        check_len("out.truncated", self.truncated.len(), n_envs)?;
        check_len("out.events", self.events.len(), n_envs)?;
        check_len("out.obs", self.obs.len(), n_envs * obs_dim)
    }
}
