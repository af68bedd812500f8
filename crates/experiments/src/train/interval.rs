//! What is added up between two rows of the metrics.

use headway_env::{Event, Step};
use headway_rl::Loss;

/// What happened since the last row of metrics.
#[derive(Debug, Default)]
pub(super) struct Interval {
    pub(super) n_env_steps: u64,
    pub(super) rewards: f64,
    pub(super) n_reached: u64,
    pub(super) n_collisions: u64,
    pub(super) n_timeouts: u64,
    n_updates: u64,
    loss: f64,
    mean_q: f64,
    grad_norm: f64,
}

impl Interval {
    pub(super) fn count(&mut self, step: &Step) {
        self.n_env_steps += step.rewards.len() as u64;
        self.rewards += step.rewards.iter().copied().map(f64::from).sum::<f64>();
        let n_events = |event| step.events.iter().filter(|e| **e == Some(event)).count() as u64;
        self.n_reached += n_events(Event::Reach);
        self.n_collisions += n_events(Event::Collision);
        self.n_timeouts += step.truncated.iter().filter(|truncated| **truncated).count() as u64;
    }

    pub(super) fn count_update(&mut self, loss: &Loss) {
        self.n_updates += 1;
        self.loss += f64::from(loss.value);
        self.mean_q += f64::from(loss.mean_q);
        self.grad_norm += f64::from(loss.grad_norm);
    }

    /// The means over the gradient steps: loss, value and norm of the gradient.
    pub(super) fn update_means(&self) -> [Option<f64>; 3] {
        let mean = |sum: f64| (self.n_updates > 0).then(|| sum / self.n_updates as f64);
        [self.loss, self.mean_q, self.grad_norm].map(mean)
    }

    /// The share of all goals that ended, one way or another, that `n` of them are.
    pub(super) fn share_of_ends(&self, n: u64) -> Option<f64> {
        let n_ends = self.n_reached + self.n_collisions + self.n_timeouts;
        (n_ends > 0).then(|| n as f64 / n_ends as f64)
    }
}
