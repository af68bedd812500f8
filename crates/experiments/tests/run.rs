//! The binary end to end on small grids: what it leaves behind, that it leaves the same every time, and that it does
//! nothing twice.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// Two cells, one of which shares its run with none, in tiny trainings.
const SPEC: &str = r#"
name = "small"
seeds = { first = 3, count = 2 }

[train]
n_steps = 3_000
log_every = 1_000

[evaluate]
n_episodes = 12

[[axis]]
name = "agent"
[axis.levels]
DQN = { "agent.target" = "dqn" }
DDQN = { "agent.target" = "double_dqn" }
"#;

struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("spec.toml"), SPEC).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn experiments(&self, args: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
        command.current_dir(self.folder.path()).args(args).output().unwrap()
    }

    /// Runs it and expects success; what it printed.
    fn succeed(&self, args: &[&str]) -> String {
        let output = self.experiments(args);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{args:?}: {errors}");
        String::from_utf8(output.stdout).unwrap()
    }
}

/// Every file below a folder but those that hold times.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(path) = open.pop() {
        for entry in fs::read_dir(&path).unwrap().map(Result::unwrap) {
            if entry.file_type().unwrap().is_dir() {
                open.push(entry.path());
            } else if entry.file_name() != "timing.json" {
                let name = entry.path().strip_prefix(folder).unwrap().to_owned();
                files.insert(name, fs::read(entry.path()).unwrap());
            }
        }
    }
    files
}

#[test]
fn one_and_two_jobs_leave_the_same_bytes() {
    let bench = Bench::new();
    let table = bench.succeed(&["run", "spec.toml", "--out", "one", "--jobs", "1"]);
    let other = bench.succeed(&["run", "spec.toml", "--out", "two", "--jobs", "2"]);
    assert_eq!(table.replace("results in one", "results in two"), other);
    let (one, two) = (contents(&bench.path("one")), contents(&bench.path("two")));
    assert_eq!(one.keys().collect::<Vec<_>>(), two.keys().collect::<Vec<_>>());
    for kind in ["metrics.csv", "policy.safetensors", "episodes.csv", "spec.toml", "run.json"] {
        let n = one.keys().filter(|path| path.ends_with(kind)).count();
        assert!(n >= 4, "{n} files {kind}"); // 2 cells x 2 seeds
    }
    for (path, bytes) in &one {
        assert!(*bytes == two[path], "{} differs", path.display());
    }
    let weights: Vec<_> = one.iter().filter(|(path, _)| path.ends_with("policy.safetensors")).map(|(_, b)| b).collect();
    assert!(weights.windows(2).all(|pair| pair[0] != pair[1]), "seeds and target rules make a difference");
}

#[test]
fn a_second_call_does_only_what_is_missing() {
    let bench = Bench::new();
    let first = bench.succeed(&["run", "spec.toml", "--out", "out"]);
    let modified = |path: &Path| fs::metadata(path).unwrap().modified().unwrap();
    let policies: Vec<_> = contents(&bench.path("out"))
        .into_keys()
        .filter(|path| path.ends_with("policy.safetensors"))
        .map(|path| bench.path("out").join(path))
        .collect();
    let times: Vec<_> = policies.iter().map(|path| modified(path)).collect();
    assert_eq!(bench.succeed(&["run", "spec.toml", "--out", "out"]), first);
    // More episodes: evaluations anew, no training.
    bench.succeed(&["run", "spec.toml", "--out", "out", "--set", "evaluate.n_episodes=15"]);
    assert_eq!(policies.iter().map(|path| modified(path)).collect::<Vec<_>>(), times);
    // An interrupted run, one without its done-file, is made anew, with the same bytes.
    let before = contents(&bench.path("out"));
    fs::remove_file(policies[0].with_file_name("done")).unwrap();
    fs::write(&policies[0], "half a policy").unwrap();
    bench.succeed(&["run", "spec.toml", "--out", "out", "--set", "evaluate.n_episodes=15"]);
    let after = contents(&bench.path("out"));
    let relative = policies[0].strip_prefix(bench.path("out")).unwrap();
    assert_eq!(after[relative], before[relative]);
    assert_ne!(modified(&policies[0]), times[0]);
    assert_eq!(modified(&policies[1]), times[1]);
}

#[test]
fn a_saved_policy_is_evaluated_as_in_its_run() {
    let bench = Bench::new();
    bench.succeed(&["run", "spec.toml", "--out", "out", "--set", "seeds.count=1"]);
    let report: Value = serde_json::from_str(&bench.succeed(&["report", "out", "--format", "json"])).unwrap();
    let row = &report[0];
    assert_eq!(row["axes"], serde_json::json!({ "agent": "DQN" }));
    let index: Value = serde_json::from_slice(&fs::read(bench.path("out/index.json")).unwrap()).unwrap();
    let id = index["cells"][0]["runs"][0]["train_id"].as_str().unwrap();
    let policy = format!("out/runs/{id}/policy.safetensors");
    let args = ["evaluate", &policy, "--spec", "spec.toml", "--format", "json", "--plot", "drive.svg"];
    let evaluated: Value = serde_json::from_str(&bench.succeed(&args)).unwrap();
    for metric in ["success", "collision", "timeout", "mean_speed", "spl"] {
        assert_eq!(evaluated[0][metric]["mean"], row[metric]["mean"], "{metric}");
    }
    assert!(fs::read_to_string(bench.path("drive.svg")).unwrap().ends_with("</svg>\n"));
    let rates = ["success", "collision", "timeout"].map(|rate| evaluated[0][rate]["mean"].as_f64().unwrap());
    assert!((rates.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    // A few episodes, one world.
    let args = ["evaluate", &policy, "--spec", "spec.toml", "--episodes", "3", "--world", "25x25", "--seed", "8"];
    assert!(bench.succeed(&args).contains("25x25"));
}

#[test]
fn a_folder_that_cannot_be_written_is_refused() {
    let bench = Bench::new();
    fs::write(bench.path("taken"), "a file").unwrap();
    let output = bench.experiments(&["run", "spec.toml", "--out", "taken/results"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.starts_with("error: taken/results: cannot create the results folder: "), "{message}");
}

#[test]
fn a_policy_is_refused_by_another_robot_and_for_an_unknown_world() {
    let bench = Bench::new();
    bench.succeed(&["run", "spec.toml", "--out", "out", "--set", "seeds.count=1"]);
    let policy = contents(&bench.path("out")).into_keys().find(|path| path.ends_with("policy.safetensors")).unwrap();
    let policy = bench.path("out").join(policy);
    let refused = |args: &[&str]| {
        let start = ["evaluate", policy.to_str().unwrap(), "--spec", "spec.toml"];
        let output = bench.experiments(&[&start, args].concat());
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    assert_eq!(
        refused(&["--set", "lidar.n_beams=24"]),
        "error: this policy was made for another robot: lidar.n_beams is 36 in the policy, 24 here\n"
    );
    assert_eq!(refused(&["--world", "30x30"]), "error: --world 30x30: the spec's evaluation worlds are 10x15, 25x25\n");
    assert!(refused(&["--episodes", "5", "--plot", "x.svg", "--plot-episodes", "5"]).contains("there is no episode 5"));
}

#[test]
fn held_out_scenarios_are_none_of_the_training() {
    use headway_experiments::evaluate::ScenarioSet;
    use headway_experiments::spec::RunSpec;
    use headway_sim::{stream, stream_seed};
    let mut spec = RunSpec::default();
    spec.evaluate.seed = 0; // also a training seed
    let mdp = spec.evaluation(&spec.evaluate.worlds[0]).build().unwrap();
    let set = ScenarioSet::new(&mdp, 1, 0).unwrap();
    let mut starts = Vec::new();
    let mut driver = headway_planning::PurePursuit::default();
    set.drive(&mdp, &mut driver, 0, |vehicle| starts.push(vehicle.vehicle().pose)).unwrap();
    for k in 0..100 {
        let trained = mdp.source().sample(&mut stream(stream_seed(0, "train", 0), "layout", k)).unwrap();
        assert_ne!(trained.start, starts[0]);
    }
}
