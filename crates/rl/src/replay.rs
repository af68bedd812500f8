//! What the agent remembers: a ring of n-step transitions.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::observations::{Observations, Row};

/// One n-step transition, in 20 bytes; see [`crate::target`] for `n_step_return` and `discount`.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(crate) struct Transition {
    pub(crate) obs: Row,
    pub(crate) action: u32,
    pub(crate) n_step_return: f32,
    pub(crate) next_obs: Row,
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
    /// What the columns were gathered from.
    pub(crate) drawn: Vec<Transition>,
}

/// A ring of transitions that grows up to its capacity, then overwrites the oldest.
///
/// Consecutive transitions share their observations, so that each takes 20 bytes and one row of [`Observations`], of
/// `4 obs_dim + 4`: 192 bytes with the 42 numbers of the default task, where two rows of its own would make it 348. An
/// episode's end takes one row more, and so does every step that does not begin where the one before led to.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Replay {
    capacity: usize,
    /// The slot that is written next, once full.
    oldest: usize,
    transitions: Vec<Transition>,
}

impl Replay {
    pub(crate) fn new(capacity: usize) -> Self {
        Self { capacity, oldest: 0, transitions: Vec::new() }
    }

    pub(crate) fn len(&self) -> usize {
        self.transitions.len()
    }

    pub(crate) fn capacity(&self) -> usize {
        self.capacity
    }

    /// Takes over a transition's holds on its observations, and releases those of the one it overwrites.
    pub(crate) fn push(&mut self, observations: &mut Observations, transition: Transition) {
        if self.len() < self.capacity {
            self.transitions.push(transition);
            return;
        }
        let overwritten = std::mem::replace(&mut self.transitions[self.oldest], transition);
        observations.release(overwritten.obs);
        observations.release(overwritten.next_obs);
        self.oldest = (self.oldest + 1) % self.capacity;
    }

    /// Draws `n` transitions uniformly, with replacement.
    ///
    /// # Panics
    /// If the replay is empty.
    pub(crate) fn sample(&self, observations: &Observations, n: usize, rng: &mut ChaCha8Rng, batch: &mut MiniBatch) {
        batch.clear();
        // u32 rather than usize: the same draw on every machine, and cheaper. All draws come first, so that the
        // processor fetches many transitions, and then many observations, from memory at once.
        let draw = |_| self.transitions[rng.random_range(0..self.len() as u32) as usize];
        batch.drawn.extend((0..n).map(draw));
        for t in &batch.drawn {
            batch.obs.extend_from_slice(observations.get(t.obs));
            batch.next_obs.extend_from_slice(observations.get(t.next_obs));
            batch.actions.push(t.action);
            batch.n_step_returns.push(t.n_step_return);
            batch.discounts.push(t.discount);
        }
    }

    /// Every hold on an observation.
    pub(crate) fn holds(&self) -> impl Iterator<Item = Row> {
        self.transitions.iter().flat_map(|t| [t.obs, t.next_obs])
    }

    /// Whether a replay read from a stream can stand in for `other`, but for its holds.
    pub(crate) fn fits(&self, other: &Self, n_actions: usize) -> bool {
        self.capacity == other.capacity
            && self.len() <= self.capacity
            && self.oldest < self.capacity
            && self.transitions.iter().all(|t| (t.action as usize) < n_actions)
    }
}

impl MiniBatch {
    /// Forgets the rows and keeps their memory.
    fn clear(&mut self) {
        self.obs.clear();
        self.actions.clear();
        self.n_step_returns.clear();
        self.next_obs.clear();
        self.discounts.clear();
        self.drawn.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::stream;

    /// Transition number `i`, recognisable in every column.
    fn push(replay: &mut Replay, observations: &mut Observations, i: u32) {
        let x = i as f32;
        let [obs, next_obs] = [[x, -x], [x + 1.0, -x - 1.0]].map(|obs| observations.insert(&obs));
        replay.push(observations, Transition { obs, action: i, n_step_return: 10.0 * x, next_obs, discount: x });
    }

    fn sample(replay: &Replay, observations: &Observations, n: usize) -> MiniBatch {
        let mut batch = MiniBatch::default();
        replay.sample(observations, n, &mut stream(0, "replay"), &mut batch);
        batch
    }

    #[test]
    fn rows_stay_together_and_the_oldest_go_first() {
        let (mut replay, mut observations) = (Replay::new(5), Observations::new(2));
        (0..13).for_each(|i| push(&mut replay, &mut observations, i));
        assert_eq!(replay.len(), 5);
        let batch = sample(&replay, &observations, 400);
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
    fn a_transition_takes_twenty_bytes() {
        assert_eq!(size_of::<Transition>(), 20);
    }

    #[test]
    fn memory_grows_with_what_is_stored() {
        let (mut replay, mut observations) = (Replay::new(1_000_000_000), Observations::new(2));
        push(&mut replay, &mut observations, 1);
        assert_eq!(replay.len(), 1);
        assert_eq!(sample(&replay, &observations, 3).actions, [1, 1, 1]);
        // A batch forgets what it held.
        let mut batch = sample(&replay, &observations, 3);
        replay.sample(&observations, 2, &mut stream(0, "replay"), &mut batch);
        assert_eq!((batch.actions.len(), batch.obs.len(), batch.next_obs.len()), (2, 4, 4));
    }
}
