//! The rewards of the example's spec load and keep their promises; it costs no training to know.

use headway_reward::{Reward, Sum, testing};
use serde::Deserialize;
use smooth_rewards as _;
use std::collections::BTreeMap;

#[derive(Deserialize)]
struct Spec {
    axis: Vec<Axis>,
}

#[derive(Deserialize)]
struct Axis {
    levels: BTreeMap<String, Level>,
}

#[derive(Deserialize)]
struct Level {
    reward: toml::Table,
}

/// The one axis of `spec.toml`: each level's reward by the level's name.
fn levels() -> BTreeMap<String, toml::Table> {
    let spec: Spec = toml::from_str(include_str!("../../spec.toml")).unwrap();
    let [axis] = <[Axis; 1]>::try_from(spec.axis).ok().expect("one axis");
    axis.levels.into_iter().map(|(name, level)| (name, level.reward)).collect()
}

#[test]
fn every_level_is_a_good_reward() {
    for (name, table) in levels() {
        let reward: Box<dyn Reward> = table.try_into().unwrap();
        assert_eq!(testing::check(&*reward), Ok(()), "{name}");
    }
}

#[test]
fn the_levels_differ_by_the_plugin_s_term_only() {
    let terms = |name: &str| levels()[name]["terms"].as_array().unwrap().clone();
    let mut smooth = terms("smooth");
    let added = smooth.pop().unwrap();
    assert_eq!(smooth, terms("recommended"));
    assert_eq!(added["reward"]["type"].as_str(), Some("smooth/needless_braking"));
    assert!(added["weight"].as_float().unwrap() < 0.0, "a penalty");
}

#[test]
fn the_registry_lists_the_plugin_among_the_others() {
    let tags: Vec<_> = headway_reward::registry().unwrap().iter().map(|entry| entry.tag).collect();
    assert!(tags.contains(&"smooth/needless_braking"));
    assert!(tags.contains(&"r_couple"));
    assert_eq!(Sum::default().with(1.0, smooth_rewards::NeedlessBraking::default()).version(), 1);
}
