//! One step of every environment, as the agent hears of it.

use crate::{RlError, error::check_len};

/// One step of `n` environments in lock-step, row-major.
#[derive(Debug, Clone, Copy)]
pub struct StepBatch<'a> {
    /// What was seen before the step: `[n, obs_dim]`.
    pub obs: &'a [f32],
    /// What was done: `[n]`.
    pub actions: &'a [u32],
    /// What was paid: `[n]`, unscaled.
    pub rewards: &'a [f32],
    /// What the step led to, before any reset: `[n, obs_dim]`.
    pub next_obs: &'a [f32],
    /// Whether the episode ended in a state of value zero: `[n]`.
    pub terminated: &'a [bool],
    /// Whether the episode was cut off, by a time limit say, in a state that still has a value: `[n]`. Where both flags
    /// are set, `terminated` wins.
    pub truncated: &'a [bool],
}

/// One row of a [`StepBatch`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step<'a> {
    pub(crate) obs: &'a [f32],
    pub(crate) action: u32,
    pub(crate) reward: f32,
    pub(crate) next_obs: &'a [f32],
    pub(crate) terminated: bool,
    pub(crate) truncated: bool,
}

impl<'a> StepBatch<'a> {
    /// Checks shapes, actions, and that every number is finite.
    ///
    /// # Errors
    /// The first array that does not fit, with its size or the row at fault.
    ///
    /// ```
    /// use headway_rl::StepBatch;
    /// let batch = StepBatch {
    ///     obs: &[0.0, 1.0], actions: &[4], rewards: &[0.0], next_obs: &[1.0, 0.0], terminated: &[false], truncated: &[false],
    /// };
    /// assert!(batch.validate(1, 2, 5).is_ok());
    /// assert_eq!(batch.validate(1, 2, 4).unwrap_err().to_string(), "actions[0] = 4: allowed is 0..4");
    /// assert_eq!(
    ///     batch.validate(2, 2, 5).unwrap_err().to_string(),
    ///     "obs has 2 elements, expected 4 ([n_envs, obs_dim] = [2, 2])"
    /// );
    /// ```
    pub fn validate(&self, n_envs: usize, obs_dim: usize, n_actions: usize) -> Result<(), RlError> {
        let rows = || format!("[n_envs] = [{n_envs}]");
        let table = || format!("[n_envs, obs_dim] = [{n_envs}, {obs_dim}]");
        check_len("obs", self.obs.len(), n_envs * obs_dim, table)?;
        check_len("actions", self.actions.len(), n_envs, rows)?;
        check_len("rewards", self.rewards.len(), n_envs, rows)?;
        check_len("next_obs", self.next_obs.len(), n_envs * obs_dim, table)?;
        check_len("terminated", self.terminated.len(), n_envs, rows)?;
        check_len("truncated", self.truncated.len(), n_envs, rows)?;
        check_actions(self.actions, n_actions)?;
        check_finite("obs", self.obs, obs_dim)?;
        check_finite("rewards", self.rewards, 1)?;
        check_finite("next_obs", self.next_obs, obs_dim)
    }

    /// The rows, environment by environment; the batch must be valid.
    pub(crate) fn rows(self, obs_dim: usize) -> impl Iterator<Item = Step<'a>> {
        (0..self.actions.len()).map(move |i| {
            let row = i * obs_dim..(i + 1) * obs_dim;
            Step {
                obs: &self.obs[row.clone()],
                action: self.actions[i],
                reward: self.rewards[i],
                next_obs: &self.next_obs[row],
                terminated: self.terminated[i],
                truncated: self.truncated[i],
            }
        })
    }
}

fn check_actions(actions: &[u32], n_actions: usize) -> Result<(), RlError> {
    match actions.iter().position(|&action| action as usize >= n_actions) {
        None => Ok(()),
        Some(row) => Err(RlError::Action { row, action: actions[row], n_actions }),
    }
}

fn check_finite(what: &'static str, values: &[f32], n_columns: usize) -> Result<(), RlError> {
    // Without an early exit the compiler checks many numbers at once.
    if values.iter().fold(true, |finite, value| finite & value.is_finite()) {
        return Ok(());
    }
    let at = values.iter().position(|value| !value.is_finite()).expect("found above");
    Err(RlError::NotFinite { what, row: at / n_columns, column: at % n_columns, value: values[at] })
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALID: StepBatch<'static> = StepBatch {
        obs: &[0.0; 6],
        actions: &[0, 1],
        rewards: &[0.0; 2],
        next_obs: &[0.0; 6],
        terminated: &[false; 2],
        truncated: &[false; 2],
    };

    fn message(batch: StepBatch<'_>) -> String {
        batch.validate(2, 3, 2).unwrap_err().to_string()
    }

    #[test]
    fn each_array_is_named_when_its_size_is_wrong() {
        VALID.validate(2, 3, 2).unwrap();
        let short = &[false];
        for (name, batch) in [
            ("obs", StepBatch { obs: &[0.0; 5], ..VALID }),
            ("actions", StepBatch { actions: &[0; 3], ..VALID }),
            ("rewards", StepBatch { rewards: &[0.0; 3], ..VALID }),
            ("next_obs", StepBatch { next_obs: &[0.0; 7], ..VALID }),
            ("terminated", StepBatch { terminated: short, ..VALID }),
            ("truncated", StepBatch { truncated: short, ..VALID }),
        ] {
            let message = message(batch);
            assert!(message.starts_with(&format!("{name} has ")), "{message}");
        }
    }

    #[test]
    fn numbers_that_are_not_finite_are_found() {
        let obs = [0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0];
        assert_eq!(message(StepBatch { obs: &obs, ..VALID }), "obs[1][1] = NaN: allowed is any finite number");
        assert_eq!(
            message(StepBatch { next_obs: &obs, ..VALID }),
            "next_obs[1][1] = NaN: allowed is any finite number"
        );
        let rewards = [0.0, f32::INFINITY];
        assert_eq!(
            message(StepBatch { rewards: &rewards, ..VALID }),
            "rewards[1][0] = inf: allowed is any finite number"
        );
    }
}
