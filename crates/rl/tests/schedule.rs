//! When updates are due, and what the schedules do along a training.

use headway_rl::{Agent, Dqn, DqnSpec, Mode, StepBatch};

fn observe(agent: &mut Dqn, n_envs: usize) {
    let (numbers, flags) = (vec![0.5; n_envs], vec![false; n_envs]);
    agent
        .observe(StepBatch {
            obs: &numbers,
            actions: &vec![0; n_envs],
            rewards: &numbers,
            next_obs: &numbers,
            terminated: &flags,
            truncated: &flags,
        })
        .unwrap();
}

fn n_due(agent: &mut Dqn) -> usize {
    std::iter::from_fn(|| agent.update().unwrap()).count()
}

#[test]
fn env_steps_earn_gradient_steps_after_the_warm_up() {
    let spec = DqnSpec { hidden: vec![4], update_every: 16, warm_up: 100, ..DqnSpec::default() };
    let mut agent = spec.build(1, 2, 32, 10_000, 0).unwrap();
    let due: Vec<_> = (0..6)
        .map(|_| {
            observe(&mut agent, 32);
            n_due(&mut agent)
        })
        .collect();
    // 32, 64, 96 are warm-up; 128 - 100 = 28 earns one; 60 three; 92 five.
    assert_eq!(due, [0, 0, 0, 1, 2, 2]);
}

#[test]
fn sparse_updates_wait_for_several_batches() {
    let spec = DqnSpec { hidden: vec![4], update_every: 80, warm_up: 0, ..DqnSpec::default() };
    let mut agent = spec.build(1, 2, 32, 10_000, 0).unwrap();
    let mut due = 0;
    for _ in 0..10 {
        observe(&mut agent, 32);
        due += n_due(&mut agent);
    }
    assert_eq!(due, 320 / 80);
}

#[test]
fn schedules_follow_the_training_and_end_with_it() {
    let spec = DqnSpec { hidden: vec![4], ..DqnSpec::default() };
    let mut agent = spec.build(1, 2, 10, 1_000, 0).unwrap();
    assert_eq!((agent.epsilon(), agent.learning_rate()), (1.0, 0.003));
    (0..30).for_each(|_| observe(&mut agent, 10));
    assert_eq!(agent.epsilon(), 0.02);
    assert!((agent.learning_rate() - (0.003 - 0.3 * 0.0027)).abs() < 1e-12);
    (0..80).for_each(|_| observe(&mut agent, 10));
    assert_eq!((agent.epsilon(), agent.learning_rate()), (0.02, 0.0003));
}

#[test]
fn epsilon_is_the_share_of_random_actions_and_greedy_acting_is_pure() {
    let spec = DqnSpec { hidden: vec![4], ..DqnSpec::default() };
    let mut agent = spec.build(1, 4, 1, 1_000, 0).unwrap();
    let obs = vec![0.7; 4_000];
    let mut actions = vec![9; 4_000];
    agent.act(&obs, Mode::Explore, &mut actions).unwrap();
    for action in 0..4 {
        let n = actions.iter().filter(|&&a| a == action).count();
        // 1000 on average, standard deviation 27.
        assert!((850..1150).contains(&n), "{n}");
    }
    (0..1_000).for_each(|_| observe(&mut agent, 1));
    agent.act(&obs, Mode::Explore, &mut actions).unwrap();
    let (mut greedy, mut again) = ([9], [9]);
    agent.act(&obs[..1], Mode::Greedy, &mut greedy).unwrap();
    agent.act(&obs[..1], Mode::Greedy, &mut again).unwrap();
    assert_eq!(greedy, again);
    let n_random = actions.iter().filter(|&&a| a != greedy[0]).count();
    // 2 % random, of which three quarters differ: 60 on average, standard deviation 8.
    assert!((30..100).contains(&n_random), "{n_random}");
    assert!(agent.act(&obs[..3], Mode::Greedy, &mut actions).is_err());
    agent.act(&[], Mode::Greedy, &mut []).unwrap();
    assert!(agent.q_values(&[]).unwrap().is_empty());
}
