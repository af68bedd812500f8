//! From single steps to n-step transitions.

use serde::{Deserialize, Serialize};

use crate::batch::Step;
use crate::checkpoint::f32_bytes;
use crate::observations::{Observations, Row};
use crate::replay::Transition;

/// The discounted sum of rewards in order of time: `r_1 + gamma r_2 + ... + gamma^(k-1) r_k` (Sutton and Barto 2018, eq. 7.1
/// without its bootstrap).
///
/// ```
/// assert_eq!(headway_rl::n_step_return([1.0, 2.0, 4.0], 0.5), 1.0 + 0.5 * 2.0 + 0.25 * 4.0);
/// assert_eq!(headway_rl::n_step_return([], 0.5), 0.0);
/// ```
pub fn n_step_return<I>(rewards: I, gamma: f32) -> f32
where
    I: IntoIterator<Item = f32, IntoIter: DoubleEndedIterator>,
{
    rewards.into_iter().rev().fold(0.0, |later, reward| reward + gamma * later)
}

/// The last steps of every environment that still wait for their n-step return.
///
/// A step leaves its queue when `n_step` rewards have been heard, or when its episode ends: then the whole queue is
/// flushed with the partial returns, so that no step is lost and no return crosses the end of an episode.
///
/// Queues hold the observations of the steps that wait, and of every environment the latest `next_obs`: where the next
/// step begins with the same numbers, as it does within an episode, they are not stored again.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct NStepQueues {
    n_step: usize,
    gamma: f32,
    /// `[n_envs, n_step]`; columns are slots of rings.
    obs: Vec<Row>,
    /// `[n_envs, n_step]`.
    actions: Vec<u32>,
    /// `[n_envs, n_step]`, scaled.
    #[serde(with = "f32_bytes")]
    rewards: Vec<f32>,
    /// `[n_envs]`: the oldest slot, the number of steps that wait, and what the latest step led to.
    oldest: Vec<usize>,
    len: Vec<usize>,
    latest: Vec<Option<Row>>,
}

impl NStepQueues {
    pub(crate) fn new(n_envs: usize, n_step: usize, gamma: f32) -> Self {
        Self {
            n_step,
            gamma,
            obs: vec![0; n_envs * n_step],
            actions: vec![0; n_envs * n_step],
            rewards: vec![0.0; n_envs * n_step],
            oldest: vec![0; n_envs],
            len: vec![0; n_envs],
            latest: vec![None; n_envs],
        }
    }

    /// Takes in a step of one environment and hands on every transition that it completes, oldest first, with a hold on
    /// both of its observations.
    pub(crate) fn push(
        &mut self,
        env: usize,
        step: &Step<'_>,
        observations: &mut Observations,
        mut store: impl FnMut(&mut Observations, Transition),
    ) {
        let obs = self.row_of(env, step.obs, observations);
        self.append(env, obs, step);
        let next_obs = observations.insert(step.next_obs);
        self.latest[env] = Some(next_obs);
        let ended = step.terminated || step.truncated;
        let n_complete = if ended { self.len[env] } else { usize::from(self.len[env] == self.n_step) };
        for _ in 0..n_complete {
            observations.hold(next_obs);
            let transition = self.oldest(env, next_obs, step.terminated);
            self.oldest[env] = (self.oldest[env] + 1) % self.n_step;
            self.len[env] -= 1;
            store(observations, transition);
        }
    }

    pub(crate) fn n_step(&self) -> usize {
        self.n_step
    }

    pub(crate) fn gamma(&self) -> f32 {
        self.gamma
    }

    /// Every hold on an observation.
    pub(crate) fn holds(&self) -> impl Iterator<Item = Row> {
        let waiting = (0..self.len.len()).flat_map(|env| self.waiting(env));
        waiting.chain(self.latest.iter().copied().flatten())
    }

    /// The observations of an environment's waiting steps.
    fn waiting(&self, env: usize) -> impl Iterator<Item = Row> {
        (0..self.len[env]).map(move |i| self.obs[self.slot(env, i)])
    }

    /// Whether queues read from a stream can stand in for `other`, but for their holds.
    pub(crate) fn fits(&self, other: &Self, n_actions: usize) -> bool {
        (self.n_step, self.gamma, self.obs.len()) == (other.n_step, other.gamma, other.obs.len())
            && (self.actions.len(), self.rewards.len()) == (other.actions.len(), other.rewards.len())
            && (self.oldest.len(), self.len.len()) == (other.oldest.len(), other.len.len())
            && self.latest.len() == other.latest.len()
            && self.oldest.iter().all(|&slot| slot < self.n_step)
            && self.len.iter().all(|&len| len < self.n_step)
            && self.actions.iter().all(|&action| (action as usize) < n_actions)
    }

    /// The row of what was seen before a step, with a hold on it: the latest one's, if the numbers are the same.
    fn row_of(&mut self, env: usize, obs: &[f32], observations: &mut Observations) -> Row {
        match self.latest[env].take() {
            Some(row) if same(observations.get(row), obs) => row,
            latest => {
                latest.into_iter().for_each(|row| observations.release(row));
                observations.insert(obs)
            }
        }
    }

    /// Writes a step into the newest slot; there is room, since a full queue hands on at once.
    fn append(&mut self, env: usize, obs: Row, step: &Step<'_>) {
        let slot = self.slot(env, self.len[env]);
        self.obs[slot] = obs;
        self.actions[slot] = step.action;
        self.rewards[slot] = step.reward;
        self.len[env] += 1;
    }

    /// The oldest waiting step as a transition that leads to `next_obs`.
    fn oldest(&self, env: usize, next_obs: Row, terminated: bool) -> Transition {
        let k = self.len[env];
        let slot = self.slot(env, 0);
        Transition {
            obs: self.obs[slot],
            action: self.actions[slot],
            n_step_return: n_step_return((0..k).map(|age| self.rewards[self.slot(env, age)]), self.gamma),
            next_obs,
            discount: if terminated { 0.0 } else { self.gamma.powi(k as i32) },
        }
    }

    /// The slot of the `i`-th oldest step of an environment.
    fn slot(&self, env: usize, i: usize) -> usize {
        env * self.n_step + (self.oldest[env] + i) % self.n_step
    }
}

/// Whether two observations are the same, bit for bit.
fn same(a: &[f32], b: &[f32]) -> bool {
    a.iter().zip(b).fold(true, |same, (a, b)| same & (a.to_bits() == b.to_bits()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::Replay;
    use proptest::prelude::*;

    #[derive(Debug, Clone, Copy)]
    enum End {
        None,
        Terminated,
        Truncated,
    }

    /// (obs, action, return, next obs, discount), for one-dimensional observations.
    type Stored = (f32, u32, f32, f32, f32);

    /// Pushes steps `t -> t + 1` with action `t` and reward `2^t` of one environment.
    fn run(n_step: usize, gamma: f32, ends: &[End]) -> Vec<Stored> {
        let mut queues = NStepQueues::new(1, n_step, gamma);
        let mut observations = Observations::new(1);
        let mut stored = Vec::new();
        for (t, end) in ends.iter().enumerate() {
            let step = Step {
                obs: &[t as f32],
                action: t as u32,
                reward: f32::powi(2.0, t as i32),
                next_obs: &[t as f32 + 1.0],
                terminated: matches!(end, End::Terminated),
                truncated: matches!(end, End::Truncated),
            };
            queues.push(0, &step, &mut observations, |observations, t| {
                let [obs, next_obs] = [t.obs, t.next_obs].map(|row| observations.get(row)[0]);
                stored.push((obs, t.action, t.n_step_return, next_obs, t.discount));
            });
        }
        stored
    }

    #[test]
    fn one_step_by_hand() {
        let ends = [End::None, End::Terminated, End::Truncated];
        let expected = [(0.0, 0, 1.0, 1.0, 0.5), (1.0, 1, 2.0, 2.0, 0.0), (2.0, 2, 4.0, 3.0, 0.5)];
        assert_eq!(run(1, 0.5, &ends), expected);
    }

    #[test]
    fn three_steps_by_hand() {
        // 1 + 2/2 + 4/4 = 3 after the third step; 2 + 4/2 + 8/4 = 6 after the fourth; the last two still wait.
        let expected = [(0.0, 0, 3.0, 3.0, 0.125), (1.0, 1, 6.0, 4.0, 0.125)];
        assert_eq!(run(3, 0.5, &[End::None; 4]), expected);
    }

    #[test]
    fn termination_flushes_partial_returns_without_a_bootstrap() {
        let expected = [(0.0, 0, 3.0, 3.0, 0.0), (1.0, 1, 4.0, 3.0, 0.0), (2.0, 2, 4.0, 3.0, 0.0)];
        assert_eq!(run(3, 0.5, &[End::None, End::None, End::Terminated]), expected);
    }

    #[test]
    fn truncation_flushes_partial_returns_with_shorter_discounts() {
        // The episode is shorter than n: 1 + 2/2 = 2 over two steps, then 2 over one.
        let expected = [(0.0, 0, 2.0, 2.0, 0.25), (1.0, 1, 2.0, 2.0, 0.5)];
        assert_eq!(run(3, 0.5, &[End::None, End::Truncated]), expected);
    }

    #[test]
    fn no_return_crosses_the_end_of_an_episode() {
        let stored = run(3, 0.5, &[End::None, End::Truncated, End::None, End::None, End::None]);
        // 4 + 8/2 + 16/4 = 12: only rewards of the second episode.
        assert_eq!(stored[2..], [(2.0, 2, 12.0, 5.0, 0.125)]);
    }

    #[test]
    fn environments_do_not_mix() {
        let mut queues = NStepQueues::new(2, 2, 1.0);
        let mut observations = Observations::new(1);
        let mut stored = Vec::new();
        for t in 0..2 {
            for env in 0..2 {
                let reward = if env == 0 { 1.0 } else { 10.0 };
                let obs = [env as f32];
                let step = Step { obs: &obs, action: t, reward, next_obs: &obs, terminated: false, truncated: false };
                queues.push(env, &step, &mut observations, |observations, t| {
                    stored.push((observations.get(t.obs)[0], t.n_step_return));
                });
            }
        }
        assert_eq!(stored, [(0.0, 2.0), (1.0, 20.0)]);
    }

    #[test]
    fn an_observation_is_stored_once_within_an_episode_and_never_confused_with_another() {
        let (mut queues, mut observations) = (NStepQueues::new(1, 2, 1.0), Observations::new(1));
        let mut stored = Vec::new();
        // Four steps that begin where the one before led to, then one that does not, though only by a sign of zero.
        for (obs, next_obs) in [(1.0, 2.0), (2.0, 3.0), (3.0, 4.0), (4.0, 0.0), (-0.0, 5.0)] {
            let (obs, next_obs) = (&[obs], &[next_obs]);
            let step = Step { obs, action: 0, reward: 0.0, next_obs, terminated: false, truncated: false };
            queues.push(0, &step, &mut observations, |_, t| stored.push((t.obs, t.next_obs)));
        }
        assert_eq!(stored, [(0, 2), (1, 3), (2, 4), (3, 6)]);
        assert_eq!([4, 5, 6].map(|row| observations.get(row)[0].to_bits()), [0.0f32, -0.0, 5.0].map(f32::to_bits));
    }

    fn ends() -> impl Strategy<Value = Vec<End>> {
        let end = prop_oneof![8 => Just(End::None), 1 => Just(End::Terminated), 1 => Just(End::Truncated)];
        prop::collection::vec(end, 0..60)
    }

    proptest! {
        /// Against the definition: walk ahead from each step until n rewards or the end of the episode.
        #[test]
        fn queues_equal_the_definition(ends in ends(), n_step in 1usize..6) {
            let gamma = 0.5f32;
            let mut expected = Vec::new();
            for t in 0..ends.len() {
                let last = (t..ends.len().min(t + n_step)).find(|&i| i + 1 == t + n_step || !matches!(ends[i], End::None));
                let Some(last) = last else { continue };
                let rewards: f32 = (t..=last).map(|i| gamma.powi((i - t) as i32) * f32::powi(2.0, i as i32)).sum();
                let terminated = matches!(ends[last], End::Terminated);
                let discount = if terminated { 0.0 } else { gamma.powi((last - t + 1) as i32) };
                expected.push((t as f32, t as u32, rewards, last as f32 + 1.0, discount));
            }
            prop_assert_eq!(run(n_step, gamma, &ends), expected);
        }

        /// What leaks would stay for ever, and what is released too early would be overwritten.
        #[test]
        fn every_hold_is_released_once(
            ends in ends(),
            jumps in prop::collection::vec(any::<bool>(), 60),
            n_step in 1usize..5,
            capacity in 1usize..12,
        ) {
            let (mut queues, mut observations) = (NStepQueues::new(2, n_step, 0.5), Observations::new(1));
            let mut replay = Replay::new(capacity);
            for (t, end) in ends.iter().enumerate() {
                let step = Step {
                    obs: &[if jumps[t] { -1.0 } else { t as f32 }],
                    action: 0,
                    reward: 0.0,
                    next_obs: &[t as f32 + 2.0],
                    terminated: matches!(end, End::Terminated),
                    truncated: matches!(end, End::Truncated),
                };
                queues.push(t % 2, &step, &mut observations, |observations, t| replay.push(observations, t));
                let mut recounted = observations.clone();
                prop_assert!(recounted.recount(1, queues.holds().chain(replay.holds())));
                prop_assert_eq!(&recounted, &observations);
            }
        }
    }
}
