//! What one decision and one gradient step cost, on one thread.
//!
//! `ddqn_step/*` is a whole learn step: one env step observed, a minibatch drawn from a replay of 20 000 transitions,
//! three forward passes, Huber loss, backward pass, Adam, and the soft and averaged updates. Its rival `plain` is the
//! same gradient step in candle-nn's own layers and AdamW, on a minibatch that is already there.

#[path = "../tests/plain/mod.rs"]
mod plain;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use headway_rl::{Agent, Dqn, DqnSpec, Mode, StepBatch, TargetRule};
use plain::{Batch, Plain};

/// Deterministic numbers in `[-1, 1]` without any pattern that matters here.
fn numbers(n: usize, phase: f32) -> Vec<f32> {
    (0..n).map(|i| (12.9898 * i as f32 + phase).sin()).collect()
}

fn observe(agent: &mut Dqn, obs_dim: usize, t: usize) {
    let (obs, next_obs) = (numbers(obs_dim, t as f32), numbers(obs_dim, t as f32 + 1.0));
    let batch = StepBatch {
        obs: &obs,
        actions: &[t as u32 % 12],
        rewards: &[obs[0]],
        next_obs: &next_obs,
        terminated: &[t % 100 == 99],
        truncated: &[false],
    };
    agent.observe(batch).expect("a valid batch");
}

/// An agent with one environment that owes a gradient step after each env step.
fn learner(spec: DqnSpec, obs_dim: usize, n_actions: usize) -> Dqn {
    const N_FILLED: u64 = 20_000;
    let spec = DqnSpec { target: TargetRule::DoubleDqn, update_every: 1, warm_up: N_FILLED, ..spec };
    let mut agent = spec.build(obs_dim, n_actions, 1, 100_000_000, 0).expect("a valid spec");
    (0..N_FILLED as usize).for_each(|t| observe(&mut agent, obs_dim, t));
    agent
}

fn act(c: &mut Criterion) {
    let mut agent = DqnSpec::default().build(42, 12, 32, 1, 0).expect("a valid spec");
    for n in [1, 32] {
        let (obs, mut actions) = (numbers(42 * n, 0.0), vec![0; n]);
        c.bench_function(&format!("act/{n}"), |b| {
            b.iter(|| agent.act(black_box(&obs), Mode::Greedy, &mut actions).expect("a valid shape"));
        });
    }
}

fn learn(c: &mut Criterion) {
    let large = DqnSpec { hidden: vec![128, 128], batch_size: 128, ..DqnSpec::default() };
    for (size, spec, obs_dim, n_actions) in [("default", DqnSpec::default(), 42, 12), ("128", large, 40, 15)] {
        let mut agent = learner(spec, obs_dim, n_actions);
        let (obs, next_obs) = (numbers(obs_dim, 0.0), numbers(obs_dim, 1.0));
        let (actions, rewards, flag) = ([3], [0.5], [false]);
        let batch = StepBatch {
            obs: &obs,
            actions: &actions,
            rewards: &rewards,
            next_obs: &next_obs,
            terminated: &flag,
            truncated: &flag,
        };
        c.bench_function(&format!("ddqn_step/{size}/headway"), |b| {
            b.iter(|| {
                agent.observe(black_box(batch)).expect("a valid batch");
                agent.update().expect("finite").expect("due")
            });
        });
        let mut rival = Plain::new(&agent.layers().expect("readable"), 1e-3, 0.01).expect("layers fit");
        let n = if size == "128" { 128 } else { 64 };
        let actions: Vec<u32> = (0..n as u32).map(|k| k % n_actions as u32).collect();
        let (obs, next_obs) = (numbers(n * obs_dim, 0.0), numbers(n * obs_dim, 1.0));
        let batch = Batch::new(&obs, &actions, &numbers(n, 2.0), &next_obs, &vec![0.9; n]).expect("a valid batch");
        c.bench_function(&format!("ddqn_step/{size}/plain"), |b| {
            b.iter(|| rival.step(black_box(&batch)).expect("finite"));
        });
    }
}

criterion_group!(benches, act, learn);
criterion_main!(benches);
