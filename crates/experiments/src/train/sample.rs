//! A few observations of an interval.

/// How many observations a sample has room for: enough to tell a dead unit from a rare one, few enough to cost nothing.
const CAPACITY: usize = 128;

/// Observations of an interval, of all copies of the environment and evenly spread over time: `[n, obs_dim]`, `n` at most
/// 128.
#[derive(Debug)]
pub(super) struct ObsSample {
    obs_dim: usize,
    /// One step in so many is looked at.
    stride: u64,
    n_offered: u64,
    rows: Vec<f32>,
}

impl ObsSample {
    /// An empty sample for intervals of `log_every` env steps over `n_envs` copies.
    pub(super) fn new(n_envs: usize, obs_dim: usize, log_every: u64) -> Self {
        let n_steps = log_every.div_ceil(n_envs as u64);
        let n_looks = CAPACITY.div_ceil(n_envs) as u64;
        Self { obs_dim, stride: n_steps.div_ceil(n_looks).max(1), n_offered: 0, rows: Vec::new() }
    }

    /// Takes the observations of a step, `[n_envs, obs_dim]`, if it is due and as far as there is room.
    pub(super) fn offer(&mut self, obs: &[f32]) {
        if self.n_offered.is_multiple_of(self.stride) {
            let room = CAPACITY * self.obs_dim - self.rows.len();
            self.rows.extend_from_slice(&obs[..obs.len().min(room)]);
        }
        self.n_offered += 1;
    }

    /// The observations.
    pub(super) fn rows(&self) -> &[f32] {
        &self.rows
    }

    /// Begins anew.
    pub(super) fn clear(&mut self) {
        self.rows.clear();
        self.n_offered = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_spread_over_the_interval() {
        // 50 steps of 2 copies, 64 looks at most: every step. 500 steps: every eighth.
        for (log_every, stride) in [(100, 1), (1000, 8)] {
            let mut sample = ObsSample::new(2, 1, log_every);
            (0..log_every / 2).for_each(|k| sample.offer(&[k as f32, -1.0]));
            let steps: Vec<f32> = sample.rows().iter().copied().step_by(2).collect();
            assert_eq!(steps[..3], [0.0, stride as f32, 2.0 * stride as f32]);
            assert!((50..=64).contains(&steps.len()), "{}", steps.len());
            sample.clear();
            assert!(sample.rows().is_empty());
        }
    }

    #[test]
    fn many_copies_do_not_all_fit() {
        let mut sample = ObsSample::new(1000, 3, 10_000);
        (0..10).for_each(|_| sample.offer(&[0.0; 3000]));
        assert_eq!(sample.rows().len(), 128 * 3);
    }
}
