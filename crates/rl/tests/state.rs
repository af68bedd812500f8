//! The whole state in a stream: what was saved continues as if nothing had happened.

mod common;

use common::{Corridors, N_ACTIONS, N_STATES};
use headway_rl::{Agent, Dqn, DqnSpec, Mode, StepBatch, TabularSpec, TargetRule};

const N_ENVS: usize = 4;

fn spec() -> DqnSpec {
    DqnSpec {
        target: TargetRule::DoubleDqn,
        hidden: vec![8],
        batch_size: 16,
        update_every: 4,
        warm_up: 40,
        replay_capacity: 300,
        ..DqnSpec::default()
    }
}

fn build(spec: &DqnSpec, seed: u64) -> Dqn {
    spec.build(N_STATES, N_ACTIONS, N_ENVS, 2_000, seed).unwrap()
}

fn saved(agent: &dyn Agent) -> Vec<u8> {
    let mut bytes = Vec::new();
    agent.save(&mut bytes).unwrap();
    bytes
}

fn train(agent: &mut dyn Agent, corridors: &mut Corridors, n_batches: usize) {
    (0..n_batches).for_each(|_| corridors.step(agent));
}

#[test]
fn equal_seeds_give_equal_bytes_and_other_seeds_others() {
    let run = |seed| {
        let mut agent = build(&spec(), seed);
        train(&mut agent, &mut Corridors::new(N_ENVS), 200);
        assert_eq!(agent.n_env_steps(), 800);
        assert_eq!(agent.n_gradient_steps(), (800 - 40) / 4);
        assert_eq!(agent.replay_len(), 300);
        saved(&agent)
    };
    assert!(run(1) == run(1));
    assert!(run(1) != run(2));
}

#[test]
fn a_loaded_agent_continues_byte_for_byte() {
    // At 15 batches before the first update, at 60 while the replay fills, at 150 once it wraps.
    for n_batches in [0, 5, 15, 60, 150] {
        let (mut agent, mut corridors) = (build(&spec(), 1), Corridors::new(N_ENVS));
        train(&mut agent, &mut corridors, n_batches);
        let bytes = saved(&agent);
        let mut other = build(&spec(), 99);
        other.load(&mut bytes.as_slice()).unwrap();
        assert!(saved(&other) == bytes);
        assert_eq!(other.layers().unwrap(), agent.layers().unwrap());

        let mut twin = corridors.clone();
        train(&mut agent, &mut corridors, 60);
        train(&mut other, &mut twin, 60);
        assert!(saved(&other) == saved(&agent), "after {n_batches} batches");
    }
}

#[test]
fn loading_reads_not_a_byte_further() {
    let agent = build(&spec(), 1);
    let mut bytes = saved(&agent);
    bytes.extend(b"next");
    let mut stream = bytes.as_slice();
    build(&spec(), 2).load(&mut stream).unwrap();
    assert_eq!(stream, b"next");
}

#[test]
fn another_shape_is_named() {
    let bytes = saved(&build(&spec(), 1));
    let message = |mut agent: Dqn| agent.load(&mut bytes.as_slice()).unwrap_err().to_string();
    let wider = build(&DqnSpec { hidden: vec![9], ..spec() }, 1);
    assert_eq!(message(wider), "saved state has widths = [5, 8, 2], this agent has [5, 9, 2]");
    let more = spec().build(N_STATES, N_ACTIONS, 5, 2_000, 1).unwrap();
    assert_eq!(message(more), "saved state has n_envs = 4, this agent has 5");
    let longer = build(&DqnSpec { n_step: 4, ..spec() }, 1);
    assert_eq!(message(longer), "saved state has n_step = 3, this agent has 4");
    let larger = build(&DqnSpec { replay_capacity: 301, ..spec() }, 1);
    assert_eq!(message(larger), "saved state has replay_capacity = 300, this agent has 301");

    let mut table = TabularSpec::default().build(N_STATES, N_ACTIONS, 0).unwrap();
    assert!(table.load(&mut bytes.as_slice()).is_err());
    let mut agent = build(&spec(), 1);
    assert!(agent.load(&mut saved(&table).as_slice()).is_err());
}

#[test]
fn a_stream_cut_short_anywhere_is_an_error_and_changes_nothing() {
    let mut agent = build(&spec(), 1);
    train(&mut agent, &mut Corridors::new(N_ENVS), 30);
    let bytes = saved(&agent);
    let mut other = build(&spec(), 2);
    let before = saved(&other);
    for len in (0..bytes.len()).step_by(97) {
        assert!(other.load(&mut &bytes[..len]).is_err(), "{len} of {} bytes", bytes.len());
    }
    assert!(saved(&other) == before);
}

/// Whatever a damaged stream says, it is refused, or makes an agent whose every index is within bounds.
#[test]
fn a_damaged_stream_never_makes_an_agent_that_panics() {
    let (mut agent, mut corridors) = (build(&spec(), 1), Corridors::new(N_ENVS));
    train(&mut agent, &mut corridors, 120);
    let bytes = saved(&agent);
    let (mut n_refused, mut n_loaded) = (0, 0);
    for at in (0..bytes.len()).step_by(7) {
        for damage in [0x01, 0x80, 0xff] {
            let mut bytes = bytes.clone();
            bytes[at] ^= damage;
            let mut other = build(&spec(), 2);
            if other.load(&mut bytes.as_slice()).is_err() {
                n_refused += 1;
                continue;
            }
            n_loaded += 1;
            for _ in 0..20 {
                let mut actions = [0; N_ENVS];
                other.act(&corridors.obs(), Mode::Explore, &mut actions).unwrap();
                other
                    .observe(StepBatch {
                        obs: &corridors.obs(),
                        actions: &actions,
                        rewards: &[1.0; N_ENVS],
                        next_obs: &corridors.obs(),
                        terminated: &[false; N_ENVS],
                        truncated: &[true; N_ENVS],
                    })
                    .unwrap();
                // Numbers may have become infinite, which is an error of its own.
                _ = other.update();
            }
        }
    }
    assert!(n_refused > 100 && n_loaded > 100, "{n_refused} refused, {n_loaded} loaded");
}

#[test]
fn the_table_survives_too() {
    let (mut agent, mut corridors) =
        (TabularSpec::default().build(N_STATES, N_ACTIONS, 3).unwrap(), Corridors::new(N_ENVS));
    train(&mut agent, &mut corridors, 50);
    let mut other = TabularSpec::default().build(N_STATES, N_ACTIONS, 4).unwrap();
    other.load(&mut saved(&agent).as_slice()).unwrap();
    let mut twin = corridors.clone();
    train(&mut agent, &mut corridors, 50);
    train(&mut other, &mut twin, 50);
    assert!(saved(&other) == saved(&agent));
}

#[test]
fn weights_move_from_one_agent_to_another() {
    let mut agent = build(&spec(), 1);
    train(&mut agent, &mut Corridors::new(N_ENVS), 60);
    let mut other = build(&spec(), 2);
    other.start_from(&agent.layers().unwrap()).unwrap();
    let obs = Corridors::new(3).obs();
    assert_eq!(other.q_values(&obs).unwrap(), agent.q_values(&obs).unwrap());
    let mut narrow = build(&DqnSpec { hidden: vec![7], ..spec() }, 2);
    let message = narrow.start_from(&agent.layers().unwrap()).unwrap_err().to_string();
    assert_eq!(message, "weight has 40 elements, expected 35 ([7, 5])");
}

#[test]
fn agents_can_move_to_another_thread() {
    fn check<T: Send + Sync>() {}
    check::<Dqn>();
    check::<headway_rl::TabularQ>();
}
