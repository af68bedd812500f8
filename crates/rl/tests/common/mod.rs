//! A tiny MDP with a known solution, and the loop that trains on it.
#![allow(dead_code, unreachable_pub, reason = "each test file uses its own part")]

use headway_rl::{Agent, Mode, StepBatch};

pub const N_STATES: usize = 5;
pub const N_ACTIONS: usize = 2;
pub const GAMMA: f64 = 0.9;
/// Env steps after which an episode is cut off.
const TIME_LIMIT: usize = 12;

/// A corridor of five cells. Action 1 goes right at a cost of 0.05, and past the last cell lies the goal, which pays 1
/// and ends the episode. Action 0 goes left for nothing, and in the leftmost cell pays 0.08 for staying, for ever: a
/// lure for agents that are short-sighted, or that take a time limit for an end.
#[derive(Clone)]
pub struct Corridor {
    cell: usize,
    start: usize,
    age: usize,
}

/// What a step led to.
pub struct Outcome {
    pub cell: usize,
    pub reward: f64,
    pub terminated: bool,
}

/// The MDP itself: deterministic, so that its values have no sampling error.
pub fn outcome(cell: usize, action: u32) -> Outcome {
    match (cell, action) {
        (0, 0) => Outcome { cell: 0, reward: 0.08, terminated: false },
        (_, 0) => Outcome { cell: cell - 1, reward: 0.0, terminated: false },
        (cell, _) if cell == N_STATES - 1 => Outcome { cell, reward: 1.0, terminated: true },
        (cell, _) => Outcome { cell: cell + 1, reward: -0.05, terminated: false },
    }
}

/// Q* by value iteration: `[N_STATES][N_ACTIONS]`.
pub fn value_iteration() -> [[f64; N_ACTIONS]; N_STATES] {
    let mut q = [[0.0f64; N_ACTIONS]; N_STATES];
    for _ in 0..500 {
        let value = q.map(|q| q[0].max(q[1]));
        for (cell, q) in q.iter_mut().enumerate() {
            for (action, q) in q.iter_mut().enumerate() {
                let next = outcome(cell, action as u32);
                *q = next.reward + if next.terminated { 0.0 } else { GAMMA * value[next.cell] };
            }
        }
    }
    q
}

/// The greedy action in every cell.
pub fn policy(q: &[[f64; N_ACTIONS]; N_STATES]) -> [usize; N_STATES] {
    q.map(|q| usize::from(q[1] > q[0]))
}

/// Corridors in lock-step, each started from all cells in turn.
#[derive(Clone)]
pub struct Corridors(Vec<Corridor>);

impl Corridors {
    pub fn new(n: usize) -> Self {
        Self((0..n).map(|i| Corridor { cell: i % N_STATES, start: i % N_STATES, age: 0 }).collect())
    }

    /// One-hot observations, `[n, N_STATES]`.
    pub fn obs(&self) -> Vec<f32> {
        self.0.iter().flat_map(|corridor| one_hot(corridor.cell)).collect()
    }

    /// Acts, steps every corridor, and observes, then updates until nothing is due.
    pub fn step(&mut self, agent: &mut dyn Agent) {
        let obs = self.obs();
        let n = self.0.len();
        let mut actions = vec![0; n];
        agent.act(&obs, Mode::Explore, &mut actions).unwrap();
        let (mut rewards, mut next_obs) = (Vec::new(), Vec::new());
        let (mut terminated, mut truncated) = (Vec::new(), Vec::new());
        for (corridor, &action) in self.0.iter_mut().zip(&actions) {
            let next = outcome(corridor.cell, action);
            corridor.age += 1;
            rewards.push(next.reward as f32);
            next_obs.extend(one_hot(next.cell));
            terminated.push(next.terminated);
            truncated.push(!next.terminated && corridor.age == TIME_LIMIT);
            corridor.cell = next.cell;
            if next.terminated || corridor.age == TIME_LIMIT {
                let start = (corridor.start + 1) % N_STATES;
                *corridor = Corridor { cell: start, start, age: 0 };
            }
        }
        agent
            .observe(StepBatch {
                obs: &obs,
                actions: &actions,
                rewards: &rewards,
                next_obs: &next_obs,
                terminated: &terminated,
                truncated: &truncated,
            })
            .unwrap();
        while agent.update().unwrap().is_some() {}
    }
}

/// An observation of one cell.
pub fn one_hot(cell: usize) -> [f32; N_STATES] {
    std::array::from_fn(|i| f32::from(u8::from(i == cell)))
}
