//! A part of a batch of environments.

use headway_reward::Event;

use crate::{EnvError, Navigator, Step, StepEnd};

/// Neighbouring environments and their rows of a [`Step`]: what one thread steps at a time.
pub(crate) struct Shard<'a> {
    /// The number of the first environment.
    first: usize,
    navigators: &'a mut [Navigator],
    scenarios: &'a mut [u64],
    next_obs: &'a mut [f32],
    rewards: &'a mut [f32],
    terminated: &'a mut [bool],
    truncated: &'a mut [bool],
    events: &'a mut [Option<Event>],
    obs: &'a mut [f32],
}

/// Where new episodes come from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Episodes {
    pub(crate) seed: u64,
    /// How many scenarios an environment's next one lies ahead.
    pub(crate) stride: u64,
}

impl<'a> Shard<'a> {
    /// Environments that are stepped as a whole: some forty microseconds of work. To wake a thread takes about ten.
    pub(crate) const GRAIN: usize = 64;

    /// All environments of a step that fits them.
    pub(crate) fn all(navigators: &'a mut [Navigator], scenarios: &'a mut [u64], out: &'a mut Step) -> Self {
        let Step { next_obs, rewards, terminated, truncated, events, obs } = out;
        Self { first: 0, navigators, scenarios, next_obs, rewards, terminated, truncated, events, obs }
    }

    /// Steps the environments on as many threads as are free of the pool that this runs in. Each environment has random
    /// streams and rows of its own, so the results are the same as by [`Self::step`].
    ///
    /// # Errors
    /// That of the first environment that failed.
    pub(crate) fn step_on_threads(
        self,
        episodes: Episodes,
        advance: &(impl Fn(&mut Navigator, usize) -> Result<StepEnd, EnvError> + Sync),
    ) -> Result<(), EnvError> {
        if self.navigators.len() <= Self::GRAIN {
            return self.step(episodes, advance);
        }
        let (left, right) = self.halves();
        let step = |half: Self| half.step_on_threads(episodes, advance);
        let (left, right) = rayon::join(|| step(left), || step(right));
        left.and(right)
    }

    /// Steps one environment after the other.
    ///
    /// # Errors
    /// That of the first environment that failed.
    pub(crate) fn step(
        self,
        episodes: Episodes,
        advance: &impl Fn(&mut Navigator, usize) -> Result<StepEnd, EnvError>,
    ) -> Result<(), EnvError> {
        let dim = self.obs_dim();
        for (index, navigator) in self.navigators.iter_mut().enumerate() {
            let end = advance(navigator, self.first + index)?;
            self.rewards[index] = end.reward as f32;
            self.terminated[index] = end.terminated;
            self.truncated[index] = end.truncated;
            self.events[index] = end.event;
            let row = index * dim..(index + 1) * dim;
            navigator.observe(&mut self.next_obs[row.clone()]);
            if end.terminated || end.truncated {
                let next = self.scenarios[index] + episodes.stride;
                navigator.restart(episodes.seed, next)?;
                self.scenarios[index] = next;
                navigator.observe(&mut self.obs[row]);
            } else {
                self.obs[row.clone()].copy_from_slice(&self.next_obs[row]);
            }
        }
        Ok(())
    }

    /// Numbers in an observation; of no environments, any will do.
    fn obs_dim(&self) -> usize {
        self.obs.len() / self.navigators.len().max(1)
    }

    fn halves(self) -> (Self, Self) {
        let (middle, dim) = (self.navigators.len() / 2, self.obs_dim());
        let navigators = self.navigators.split_at_mut(middle);
        let scenarios = self.scenarios.split_at_mut(middle);
        let next_obs = self.next_obs.split_at_mut(middle * dim);
        let rewards = self.rewards.split_at_mut(middle);
        let terminated = self.terminated.split_at_mut(middle);
        let truncated = self.truncated.split_at_mut(middle);
        let events = self.events.split_at_mut(middle);
        let obs = self.obs.split_at_mut(middle * dim);
        let left = Self {
            first: self.first,
            navigators: navigators.0,
            scenarios: scenarios.0,
            next_obs: next_obs.0,
            rewards: rewards.0,
            terminated: terminated.0,
            truncated: truncated.0,
            events: events.0,
            obs: obs.0,
        };
        let right = Self {
            first: self.first + middle,
            navigators: navigators.1,
            scenarios: scenarios.1,
            next_obs: next_obs.1,
            rewards: rewards.1,
            terminated: terminated.1,
            truncated: truncated.1,
            events: events.1,
            obs: obs.1,
        };
        (left, right)
    }
}
