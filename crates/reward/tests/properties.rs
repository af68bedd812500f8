//! What holds for any transition whatever.

use headway_reward::{Event, Heading, Limits, Progress, Proximity, R, RCouple, Reward, State, Sum, Time, Transition};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

fn rewards() -> Vec<Arc<dyn Reward>> {
    let sum = Sum::default()
        .with(1.0, RCouple::default())
        .with(50.0, Progress { speed_cap: Some(1.2) })
        .with(-5.0, Proximity::default());
    vec![
        Arc::new(R::default()),
        Arc::new(RCouple::default()),
        Arc::new(Progress::default()),
        Arc::new(Heading {}),
        Arc::new(Time {}),
        Arc::new(Proximity::default()),
        Arc::new(sum),
    ]
}

prop_compose! {
    fn states()(
        speed in -3.0..30.0,
        yaw_rate in -6.0..6.0,
        goal_distance in 0.0..1000.0,
        goal_bearing in -PI..PI,
        clearance in -1.0..100.0,
        obstacle_angle in prop::option::of(0.0..=PI),
    ) -> State<'static> {
        State { speed, yaw_rate, goal_distance, goal_bearing, clearance, obstacle_angle, scan: &[], beam_angles: &[] }
    }
}

prop_compose! {
    fn transitions()(
        before in states(),
        after in states(),
        command_speed in -3.0..30.0,
        command_yaw_rate in -6.0..6.0,
        dt in 0.001..2.0,
        event in prop_oneof![Just(None), Just(Some(Event::Collision)), Just(Some(Event::Reach))],
    ) -> Transition<'static> {
        Transition { before, after, command_speed, command_yaw_rate, dt, event, limits: Limits::default() }
    }
}

/// The same step in a mirror: left is right.
fn mirrored(t: &Transition<'static>) -> Transition<'static> {
    let mirror = |s: State<'static>| State { yaw_rate: -s.yaw_rate, goal_bearing: -s.goal_bearing, ..s };
    Transition { before: mirror(t.before), after: mirror(t.after), command_yaw_rate: -t.command_yaw_rate, ..*t }
}

proptest! {
    #[test]
    fn rewards_are_finite(t in transitions()) {
        for reward in rewards() {
            prop_assert!(reward.reward(&t).is_finite(), "{reward:?}");
        }
    }

    #[test]
    fn rewards_do_not_prefer_a_side(t in transitions()) {
        for reward in rewards() {
            prop_assert_eq!(reward.reward(&t), reward.reward(&mirrored(&t)), "{:?}", reward);
        }
    }

    #[test]
    fn r_sees_only_the_event(t in transitions()) {
        let bare = Transition { event: t.event, ..Transition::default() };
        prop_assert_eq!(R::default().reward(&t), R::default().reward(&bare));
    }

    #[test]
    fn r_couple_sees_only_hit_speed_and_angle(t in transitions()) {
        let after = State { speed: t.after.speed, obstacle_angle: t.after.obstacle_angle, ..State::default() };
        let bare = Transition { after, event: t.event, ..Transition::default() };
        prop_assert_eq!(RCouple::default().reward(&t), RCouple::default().reward(&bare));
    }

    #[test]
    fn r_couple_stays_between_its_branches(t in transitions()) {
        let paid = RCouple::default().reward(&t);
        prop_assert!(paid == -100.0 || (10.0..=40.0).contains(&paid), "{paid}");
        prop_assert_eq!(paid == -100.0, t.event == Some(Event::Collision));
    }

    /// Progress adds up: a way in two steps earns what it earns in one, wherever the goal is.
    #[test]
    fn progress_depends_on_the_ends_of_the_way_only(a in 0.0..100.0, b in 0.0..100.0, c in 0.0..100.0, shift in 0.0..50.0) {
        let pay = |before: f64, after: f64| {
            let at = |goal_distance| State { goal_distance, ..State::default() };
            Progress::default().reward(&Transition { before: at(before), after: at(after), ..Transition::default() })
        };
        prop_assert!((pay(a, b) + pay(b, c) - pay(a, c)).abs() < 1e-9);
        prop_assert!((pay(a + shift, b + shift) - pay(a, b)).abs() < 1e-9);
    }

    #[test]
    fn proximity_grows_as_clearance_falls(t in transitions(), nearer in 0.0..1.0) {
        let close = Transition { after: State { clearance: t.after.clearance - nearer, ..t.after }, ..t };
        prop_assert!(Proximity::default().reward(&close) >= Proximity::default().reward(&t));
    }

    #[test]
    fn a_sum_is_linear(t in transitions(), w in -100.0..100.0) {
        let sum = Sum::default().with(w, RCouple::default()).with(1.0, Heading {});
        let expected = w * RCouple::default().reward(&t) + Heading {}.reward(&t);
        prop_assert_eq!(sum.reward(&t), expected);
    }
}
