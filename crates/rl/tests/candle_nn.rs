//! The learner against the same algorithm in candle-nn's own layers and optimiser.

mod plain;

use headway_rl::{Agent, DqnSpec, Epsilon, LearningRate, StepBatch, TargetRule, TargetUpdate};
use plain::{Batch, Plain};

#[test]
fn dqn_agrees_with_plain_candle_over_many_steps() {
    agree_over_many_steps(TargetRule::Dqn);
}

#[test]
fn double_dqn_agrees_with_plain_candle_over_many_steps() {
    agree_over_many_steps(TargetRule::DoubleDqn);
}

fn agree_over_many_steps(target: TargetRule) {
    const OBS_DIM: usize = 4;
    const N_ACTIONS: usize = 3;
    const BATCH: usize = 8;
    let spec = DqnSpec {
        target,
        hidden: vec![16, 16],
        n_step: 1,
        learning_rate: LearningRate { start: 0.01, end: 0.01 },
        target_network: TargetUpdate::Soft { tau: 0.1 },
        epsilon: Epsilon { start: 0.0, end: 0.0, fraction: 1.0 },
        batch_size: BATCH,
        update_every: 1,
        warm_up: 0,
        reward_scale: 1.0,
        average: 1.0, // the averaged weights are the learned ones
        ..DqnSpec::default()
    };
    let mut agent = spec.build(OBS_DIM, N_ACTIONS, 1, 1000, 5).unwrap();
    let mut plain = Plain::new(target, &agent.layers().unwrap(), 0.01, 0.1).unwrap();
    // One transition again and again: whatever is drawn from the replay, the minibatch is known.
    let (obs, next_obs, reward) = ([0.3, -0.7, 0.2, 0.9], [0.5, -0.4, 0.1, 0.8], 2.5);
    let repeat = |row: &[f32]| row.repeat(BATCH);
    let batch =
        Batch::new(&repeat(&obs), &[1; BATCH], &[reward; BATCH], &repeat(&next_obs), &[spec.gamma as f32; BATCH])
            .unwrap();
    for _ in 0..50 {
        agent
            .observe(StepBatch {
                obs: &obs,
                actions: &[1],
                rewards: &[reward],
                next_obs: &next_obs,
                terminated: &[false],
                truncated: &[false],
            })
            .unwrap();
        let loss = agent.update().unwrap().expect("an update is due after every step").value;
        let expected = plain.step(&batch).unwrap().to_scalar::<f32>().unwrap();
        assert!((loss - expected).abs() < 1e-4 * expected.max(1.0), "{loss} but plain candle {expected}");
    }
}
