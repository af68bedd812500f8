//! Rewards in specs, that is, in TOML.

use headway_reward::{Limits, Progress, Proximity, R, RCouple, Reward, Sum, Term, Time, testing};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// As a run's spec holds its reward.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Spec {
    reward: Arc<dyn Reward>,
}

fn parse(text: &str) -> Result<Arc<dyn Reward>, String> {
    toml::from_str(text).map(|spec: Spec| spec.reward).map_err(|error| error.to_string())
}

fn error(text: &str) -> String {
    parse(text).unwrap_err()
}

/// A reward of every field unlike its default.
fn unusual() -> Sum {
    let couple = RCouple {
        desired_speed: 0.7,
        collision: -1.5,
        side: 3.25,
        front: 4.125,
        otherwise: 5.5,
        angle_threshold: 0.75,
        speed_width: 0.3,
    };
    let plain = R { no_collision: 0.1, collision: -0.2, reach: 0.3 };
    let inner = Sum::default()
        .with(40.0, Progress { speed_cap: Some(1.2) })
        .with(-2.5, Time {})
        .with(-5.0, Proximity { margin: 0.35 });
    Sum::default().with(0.5, couple).with(2.0, plain).with(1.0, inner)
}

#[test]
fn a_nested_sum_survives_toml() {
    let reward: Arc<dyn Reward> = Arc::new(unusual());
    let text = toml::to_string(&Spec { reward: reward.clone() }).unwrap();
    let copy = parse(&text).unwrap();
    for t in testing::transitions() {
        assert_eq!(reward.reward(&t), copy.reward(&t));
    }
    assert_eq!(toml::to_string(&Spec { reward: copy }).unwrap(), text);
}

#[test]
fn unusual_fields_pass_the_checks() {
    assert_eq!(testing::check(&unusual()), Ok(()));
}

#[test]
fn fields_left_out_take_their_defaults() {
    let reward = parse("[reward]\ntype = \"r_couple\"\nside = 7.0\n").unwrap();
    let expected = RCouple { side: 7.0, ..RCouple::default() };
    for t in testing::transitions() {
        assert_eq!(reward.reward(&t), expected.reward(&t));
    }
}

#[test]
fn whole_numbers_need_no_point() {
    let reward = parse("reward = { type = \"sum\", terms = [{ weight = 2, reward = { type = \"r\" } }] }").unwrap();
    assert_eq!(reward.reward(&headway_reward::Transition::default()), 20.0);
}

#[test]
fn the_type_may_stand_anywhere() {
    let reward = parse("[reward]\nmargin = 0.4\ntype = \"proximity\"\n").unwrap();
    assert_eq!(format!("{reward:?}"), "Proximity { margin: 0.4 }");
}

#[test]
fn a_misspelt_field_is_an_error_that_names_it() {
    for (tag, fields) in [
        ("r", "`no_collision`, `collision`, `reach`"),
        ("r_couple", "`desired_speed`"),
        ("progress", "`speed_cap`"),
        ("heading", "there are no fields"),
        ("time", "there are no fields"),
        ("proximity", "`margin`"),
        ("sum", "`terms`"),
    ] {
        let message = error(&format!("[reward]\ntype = \"{tag}\"\nmisspelt = 1.0\n"));
        assert!(message.contains("unknown field `misspelt`"), "{tag}: {message}");
        assert!(message.contains(fields), "{tag}: {message}");
    }
}

#[test]
fn a_misspelt_field_of_a_term_is_an_error_that_names_it() {
    let term = |term: &str| error(&format!("reward = {{ type = \"sum\", terms = [{term}] }}"));
    let message = term("{ weigth = 1.0, reward = { type = \"r\" } }");
    assert!(message.contains("unknown field `weigth`"), "{message}");
    let message = term("{ weight = 1.0, reward = { type = \"progress\", cap = 1.0 } }");
    assert!(message.contains("unknown field `cap`"), "{message}");
    let message = term("{ reward = { type = \"r\" } }");
    assert!(message.contains("missing field `weight`"), "{message}");
}

#[test]
fn a_reward_needs_a_known_type() {
    assert!(error("reward = {}").contains("missing field `type`"));
    let message = error("reward = { type = \"R\" }");
    assert!(message.contains("unknown variant `R`"), "{message}");
    assert!(message.contains("`r_couple`"), "{message}");
}

#[test]
fn a_version_is_1_and_a_sum_adds_up() {
    assert_eq!(parse("reward = { type = \"r\" }").unwrap().version(), 1);
    assert_eq!(unusual().version(), 5);
    let twice = Term { weight: 1.0, reward: Arc::new(unusual()) };
    let sum = Sum { terms: vec![twice.clone(), twice] };
    assert_eq!(sum.version(), 10);
}

#[test]
fn limits_survive_toml_and_refuse_gaps() {
    let text = toml::to_string(&Limits::default()).unwrap();
    assert_eq!(toml::from_str::<Limits>(&text).unwrap(), Limits::default());
    let message = toml::from_str::<Limits>("max_speed = 1.0").unwrap_err().to_string();
    assert!(message.contains("missing field `max_yaw_rate`"), "{message}");
}
