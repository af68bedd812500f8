//! Runs that train nothing: classical drivers and policy files in a grid.

use super::*;

/// A grid in which one level learns and the others do not.
const WHO: &str = r#"
name = "who"
seeds = { first = 3, count = 2 }
[train]
n_steps = 3_000
[evaluate]
n_episodes = 6
[[evaluate.worlds]]
name = "small"
time_limit = 30.0
world = { type = "room_10x15" }
[[axis]]
name = "who"
[axis.levels]
learned = {}
pursuit = { policy = { type = "pure_pursuit", desired_linear_vel = 0.6 }, "env.route.type" = "true_map" }
vfh = { "policy.type" = "vfh", "evaluate.shield" = { margin = 0.3 } }
"#;

#[test]
fn who_is_not_trained_is_evaluated_beside_who_is() {
    let bench = Bench::of(WHO);
    let check = bench.succeed(&["check", "spec.toml"]);
    assert!(check.contains("runs         4 = "), "{check}"); // two seeds, and one run each
    let table = bench.succeed(&["run", "spec.toml", "--out", "out"]);
    assert!(table.contains("pursuit") && table.contains("vfh"), "{table}");
    let rows = bench.json(&["report", "out", "--format", "json"]);
    let of = |row: usize, key: &str| rows[row][key].as_u64().unwrap();
    assert_eq!([0, 1, 2].map(|row| (of(row, "seeds"), of(row, "episodes"))), [(2, 12), (1, 6), (1, 6)]);
    assert_eq!(rows[1]["success"]["mean"], 1.0);
    // Only one of them has a shield, which stepped in now and then.
    assert!(rows[0]["vetoes"]["mean"].is_null() && rows[1]["stops"]["mean"].is_null(), "{rows}");
    let (vetoes, stops) = (rows[2]["vetoes"]["mean"].as_f64().unwrap(), rows[2]["stops"]["mean"].as_f64().unwrap());
    assert!(0.0 < vetoes && vetoes < 0.5 && (0.0..=vetoes).contains(&stops), "{vetoes} {stops}");
    let run = bench.run("out", 1, 0);
    assert!(bench.path(&run).join("done").is_file() && !bench.path(&run).join("policy.safetensors").exists());
    let runs = bench.succeed(&["report", "out", "--runs"]);
    assert_eq!(runs.matches("none trained").count(), 2, "{runs}");
    // Neither other seeds nor another learner make it another run, but its own numbers do.
    let notes = bench.notes(&["run", "spec.toml", "--out", "out"]);
    assert!(notes.contains("nothing to do"), "{notes}");
    let only = |set: &[&str]| {
        let args = ["run", "spec.toml", "--out", "other", "--set", "seeds.count=1", "--set", "seeds.first=9"];
        bench.succeed(&[&args[..], set].concat());
        let id = bench.run("other", 1, 0);
        fs::remove_dir_all(bench.path("other")).unwrap();
        id.rsplit('/').next().unwrap().to_owned()
    };
    let id = run.rsplit('/').next().unwrap();
    assert_eq!(only(&["--set", "agent.gamma=0.9"]), id);
    assert_ne!(only(&["--set", "lidar.noise=0.01"]), id);
    // The shield is part of the evaluation's name.
    let folder = bench.path(&bench.run("out", 2, 0)).join("evaluations");
    let evaluation = fs::read_dir(folder).unwrap().next().unwrap().unwrap().path();
    let spec = fs::read_to_string(evaluation.join("spec.toml")).unwrap();
    assert!(spec.contains("[shield]") && spec.contains("margin = 0.3"), "{spec}");
}

#[test]
fn a_policy_from_a_file_and_worlds_from_files_are_known_by_their_bytes() {
    let bench = Bench::of(WHO);
    bench.succeed(&["run", "spec.toml", "--out", "made", "--set", "seeds.count=1"]);
    let policy = bench.path(&bench.run("made", 0, 0)).join("policy.safetensors");
    fs::copy(&policy, bench.path("policy.safetensors")).unwrap();
    let world = |x: f64| {
        let sdf = format!(
            "<sdf version='1.6'><world name='yard'><model name='m'><pose>{x} 3 0 0 0 0</pose><link name='l'>\
             <collision name='c'><geometry><cylinder><radius>0.4</radius><length>3</length></cylinder></geometry>\
             </collision></link></model></world></sdf>"
        );
        fs::write(bench.path("yard.world"), sdf).unwrap();
    };
    world(2.0);
    let spec = r#"
name = "files"
policy = { type = "file", path = "policy.safetensors" }
[evaluate]
n_episodes = 4
[[evaluate.worlds]]
name = "yard"
time_limit = 30.0
world = { type = "files", paths = ["yard.world"] }
"#;
    fs::write(bench.path("files.toml"), spec).unwrap();
    let ids = |out: &str| {
        bench.succeed(&["run", "files.toml", "--out", out]);
        let index: Value = serde_json::from_slice(&fs::read(bench.path(out).join("index.json")).unwrap()).unwrap();
        let cell = &index["cells"][0];
        [&cell["runs"][0]["train_id"], &cell["evaluations"][0]["eval_id"]].map(|id| id.as_str().unwrap().to_owned())
    };
    let first = ids("a");
    assert_eq!(first, ids("b"));
    world(2.5);
    let moved = ids("c");
    assert_eq!((&moved[0], moved[1] == first[1]), (&first[0], false), "the world's file is another one");
    bench.fail(&["run", "files.toml", "--out", "a"], 2);
    fs::write(bench.path("policy.safetensors"), "no policy").unwrap();
    let errors = bench.fail(&["check", "files.toml"], 2);
    assert!(errors.contains("files.toml:3: policy.path"), "{errors}");
}
