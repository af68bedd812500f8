//! Spec files: bases, axes, `when`s, assignments, and the cells they come to.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use headway_experiments::spec::{Assignment, EvaluateSpec, Grid, RunSpec, TrainSpec};
use proptest::prelude::*;
use tempfile::TempDir;
use toml::Value;

/// A folder with these files, and the path of the last one.
fn files(texts: &[(&str, &str)]) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let mut last = PathBuf::new();
    for (name, text) in texts {
        last = folder.path().join(name);
        fs::write(&last, text).unwrap();
    }
    (folder, last)
}

fn load(text: &str, sets: &[&str]) -> Grid {
    let (_folder, path) = files(&[("grid.toml", text)]);
    let sets: Vec<Assignment> = sets.iter().map(|set| set.parse().unwrap()).collect();
    Grid::load(&path, &sets).unwrap()
}

/// Every value of a spec on a line of its own.
fn lines(spec: &RunSpec) -> Vec<String> {
    fn visit(path: &str, value: &Value, lines: &mut Vec<String>) {
        let join = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        match value {
            Value::Table(table) => table.iter().for_each(|(key, value)| visit(&join(key), value, lines)),
            Value::Array(items) if items.iter().any(Value::is_table) => {
                let mut numbered = items.iter().enumerate();
                numbered.by_ref().for_each(|(index, item)| visit(&join(&index.to_string()), item, lines));
            }
            leaf => lines.push(format!("{path} = {leaf}")),
        }
    }
    let mut all = Vec::new();
    visit("", &Value::try_from(spec).unwrap(), &mut all);
    all
}

/// The cells of a grid: each label, and the values in which the cell differs from the defaults.
fn snapshot(grid: &Grid) -> String {
    let default = lines(&RunSpec::default());
    let mut text = String::new();
    for cell in &grid.cells {
        let _ = writeln!(text, "{}", cell.label());
        for line in lines(&cell.spec).iter().filter(|line| !default.contains(line)) {
            let _ = writeln!(text, "    {line}");
        }
    }
    text
}

const GRID: &str = r#"
name = "small"
seeds = { first = 3, count = 2 }

[reward]
type = "sum"
terms = [{ weight = 1.0, reward = { type = "r" } }, { weight = 0.0, reward = { type = "progress" } }]

[[axis]]
name = "reward"
[axis.levels]
R = { "reward.terms.0.reward" = { type = "r", reach = 200 } }
R_couple = { "reward.terms.0.reward" = { type = "r_couple" }, "reward.terms.0.reward.side" = 30 }

# Level names are in no alphabetical order: cells stand in the order of the file.
[[axis]]
name = "agent"
[axis.levels]
DQN = {}
DDQN = { "agent.target" = "double_dqn" }
DDQN_1 = { agent = { target = "double_dqn", n_step = 1 } }

[[when]]
match = { reward = "R_couple", agent = "DDQN" }
set = { "env.goal" = "new_goal", "reward.terms.1.weight" = 50.0 }
"#;

#[test]
fn cells_are_every_combination_in_the_order_of_the_file() {
    let expected = "\
reward=R agent=DQN
    reward.terms.0.reward.no_collision = 10.0
    reward.terms.0.reward.collision = -100.0
    reward.terms.0.reward.reach = 200.0
    reward.terms.1.weight = 0.0
reward=R agent=DDQN
    reward.terms.0.reward.no_collision = 10.0
    reward.terms.0.reward.collision = -100.0
    reward.terms.0.reward.reach = 200.0
    reward.terms.1.weight = 0.0
    agent.target = \"double_dqn\"
reward=R agent=DDQN_1
    reward.terms.0.reward.no_collision = 10.0
    reward.terms.0.reward.collision = -100.0
    reward.terms.0.reward.reach = 200.0
    reward.terms.1.weight = 0.0
    agent.target = \"double_dqn\"
    agent.n_step = 1
reward=R_couple agent=DQN
    reward.terms.0.reward.type = \"r_couple\"
    reward.terms.0.reward.desired_speed = 1.2
    reward.terms.0.reward.collision = -100.0
    reward.terms.0.reward.side = 30.0
    reward.terms.0.reward.front = 10.0
    reward.terms.0.reward.otherwise = 10.0
    reward.terms.0.reward.angle_threshold = 0.5235987755982989
    reward.terms.0.reward.speed_width = 2.0
    reward.terms.1.weight = 0.0
reward=R_couple agent=DDQN
    env.goal = \"new_goal\"
    reward.terms.0.reward.type = \"r_couple\"
    reward.terms.0.reward.desired_speed = 1.2
    reward.terms.0.reward.collision = -100.0
    reward.terms.0.reward.side = 30.0
    reward.terms.0.reward.front = 10.0
    reward.terms.0.reward.otherwise = 10.0
    reward.terms.0.reward.angle_threshold = 0.5235987755982989
    reward.terms.0.reward.speed_width = 2.0
    reward.terms.1.weight = 50.0
    agent.target = \"double_dqn\"
reward=R_couple agent=DDQN_1
    reward.terms.0.reward.type = \"r_couple\"
    reward.terms.0.reward.desired_speed = 1.2
    reward.terms.0.reward.collision = -100.0
    reward.terms.0.reward.side = 30.0
    reward.terms.0.reward.front = 10.0
    reward.terms.0.reward.otherwise = 10.0
    reward.terms.0.reward.angle_threshold = 0.5235987755982989
    reward.terms.0.reward.speed_width = 2.0
    reward.terms.1.weight = 0.0
    agent.target = \"double_dqn\"
    agent.n_step = 1
";
    let grid = load(GRID, &[]);
    assert_eq!(snapshot(&grid), expected);
    assert_eq!(grid.n_runs(), 12);
    let runs: Vec<_> = grid.runs().map(|(cell, seed)| (cell.label(), seed)).take(3).collect();
    assert_eq!(
        runs,
        [("reward=R agent=DQN".into(), 3), ("reward=R agent=DQN".into(), 4), ("reward=R agent=DDQN".into(), 3)]
    );
}

#[test]
fn assignments_come_last_and_reach_the_head() {
    let sets = ["seeds.count=1", "name=other", "agent.target=dqn", "reward.terms.1.weight=7", "train.n_steps=1_000"];
    let grid = load(GRID, &sets);
    assert_eq!((grid.name.as_str(), grid.n_runs()), ("other", 6));
    for cell in &grid.cells {
        let lines = lines(&cell.spec);
        for line in ["agent.target = \"dqn\"", "reward.terms.1.weight = 7.0", "train.n_steps = 1000"] {
            assert!(lines.contains(&line.to_owned()), "{}: no {line}", cell.label());
        }
    }
}

/// `--set reward.type=r` kept the keys of the old type and was refused for them, in a place far away.
#[test]
fn another_type_alone_drops_the_keys_of_the_old_one() {
    let grid = load(GRID, &["reward.type=r", "reward.reach=7", "agent.grad_clip={ type = 'norm', max = 1 }"]);
    for cell in &grid.cells {
        let lines = lines(&cell.spec);
        for line in ["reward.type = \"r\"", "reward.reach = 7.0", "reward.collision = -100.0"] {
            assert!(lines.contains(&line.to_owned()), "no {line} in {lines:?}");
        }
        assert!(!lines.iter().any(|line| line.starts_with("reward.terms")), "{lines:?}");
    }
    let grid = load("", &["agent.loss.type=mse", "world.type=room", "world.width=8"]);
    let lines = lines(&grid.cells[0].spec);
    assert!(
        lines.contains(&"agent.loss.type = \"mse\"".into()) && lines.contains(&"world.width = 8.0".into()),
        "{lines:?}"
    );
}

#[test]
fn a_file_without_axes_is_one_cell() {
    let grid = load("[agent]\ngamma = 0.9", &[]);
    assert_eq!((grid.name.as_str(), grid.cells.len(), grid.n_runs()), ("grid", 1, 1));
    assert_eq!(snapshot(&grid), "-\n    agent.gamma = 0.9\n");
}

#[test]
fn bases_merge_along_the_chain() {
    let (_folder, path) = files(&[
        ("root.toml", "name = 'root'\nseeds = { first = 5, count = 2 }\n[agent]\ngamma = 0.9\nn_step = 2"),
        ("middle.toml", "base = 'root.toml'\n[agent]\nn_step = 4\n[world]\ntype = 'room'\nwidth = 8"),
        (
            "leaf.toml",
            "base = 'middle.toml'\nseeds = { count = 4 }\n[agent]\ntarget = 'double_dqn'\n[world]\nheight = 9",
        ),
    ]);
    let grid = Grid::load(&path, &[]).unwrap();
    assert_eq!(grid.name, "leaf", "a base's name is its own");
    assert_eq!((grid.seeds.first, grid.seeds.count), (5, 4));
    let run = &grid.cells[0].spec;
    assert_eq!((run.agent.gamma, run.agent.n_step), (0.9, 4));
    let world = Value::try_from(&run.world).unwrap();
    assert_eq!((world["width"].as_float(), world["height"].as_float()), (Some(8.0), Some(9.0)));
}

#[test]
fn another_type_in_a_file_drops_the_keys_of_its_base() {
    let (_folder, path) = files(&[
        ("base.toml", "[reward]\ntype = 'r'\nreach = 5\n[world]\ntype = 'room'\nobstacles = { count = 3 }"),
        ("leaf.toml", "base = 'base.toml'\n[reward]\ntype = 'r_couple'\n[world]\nobstacles = { density = 0.05 }"),
    ]);
    let run = &Grid::load(&path, &[]).unwrap().cells[0].spec;
    assert!(format!("{:?}", run.reward).starts_with("RCouple"));
    assert_eq!(Value::try_from(&run.world).unwrap()["obstacles"].to_string(), "{ density = 0.05 }");
}

#[test]
fn a_base_is_looked_for_beside_the_file_that_names_it() {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("sub")).unwrap();
    fs::write(folder.path().join("base.toml"), "[agent]\ngamma = 0.5").unwrap();
    fs::write(folder.path().join("sub/leaf.toml"), "base = '../base.toml'").unwrap();
    let grid = Grid::load(&folder.path().join("sub/leaf.toml"), &[]).unwrap();
    assert_eq!(grid.cells[0].spec.agent.gamma, 0.5);
}

/// A file of the repository's `specs/`.
fn shipped(name: &str) -> Grid {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs").join(name);
    Grid::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn default_toml_holds_every_key_with_its_default() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/default.toml");
    let mut written: toml::Table = fs::read_to_string(path).unwrap().parse().unwrap();
    let head = (written.remove("name"), written.remove("seeds"));
    assert!(head.0.is_some() && head.1.is_some());
    assert_eq!(Value::Table(written), Value::try_from(RunSpec::default()).unwrap());
}

#[test]
fn shipped_grids_have_the_cells_they_promise() {
    assert_eq!(shipped("default.toml").n_runs(), 5);
    let quick: Vec<_> = shipped("quick.toml").cells.iter().map(headway_experiments::spec::Cell::label).collect();
    assert_eq!(quick, ["arm=R agent=DDQN", "arm=R_couple agent=DDQN", "arm=recommended agent=DDQN"]);
    assert_eq!(shipped("table1.toml").n_runs(), 4 * 3 * 2 * 20);
}

#[test]
fn table1_holds_the_readings() {
    let grid = shipped("table1.toml");
    let of = |reading: &str, reward: &str| {
        let label = format!("reading={reading} reward={reward} agent=DDQN");
        Value::try_from(&grid.cells.iter().find(|cell| cell.label() == label).unwrap().spec).unwrap()
    };
    // (reading, reward) -> goal, control, n-step, weight and type of the shaping
    for (reading, reward, expected) in [
        ("P", "R", ("terminate", "full", 3, 0.0, "progress")),
        ("P", "R_couple", ("terminate", "full", 3, 0.0, "progress")),
        ("T", "R", ("new_goal", "full", 1, 5.0, "heading")),
        ("T", "R_couple", ("new_goal", "full", 1, 5.0, "heading")),
        ("H", "R", ("terminate", "speed_only", 1, 0.0, "progress")),
        ("H", "R_couple", ("new_goal", "speed_only", 1, 0.0, "progress")),
        ("N", "R", ("new_goal", "full", 3, 50.0, "progress")),
        ("N", "R_couple", ("new_goal", "full", 3, 50.0, "progress")),
    ] {
        let spec = of(reading, reward);
        let shaping = &spec["reward"]["terms"][1];
        let found = (
            spec["env"]["goal"].as_str().unwrap(),
            spec["env"]["control"]["type"].as_str().unwrap(),
            spec["agent"]["n_step"].as_integer().unwrap(),
            shaping["weight"].as_float().unwrap(),
            shaping["reward"]["type"].as_str().unwrap(),
        );
        assert_eq!(found, expected, "{reading} {reward}");
        let paid = spec["reward"]["terms"][0]["reward"]["type"].as_str().unwrap();
        assert_eq!(paid, if reward == "R" { "r" } else { "r_couple" });
        assert_eq!(spec["agent"]["target"].as_str(), Some("double_dqn"));
        assert_eq!(spec["world"]["type"].as_str(), Some("room_10x15"));
    }
}

prop_compose! {
    fn any_run()(
        gamma in 0.0..=1.0f64,
        n_step in 1usize..100,
        rates in prop::collection::vec(-1.5..1.5f64, 1..6),
        weights in prop::collection::vec((-1e3..1e3f64, 0usize..4), 0..5),
        n_steps in 1u64..i64::MAX as u64,
        n_envs in 1usize..1000,
        log_every in 1u64..1_000_000,
        n_episodes in 1usize..1_000_000,
        seed in 0u64..i64::MAX as u64,
    ) -> RunSpec {
        let reward = weights.iter().fold(headway_reward::Sum::default(), |sum, (weight, kind)| match kind {
            0 => sum.with(*weight, headway_reward::R::default()),
            1 => sum.with(*weight, headway_reward::RCouple::default()),
            2 => sum.with(*weight, headway_reward::Proximity { margin: weight.abs() }),
            _ => sum.with(*weight, headway_reward::Sum::default().with(1.0, headway_reward::Time {})),
        });
        let default = RunSpec::default();
        RunSpec {
            reward: std::sync::Arc::new(reward),
            agent: headway_rl::DqnSpec { gamma, n_step, ..default.agent },
            env: headway_env::EnvSpec {
                actions: headway_env::ActionSpec::Accelerate { yaw_rates: rates },
                ..default.env
            },
            train: TrainSpec { n_steps, n_envs, log_every, curriculum: vec![] },
            evaluate: EvaluateSpec { n_episodes, seed, ..default.evaluate },
            ..RunSpec::default()
        }
    }
}

proptest! {
    #[test]
    fn a_spec_survives_toml(run in any_run()) {
        let text = toml::to_string(&run).unwrap();
        let again: RunSpec = toml::from_str(&text).unwrap();
        prop_assert_eq!(toml::to_string(&again).unwrap(), text);
        prop_assert_eq!(lines(&again), lines(&run));
    }
}
