//! Agents learn a tiny MDP whose solution is known by value iteration.

mod common;

use common::{Corridors, GAMMA, N_ACTIONS, N_STATES, one_hot, policy, value_iteration};
use headway_rl::{Agent, Dqn, DqnSpec, Epsilon, LearningRate, LossFn, Mode, TabularSpec, TargetRule, TargetUpdate};

const N_ENVS: usize = 8;

fn dqn(target: TargetRule, n_step: usize, n_steps: u64) -> Dqn {
    let spec = DqnSpec {
        target,
        n_step,
        hidden: vec![32],
        gamma: GAMMA,
        learning_rate: LearningRate { start: 0.005, end: 0.0005 },
        batch_size: 32,
        update_every: 8,
        warm_up: 200,
        target_network: TargetUpdate::Soft { tau: 0.02 },
        epsilon: Epsilon { start: 1.0, end: 0.1, fraction: 0.5 },
        average: 0.02,
        reward_scale: 1.0,
        ..DqnSpec::default()
    };
    let mut agent = spec.build(N_STATES, N_ACTIONS, N_ENVS, n_steps, 5).unwrap();
    train(&mut agent, n_steps);
    agent
}

fn train(agent: &mut dyn Agent, n_steps: u64) {
    let mut corridors = Corridors::new(N_ENVS);
    for _ in 0..n_steps / N_ENVS as u64 {
        corridors.step(agent);
    }
}

/// The agent's Q-values in every cell.
fn table(agent: &Dqn) -> [[f64; N_ACTIONS]; N_STATES] {
    std::array::from_fn(|cell| {
        let q = agent.q_values(&one_hot(cell)).unwrap();
        std::array::from_fn(|action| f64::from(q[action]))
    })
}

fn largest_error(q: &[[f64; N_ACTIONS]; N_STATES]) -> f64 {
    let expected = value_iteration();
    q.iter().flatten().zip(expected.iter().flatten()).map(|(q, expected)| (q - expected).abs()).fold(0.0, f64::max)
}

#[test]
fn the_oracle_agrees_with_a_closed_form() {
    let q = value_iteration();
    // From cell 4 the goal pays 1. From cell 0, four steps cost 0.1 each and the fifth pays 1; staying there for ever
    // pays 0.08 / (1 - gamma) = 0.8 and is better.
    let walk = -0.1 * (1.0 + 0.9 + 0.81 + 0.729) + 0.9f64.powi(4);
    assert!((q[4][1] - 1.0).abs() < 1e-12);
    assert!((q[0][0] - 0.8).abs() < 1e-12 && walk < 0.8);
    assert_eq!(policy(&q), [0, 0, 1, 1, 1]);
}

#[test]
fn the_table_converges_to_value_iteration() {
    let mut agent = TabularSpec { alpha: 0.5, gamma: GAMMA, epsilon: 0.5 }.build(N_STATES, N_ACTIONS, 1).unwrap();
    train(&mut agent, 20_000);
    let q: [[f64; N_ACTIONS]; N_STATES] = std::array::from_fn(|cell| [agent.q(cell)[0], agent.q(cell)[1]]);
    assert!(largest_error(&q) < 1e-6, "{q:?}");
}

#[test]
fn both_target_rules_learn_the_values_of_value_iteration() {
    for target in [TargetRule::Dqn, TargetRule::DoubleDqn] {
        let q = table(&dqn(target, 1, 30_000));
        assert!(largest_error(&q) < 0.03, "{target:?}: {q:?}");
        assert_eq!(policy(&q), policy(&value_iteration()), "{target:?}: {q:?}");
    }
}

/// The actions that greedy acting takes are those of the averaged weights' Q-values.
#[test]
fn three_steps_learn_the_same_policy() {
    for target in [TargetRule::Dqn, TargetRule::DoubleDqn] {
        let mut agent = dqn(target, 3, 30_000);
        let obs: Vec<f32> = (0..N_STATES).flat_map(one_hot).collect();
        let mut actions = [9; N_STATES];
        agent.act(&obs, Mode::Greedy, &mut actions).unwrap();
        let q = table(&agent);
        assert_eq!(actions.map(|action| action as usize), policy(&q));
        // Without correction, three steps of exploring actions bias the values near the tie in cell 1.
        assert_eq!(actions[2..], [1, 1, 1], "{target:?}: {q:?}");
        assert_eq!(actions[0], 0, "{target:?}: {q:?}");
    }
}

/// Without hidden layers and with one-hot observations the network *is* a table, up to its bias.
#[test]
fn a_linear_network_learns_the_table() {
    let spec = DqnSpec {
        hidden: vec![],
        gamma: GAMMA,
        n_step: 1,
        loss: LossFn::Mse {},
        learning_rate: LearningRate { start: 0.02, end: 0.001 },
        update_every: 4,
        target_network: TargetUpdate::Hard { every: 50 },
        reward_scale: 1.0,
        epsilon: Epsilon { start: 1.0, end: 0.5, fraction: 1.0 },
        ..DqnSpec::default()
    };
    let mut agent = spec.build(N_STATES, N_ACTIONS, N_ENVS, 20_000, 2).unwrap();
    train(&mut agent, 20_000);
    let q = table(&agent);
    assert!(largest_error(&q) < 0.01, "{q:?}");
}

/// A world without an end, cut off after every fifth step: V = 1 / (1 - gamma) = 10. An agent that stores truncation as
/// termination believes 1 + 0.9 V at most, averaged over ages, and stays far below.
#[test]
fn a_time_limit_is_no_end() {
    use headway_rl::StepBatch;
    let tabular = TabularSpec { alpha: 0.1, gamma: 0.9, epsilon: 0.0 };
    let spec = DqnSpec {
        hidden: vec![],
        gamma: 0.9,
        reward_scale: 1.0,
        update_every: 1,
        warm_up: 64,
        learning_rate: LearningRate { start: 0.05, end: 0.001 },
        target_network: TargetUpdate::Soft { tau: 0.05 },
        average: 0.01,
        ..DqnSpec::default()
    };
    let mut table = tabular.build(1, 1, 0).unwrap();
    let mut network = spec.build(1, 1, 1, 4_000, 0).unwrap();
    for t in 0..4_000 {
        let batch = StepBatch {
            obs: &[1.0],
            actions: &[0],
            rewards: &[1.0],
            next_obs: &[1.0],
            terminated: &[false],
            truncated: &[t % 5 == 4],
        };
        table.observe(batch).unwrap();
        network.observe(batch).unwrap();
        network.update().unwrap();
    }
    assert!((table.q(0)[0] - 10.0).abs() < 1e-3);
    assert!((network.q_values(&[1.0]).unwrap()[0] - 10.0).abs() < 0.1);
}
