//! The reward of Headway's docs/plugins.md.

use headway_reward::{Reward, State, Transition, testing};
use smooth_rewards::Overspeed;

#[test]
fn keeps_every_promise_of_a_reward() {
    assert_eq!(testing::check(&Overspeed::default()), Ok(()));
}

#[test]
fn pays_the_excess() {
    let after = State { speed: 1.5, ..State::default() };
    let step = Transition { after, ..Transition::default() };
    assert!((Overspeed::default().reward(&step) - 0.3).abs() < 1e-12);
}
