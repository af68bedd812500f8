//! Time to pay for one step: R_couple, and the recommended sum of four terms.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use headway_reward::{Progress, Proximity, R, RCouple, Reward, State, Sum, Time, Transition};

fn pay(c: &mut Criterion) {
    let after =
        State { speed: 1.0, goal_distance: 4.75, clearance: 0.1, obstacle_angle: Some(0.4), ..State::default() };
    let step = Transition { after, ..Transition::default() };
    let sum = Sum::default()
        .with(1.0, R { no_collision: 0.0, collision: -50.0, ..R::default() })
        .with(40.0, Progress::default())
        .with(-2.5, Time::default())
        .with(-5.0, Proximity::default());
    let rewards: [(&str, Box<dyn Reward>); 2] =
        [("r_couple", Box::new(RCouple::default())), ("sum_of_4", Box::new(sum))];
    for (name, reward) in rewards {
        c.bench_function(&format!("reward/{name}"), |b| b.iter(|| reward.reward(black_box(&step))));
    }
}

criterion_group!(benches, pay);
criterion_main!(benches);
