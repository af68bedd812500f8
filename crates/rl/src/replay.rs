//! What the agent remembers: a ring of n-step transitions.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::checkpoint::f32_bytes;

/// One n-step transition; see [`crate::target`] for `n_step_return` and `discount`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Transition<'a> {
    pub(crate) obs: &'a [f32],
    pub(crate) action: u32,
    pub(crate) n_step_return: f32,
    pub(crate) next_obs: &'a [f32],
    pub(crate) discount: f32,
}

/// Transitions drawn from the replay, row-major; rows are `[obs_dim]`.
#[derive(Debug, Clone, Default)]
pub(crate) struct MiniBatch {
    pub(crate) obs: Vec<f32>,
    pub(crate) actions: Vec<u32>,
    pub(crate) n_step_returns: Vec<f32>,
    pub(crate) next_obs: Vec<f32>,
    pub(crate) discounts: Vec<f32>,
}

/// A ring of transitions that grows up to its capacity, then overwrites the oldest.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Replay {
    capacity: usize,
    obs_dim: usize,
    /// The slot that is written next, once full.
    oldest: usize,
    #[serde(with = "f32_bytes")]
    obs: Vec<f32>,
    actions: Vec<u32>,
    #[serde(with = "f32_bytes")]
    n_step_returns: Vec<f32>,
    #[serde(with = "f32_bytes")]
    next_obs: Vec<f32>,
    #[serde(with = "f32_bytes")]
    discounts: Vec<f32>,
}

impl Replay {
    pub(crate) fn new(capacity: usize, obs_dim: usize) -> Self {
        Self {
            capacity,
            obs_dim,
            oldest: 0,
            obs: Vec::new(),
            actions: Vec::new(),
            n_step_returns: Vec::new(),
            next_obs: Vec::new(),
            discounts: Vec::new(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.actions.len()
    }

    pub(crate) fn capacity(&self) -> usize {
        self.capacity
    }

    pub(crate) fn push(&mut self, t: Transition<'_>) {
        if self.len() < self.capacity {
            self.obs.extend_from_slice(t.obs);
            self.actions.push(t.action);
            self.n_step_returns.push(t.n_step_return);
            self.next_obs.extend_from_slice(t.next_obs);
            self.discounts.push(t.discount);
        } else {
            self.overwrite(self.oldest, t);
            self.oldest = (self.oldest + 1) % self.capacity;
        }
    }

    /// Draws `n` transitions uniformly, with replacement.
    ///
    /// # Panics
    /// If the replay is empty.
    pub(crate) fn sample(&self, n: usize, rng: &mut ChaCha8Rng) -> MiniBatch {
        let mut batch = MiniBatch {
            obs: Vec::with_capacity(n * self.obs_dim),
            actions: Vec::with_capacity(n),
            n_step_returns: Vec::with_capacity(n),
            next_obs: Vec::with_capacity(n * self.obs_dim),
            discounts: Vec::with_capacity(n),
        };
        for _ in 0..n {
            // u32 rather than usize: the same draw on every machine, and cheaper.
            let i = rng.random_range(0..self.len() as u32) as usize;
            let row = i * self.obs_dim..(i + 1) * self.obs_dim;
            batch.obs.extend_from_slice(&self.obs[row.clone()]);
            batch.actions.push(self.actions[i]);
            batch.n_step_returns.push(self.n_step_returns[i]);
            batch.next_obs.extend_from_slice(&self.next_obs[row]);
            batch.discounts.push(self.discounts[i]);
        }
        batch
    }

    /// Whether a replay read from a stream can stand in for `other`.
    pub(crate) fn fits(&self, other: &Self, n_actions: usize) -> bool {
        let n = self.len();
        (self.capacity, self.obs_dim) == (other.capacity, other.obs_dim)
            && (self.obs.len(), self.next_obs.len()) == (n * self.obs_dim, n * self.obs_dim)
            && (self.n_step_returns.len(), self.discounts.len()) == (n, n)
            && n <= self.capacity
            && self.oldest < self.capacity
            && self.actions.iter().all(|&action| (action as usize) < n_actions)
    }

    fn overwrite(&mut self, i: usize, t: Transition<'_>) {
        let row = i * self.obs_dim..(i + 1) * self.obs_dim;
        self.obs[row.clone()].copy_from_slice(t.obs);
        self.actions[i] = t.action;
        self.n_step_returns[i] = t.n_step_return;
        self.next_obs[row].copy_from_slice(t.next_obs);
        self.discounts[i] = t.discount;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::stream;

    /// Transition number `i`, recognisable in every column.
    fn push(replay: &mut Replay, i: u32) {
        let x = i as f32;
        let t = Transition {
            obs: &[x, -x],
            action: i,
            n_step_return: 10.0 * x,
            next_obs: &[x + 1.0, -x - 1.0],
            discount: x,
        };
        replay.push(t);
    }

    #[test]
    fn rows_stay_together_and_the_oldest_go_first() {
        let mut replay = Replay::new(5, 2);
        (0..13).for_each(|i| push(&mut replay, i));
        assert_eq!(replay.len(), 5);
        let batch = replay.sample(400, &mut stream(0, "replay"));
        let mut seen = [0; 13];
        for (row, &i) in batch.actions.iter().enumerate() {
            let x = i as f32;
            seen[i as usize] += 1;
            assert_eq!(batch.obs[2 * row..][..2], [x, -x]);
            assert_eq!(batch.next_obs[2 * row..][..2], [x + 1.0, -x - 1.0]);
            assert_eq!((batch.n_step_returns[row], batch.discounts[row]), (10.0 * x, x));
        }
        assert_eq!(seen[..8], [0; 8]);
        // 80 of each on average, standard deviation 8.
        assert!(seen[8..].iter().all(|n| (50..110).contains(n)), "{seen:?}");
    }

    #[test]
    fn memory_grows_with_what_is_stored() {
        let mut replay = Replay::new(1_000_000_000, 2);
        push(&mut replay, 1);
        assert_eq!(replay.len(), 1);
        assert_eq!(replay.sample(3, &mut stream(0, "replay")).actions, [1, 1, 1]);
    }
}
