//! The targets of Q-learning, as pure functions of Q-values.
//!
//! Everywhere `n_step_return` is `r_1 + gamma r_2 + ... + gamma^(k-1) r_k` and `discount` is `gamma^k`, or 0 if the
//! episode terminated within these `k` steps. An episode that is *truncated* keeps its discount: the state it was cut
//! off in still has a value, and the target bootstraps from it. Rows of Q-values are `[n_actions]`.

use serde::{Deserialize, Serialize};

/// Who selects and who evaluates the action after the step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TargetRule {
    /// The target network does both: eq. (3) of Liu et al.; Mnih et al. (2015).
    Dqn,
    /// The online network selects, the target network evaluates: van Hasselt, Guez, Silver (2016), eq. (4).
    DoubleDqn,
}

/// The index of the largest value; the first one among equals.
///
/// ```
/// assert_eq!(headway_rl::target::argmax(&[1.0, 3.0, 3.0]), 1);
/// ```
pub fn argmax(q: &[f32]) -> usize {
    let mut best = 0;
    for (i, value) in q.iter().enumerate() {
        if *value > q[best] {
            best = i;
        }
    }
    best
}

/// The update of tabular Q-learning: eq. (1) of Liu et al.; Watkins (1989).
///
/// `Q(s, a) <- Q(s, a) + alpha (r + discount max_a' Q(s', a') - Q(s, a))`, with `alpha` in `[0, 1]`; returns the new Q(s, a).
///
/// ```
/// let q = headway_rl::target::q_learning(2.0, 0.5, 1.0, 0.9, &[3.0, 10.0]);
/// assert_eq!(q, 2.0 + 0.5 * (1.0 + 0.9 * 10.0 - 2.0));
/// ```
pub fn q_learning(q: f64, alpha: f64, reward: f64, discount: f64, q_next: &[f64]) -> f64 {
    let best = q_next.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    q + alpha * (reward + discount * best - q)
}

/// The target of DQN: eq. (3) of Liu et al., for n steps.
///
/// `y = G + discount max_a' Q(s', a'; theta-)`, with `theta-` the target network.
///
/// ```
/// let y = headway_rl::target::dqn(1.0, 0.5, &[2.0, 4.0]);
/// assert_eq!(y, 1.0 + 0.5 * 4.0);
/// ```
pub fn dqn(n_step_return: f32, discount: f32, target_next: &[f32]) -> f32 {
    n_step_return + discount * target_next[argmax(target_next)]
}

/// The target of Double DQN: van Hasselt et al. (2016), eq. (4), for n steps.
///
/// `y = G + discount Q(s', argmax_a' Q(s', a'; theta); theta-)`, with `theta` the online, `theta-` the target network.
///
/// ```
/// // The online network prefers action 0, which the target network values at 2: DQN would have taken the 4.
/// let y = headway_rl::target::double_dqn(1.0, 0.5, &[9.0, 8.0], &[2.0, 4.0]);
/// assert_eq!(y, 1.0 + 0.5 * 2.0);
/// ```
pub fn double_dqn(n_step_return: f32, discount: f32, online_next: &[f32], target_next: &[f32]) -> f32 {
    n_step_return + discount * target_next[argmax(online_next)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ONLINE: [f32; 3] = [1.0, 5.0, 2.0];
    const TARGET: [f32; 3] = [4.0, 3.0, 7.0];
    const GAMMA: f32 = 0.5;

    // (case, discount, DQN, Double DQN) for a reward of -1. Online selects action 1, worth 3; the target's maximum is 7.
    const CASES: [(&str, f32, f32, f32); 3] =
        [("terminated", 0.0, -1.0, -1.0), ("truncated", GAMMA, 2.5, 0.5), ("neither", GAMMA, 2.5, 0.5)];

    #[test]
    fn targets_by_hand() {
        for (case, discount, expected_dqn, expected_double) in CASES {
            assert_eq!(dqn(-1.0, discount, &TARGET), expected_dqn, "{case}");
            assert_eq!(double_dqn(-1.0, discount, &ONLINE, &TARGET), expected_double, "{case}");
        }
    }

    #[test]
    fn q_learning_by_hand() {
        // 1 + 0.1 (10 + 0.9 * 4 - 1) = 2.26; terminated: 1 + 0.1 (10 - 1) = 1.9.
        assert!((q_learning(1.0, 0.1, 10.0, 0.9, &[4.0, -2.0]) - 2.26).abs() < 1e-12);
        assert!((q_learning(1.0, 0.1, 10.0, 0.0, &[4.0, -2.0]) - 1.9).abs() < 1e-12);
    }

    #[test]
    fn rules_are_named_as_in_specs() {
        let json = |rule| toml::Value::try_from(rule).unwrap().as_str().unwrap().to_owned();
        assert_eq!(json(TargetRule::Dqn), "dqn");
        assert_eq!(json(TargetRule::DoubleDqn), "double_dqn");
    }

    proptest! {
        // Why Double DQN exists: it never exceeds DQN, whose maximum over noise is biased upwards.
        #[test]
        fn double_dqn_is_never_above_dqn(
            g in -5.0..5.0f32,
            discount in 0.0..1.0f32,
            online in prop::collection::vec(-5.0..5.0f32, 6),
            target in prop::collection::vec(-5.0..5.0f32, 6),
        ) {
            prop_assert!(double_dqn(g, discount, &online, &target) <= dqn(g, discount, &target));
            prop_assert_eq!(double_dqn(g, discount, &target, &target), dqn(g, discount, &target));
        }
    }
}
