//! Which of our crates may use which: docs/architecture.md, checked.

use std::collections::{BTreeMap, BTreeSet};

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package};

/// Each crate with the crates that it may use directly: those behind its arrows, and what lies behind them.
const ALLOWED: &[(&str, &[&str])] = &[
    ("headway-sim", &[]),
    ("headway-reward", &[]),
    ("headway-rl", &[]),
    ("headway-stats", &[]),
    ("headway-sensors", &["headway-sim"]),
    ("headway-planning", &["headway-sensors", "headway-sim"]),
    ("headway-env", &["headway-planning", "headway-reward", "headway-sensors", "headway-sim"]),
    ("headway-policy", &["headway-env", "headway-planning", "headway-reward", "headway-sensors", "headway-sim"]),
    (
        "headway-experiments",
        &[
            "headway-env",
            "headway-planning",
            "headway-policy",
            "headway-reward",
            "headway-rl",
            "headway-sensors",
            "headway-sim",
            "headway-stats",
        ],
    ),
];

fn metadata() -> Metadata {
    MetadataCommand::new().manifest_path(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")).exec().unwrap()
}

/// The names of what a package needs to be built and used; what its tests need is its own affair.
fn normal_dependencies(package: &Package) -> impl Iterator<Item = &str> {
    let normal = package.dependencies.iter().filter(|dependency| dependency.kind == DependencyKind::Normal);
    normal.map(|dependency| dependency.name.as_str())
}

#[test]
fn crates_use_only_what_lies_behind_them() {
    let allowed: BTreeMap<_, _> = ALLOWED.iter().copied().collect();
    let metadata = metadata();
    let ours = metadata.workspace_packages().into_iter().filter(|package| allowed.contains_key(package.name.as_str()));
    let wrong: Vec<_> = ours
        .flat_map(|package| {
            let may_use = allowed[package.name.as_str()];
            normal_dependencies(package)
                .filter(|name| allowed.contains_key(name) && !may_use.contains(name))
                .map(move |name| format!("{} -> {name}", package.name))
        })
        .collect();
    assert!(wrong.is_empty(), "not in the architecture's diagram: {}", wrong.join(", "));
}

#[test]
fn every_crate_has_a_place_in_the_diagram() {
    let known: BTreeSet<_> = ALLOWED.iter().map(|(name, _)| *name).collect();
    let metadata = metadata();
    let in_crates = metadata.workspace_packages().into_iter().filter(|package| {
        package.manifest_path.parent().and_then(|folder| folder.parent()).is_some_and(|p| p.ends_with("crates"))
    });
    let found: BTreeSet<_> = in_crates.map(|package| package.name.as_str()).collect();
    assert_eq!(found, known);
}

#[test]
fn a_library_of_rewards_needs_only_the_reward_crate_of_ours() {
    let metadata = metadata();
    let packages = metadata.workspace_packages();
    let package = packages.iter().find(|package| package.manifest_path.ends_with("reward-plugin/rewards/Cargo.toml"));
    let package = package.expect("examples/reward-plugin/rewards is in the workspace");
    let ours: Vec<_> = normal_dependencies(package).filter(|name| name.starts_with("headway-")).collect();
    assert_eq!(ours, ["headway-reward"]);
}

/// All that is built with a package, by name.
fn built_with(metadata: &Metadata, name: &str) -> BTreeSet<String> {
    let resolve = metadata.resolve.as_ref().unwrap();
    let names: BTreeMap<_, _> = metadata.packages.iter().map(|package| (&package.id, package.name.as_str())).collect();
    let start = metadata.packages.iter().find(|package| package.name == name).unwrap();
    let (mut found, mut open) = (BTreeSet::new(), vec![&start.id]);
    while let Some(id) = open.pop() {
        let node = resolve.nodes.iter().find(|node| node.id == *id).unwrap();
        for dependency in &node.deps {
            let is_normal = dependency.dep_kinds.iter().any(|info| info.kind == DependencyKind::Normal);
            if is_normal && found.insert(names[&dependency.pkg].to_owned()) {
                open.push(&dependency.pkg);
            }
        }
    }
    found
}

#[test]
fn what_drives_is_built_without_a_learning_library() {
    let metadata = metadata();
    for name in ["headway-env", "headway-policy", "headway-reward"] {
        let built = built_with(&metadata, name);
        let learning: Vec<_> = built.iter().filter(|name| name.starts_with("candle") || *name == "gemm").collect();
        assert!(learning.is_empty(), "{name} is built with {learning:?}");
    }
    let learner = built_with(&metadata, "headway-rl");
    assert!(learner.contains("candle-core"), "the walk finds nothing: {learner:?}");
}
