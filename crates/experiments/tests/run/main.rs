//! The binary end to end on small grids: what it leaves behind, that it leaves the same every time, and that it does
//! nothing twice.

mod drivers;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};

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
        Self::of(SPEC)
    }

    fn of(spec: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("spec.toml"), spec).unwrap();
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

    /// Runs it and expects this exit code; what it said on the standard error stream.
    fn fail(&self, args: &[&str], exit_code: i32) -> String {
        let output = self.experiments(args);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(exit_code), "{args:?}: {errors}");
        errors
    }

    /// Runs it and expects success; what it said on the standard error stream.
    fn notes(&self, args: &[&str]) -> String {
        self.fail(args, 0)
    }

    fn json(&self, args: &[&str]) -> Value {
        serde_json::from_str(&self.succeed(args)).unwrap()
    }

    /// The folder of a run, relative to the bench.
    fn run(&self, out: &str, cell: usize, seed: usize) -> String {
        let index: Value = serde_json::from_slice(&fs::read(self.path(out).join("index.json")).unwrap()).unwrap();
        format!("{out}/runs/{}", index["cells"][cell]["runs"][seed]["train_id"].as_str().unwrap())
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
    assert_eq!(table.replace("in one", "in two").replace("report one", "report two"), other);
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
    let policy = bench.run("out", 0, 0) + "/policy.safetensors";
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
    assert_eq!(
        refused(&["--world", "30x30"]),
        "error: --world 30x30: no such world. The spec's evaluation worlds are 10x15, 25x25\n"
    );
    assert!(refused(&["--episodes", "5", "--plot", "x.svg", "--plot-episodes", "5"]).contains("there is no episode 5"));
}

#[test]
fn held_out_scenarios_are_none_of_the_training() {
    use headway_experiments::evaluate::ScenarioSet;
    use headway_experiments::spec::RunSpec;
    use headway_sim::stream_seed;
    let mut spec = RunSpec::default();
    spec.evaluate.seed = 0; // also a training seed
    let mdp = spec.evaluation(&spec.evaluate.worlds[0]).build().unwrap();
    let set = ScenarioSet::new(&mdp, 1, 0).unwrap();
    let mut starts = Vec::new();
    let mut driver = headway_planning::PurePursuit::default();
    set.drive(&mdp, &mut driver, 0, |vehicle| starts.push(vehicle.vehicle().pose)).unwrap();
    for k in 0..100 {
        let trained = mdp.source().scenario(stream_seed(0, "train", 0), k).unwrap();
        assert_ne!(trained.start, starts[0]);
    }
}

/// Short runs of two cells that train alike and count another distance as reaching the goal.
const REACH: &str = r#"
name = "reach"
seeds = { first = 0, count = 1 }
train = { n_steps = 640 }

[evaluate]
n_episodes = 12
[[evaluate.worlds]]
name = "small"
time_limit = 20.0
world = { type = "room_10x15" }

[[axis]]
name = "reach"
[axis.levels]
near = { "env.reach_radius" = 0.3 }
far = { "env.reach_radius" = 3.0 }
"#;

/// `evaluate` took the first cell whose robot matched: another cell's goals, worlds and limits.
#[test]
fn a_policy_is_evaluated_as_its_own_cell_says() {
    let bench = Bench::of(REACH);
    bench.succeed(&["run", "spec.toml", "--out", "out"]);
    let report = bench.json(&["report", "out", "--format", "json"]);
    for (cell, name) in ["near", "far"].iter().enumerate() {
        let policy = bench.run("out", cell, 0) + "/policy.safetensors";
        let evaluated = bench.json(&["evaluate", &policy, "--spec", "spec.toml", "--format", "json"]);
        for metric in ["success", "collision", "mean_speed", "spl"] {
            assert_eq!(evaluated[0][metric]["mean"], report[cell][metric]["mean"], "{name}: {metric}");
        }
        let table = bench.succeed(&["evaluate", &policy, "--spec", "spec.toml"]);
        assert!(table.ends_with(&format!("in the worlds of the cell reach={name}\n")), "{table}");
    }
}

#[test]
fn cells_that_differ_in_how_they_evaluate_must_be_chosen_from() {
    let bench = Bench::of(REACH);
    bench.succeed(&["run", "spec.toml", "--out", "out"]);
    let policy = bench.run("out", 1, 0) + "/policy.safetensors";
    // The run of neither cell: nothing says which one is meant.
    let other = ["evaluate", &policy, "--spec", "spec.toml", "--set", "agent.gamma=0.9"];
    assert_eq!(
        bench.fail(&other, 2),
        "error: 2 cells of the spec fit this policy and differ in how they evaluate; choose one:\n  \
         --cell reach=near\n  --cell reach=far    unlike the first: env.reach_radius is 0.3 there, 3.0 here\n"
    );
    let with = |cell: &str| bench.json(&[&other[..], &["--format", "json", "--cell", cell]].concat());
    let report = bench.json(&["report", "out", "--format", "json"]);
    assert_eq!(with("reach=far")[0]["spl"]["mean"], report[1]["spl"]["mean"]);
    assert_ne!(with("reach=near")[0]["spl"]["mean"], report[1]["spl"]["mean"]);
    let compared = bench.json(&["compare", "out", "--over", "reach", "--format", "json"]);
    let (near, far) = (&report[0]["mean_speed"]["mean"], &report[1]["mean_speed"]["mean"]);
    let faster = &compared["contrasts"][0]["mean_speed"]["difference"]["mean"];
    assert_eq!(compared["settings"][0]["in_all_cells"], json!(["env.reach_radius"]));
    assert!((faster.as_f64().unwrap() - (far.as_f64().unwrap() - near.as_f64().unwrap())).abs() < 1e-12);
    assert_eq!(
        bench.fail(&["compare", "out", "--over", "rech"], 2),
        "error: no axis `rech` to compare over: must be one of reach, world\n"
    );
    // What does not differ need not be chosen.
    bench.succeed(&[&other[..], &["--set", "env.reach_radius=1.0"]].concat());
    for (cell, message) in [
        ("rech=far", "--cell rech=far: unknown axis; there are: reach"),
        ("reach=fra", "--cell reach=fra: unknown level; there are: near, far"),
        ("reach=near,reach=far", "--cell: no cell has two levels of one axis"),
    ] {
        assert_eq!(bench.fail(&[&other[..], &["--cell", cell]].concat(), 2), format!("error: {message}\n"));
    }
}

/// A rerun with other values replaced the folder's report under the same labels.
#[test]
fn a_cell_that_means_something_else_is_refused_and_changes_nothing() {
    let bench = Bench::of(REACH);
    bench.succeed(&["run", "spec.toml", "--out", "out"]);
    let before = contents(&bench.path("out"));
    let refused = |sets: &[&str]| {
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let message = bench.fail(&[&["run", "spec.toml", "--out", "out"], &sets[..]].concat(), 2);
        assert!(contents(&bench.path("out")) == before, "something changed: {message}");
        let start = "error: the results folder `out` holds other results under the same names: ";
        let rest = message.strip_prefix(start).unwrap_or_else(|| panic!("{message}"));
        rest.strip_suffix("; give another folder with --out\n").unwrap_or_else(|| panic!("{message}")).to_owned()
    };
    assert_eq!(
        refused(&["agent.gamma=0.9"]),
        "reach=near, seed 0: agent.gamma is 0.95 there, 0.9 here (and 1 more cell)"
    );
    // Other seeds under the same labels would mix two trainings no less.
    assert!(refused(&["agent.gamma=0.9", "seeds.first=7"]).starts_with("reach=near, seed 0: agent.gamma is 0.95"));
    assert_eq!(
        refused(&["evaluate.worlds.0.time_limit=30"]),
        "reach=near, world \"small\": time_limit is 20.0 there, 30.0 here (and 1 more cell)"
    );
    assert!(refused(&["evaluate.seed=5"]).contains("seed is 1000000 there, 5 here"));
    // What another name or another folder holds is nobody's loss.
    bench.succeed(&["run", "spec.toml", "--out", "other", "--set", "agent.gamma=0.9"]);
    // More seeds, episodes, worlds and levels are welcome.
    bench.succeed(&["run", "spec.toml", "--out", "out", "--set", "seeds.count=2", "--set", "evaluate.n_episodes=13"]);
    let spec = REACH.to_owned() + "farther = { \"env.reach_radius\" = 3.5 }\n";
    fs::write(bench.path("spec.toml"), spec).unwrap();
    bench.succeed(&["run", "spec.toml", "--out", "out", "--set", "seeds.count=2"]);
    // So is less, which is said.
    let notes = bench.notes(&["run", "spec.toml", "--out", "out"]);
    assert!(notes.starts_with("3 runs of the folder are not in this spec: they stay there"), "{notes}");
    assert!(notes.ends_with("nothing to do: all 3 runs are there\n"), "{notes}");
}

/// What never finished may be given up: a run that diverged can be mended in place.
#[test]
fn an_unfinished_cell_may_be_redefined() {
    let bench = Bench::of(REACH);
    bench.succeed(&["run", "spec.toml", "--out", "out"]);
    for cell in [0, 1] {
        fs::remove_file(bench.path(&bench.run("out", cell, 0)).join("done")).unwrap();
    }
    bench.succeed(&["run", "spec.toml", "--out", "out", "--set", "agent.gamma=0.9"]);
}

/// A damaged run could be neither reported nor repaired.
#[test]
fn what_is_damaged_is_named_and_done_again() {
    let bench = Bench::of(REACH);
    bench.succeed(&["run", "spec.toml", "--out", "out"]);
    let before = contents(&bench.path("out"));
    let (near, far) = (bench.run("out", 0, 0), bench.run("out", 1, 0));
    let policy = bench.path(&near).join("policy.safetensors");
    let bytes = fs::read(&policy).unwrap();
    fs::write(&policy, &bytes[..bytes.len() / 2]).unwrap();
    let evaluations = fs::read_dir(bench.path(&far).join("evaluations")).unwrap().map(|entry| entry.unwrap().path());
    let evaluations: Vec<_> = evaluations.collect();
    fs::remove_file(evaluations[0].join("episodes.csv")).unwrap();
    let table = bench.succeed(&["report", "out"]);
    let evaluation = evaluations[0].file_name().unwrap().to_str().unwrap();
    for line in [
        "unfinished: 0 of 2 runs are complete".to_owned(),
        format!(
            "warning: `{near}` is damaged: policy.safetensors is not what was written; `experiments run` will redo it"
        ),
        format!(
            "warning: `{far}/evaluations/{evaluation}` is damaged: episodes.csv is missing; `experiments run` will redo it"
        ),
    ] {
        assert!(table.lines().any(|found| found == line), "{line}\nis not in\n{table}");
    }
    assert!(bench.succeed(&["report", "out", "--runs"]).contains("damaged"));
    let notes = bench.notes(&["run", "spec.toml", "--out", "out"]);
    assert!(notes.contains("policy.safetensors is not what was written; it is made anew\n"), "{notes}");
    assert!(notes.contains("2 of 2 runs, took"), "{notes}");
    assert!(contents(&bench.path("out")) == before, "not as it was");
    assert_eq!(bench.notes(&["run", "spec.toml", "--out", "out"]), "nothing to do: all 2 runs are there\n");
}

/// The success line was printed even so, and nothing said which of many runs had failed.
#[test]
fn a_failing_last_run_is_named_and_no_success_is_claimed() {
    let bad = "bad = { \"agent.learning_rate\" = { start = 1e30, end = 1e30 } }\n";
    let bench = Bench::of(&SPEC.replace("DDQN = { \"agent.target\" = \"double_dqn\" }\n", bad));
    let args = ["run", "spec.toml", "--out", "out", "--jobs", "1", "--set", "seeds.count=1"];
    let errors = bench.fail(&args, 1);
    let run = bench.run("out", 1, 0);
    assert!(errors.contains("\nerror: training diverged at gradient step "), "{errors}");
    assert!(!errors.contains("2 of 2 runs"), "{errors}");
    assert!(errors.ends_with(&format!(" (agent=bad, seed 3, in {run})\n")), "{errors}");
    assert!(bench.path(&bench.run("out", 0, 0)).join("done").exists(), "the run before is kept");
}

#[test]
fn training_and_evaluation_are_timed_apart() {
    let bench = Bench::of(REACH);
    bench.succeed(&["run", "spec.toml", "--out", "out"]);
    let run = bench.path(&bench.run("out", 0, 0));
    let evaluation = fs::read_dir(run.join("evaluations")).unwrap().next().unwrap().unwrap().path();
    for folder in [run, evaluation] {
        let timing: Value = serde_json::from_slice(&fs::read(folder.join("timing.json")).unwrap()).unwrap();
        assert!(timing["cpu_seconds"].as_f64().unwrap() > 0.0);
    }
}

#[test]
fn every_run_is_listed_with_its_policy() {
    let bench = Bench::of(REACH);
    let table = bench.succeed(&["run", "spec.toml", "--out", "out"]);
    assert!(table.ends_with("results in out\nevery run and its policy: experiments report out --runs\n"), "{table}");
    let runs = bench.succeed(&["report", "out", "--runs"]);
    let lines: Vec<Vec<&str>> = runs.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(lines[0], ["reach", "seed", "id", "small", "policy"]);
    assert_eq!(lines.len(), 3 + 2);
    for (cell, name) in [(0, "near"), (1, "far")] {
        let run = bench.run("out", cell, 0);
        let [label, seed, id, success, policy] = lines[3 + cell][..] else { panic!("{runs}") };
        assert_eq!((label, seed, id), (name, "0", run.strip_prefix("out/runs/").unwrap()));
        assert!((0.0..=100.0).contains(&success.parse::<f64>().unwrap()));
        assert_eq!(policy, run + "/policy.safetensors");
        assert!(bench.path(policy).is_file());
    }
    let json = bench.json(&["report", "out", "--runs", "--format", "json"]);
    assert_eq!(json[1]["path"], bench.run("out", 1, 0) + "/policy.safetensors");
    let csv = bench.succeed(&["report", "out", "--runs", "--format", "csv"]);
    assert!(csv.starts_with("reach,seed,id,policy,path,world,") && csv.lines().count() == 1 + 2, "{csv}");
}

/// And a folder that does not exist is refused before anything is driven.
#[test]
fn a_drawing_is_of_the_first_world() {
    let world = "[[evaluate.worlds]]\nname = \"SECOND\"\ntime_limit = 20.0\nworld = { type = \"room_25x25\" }\n";
    let bench = Bench::of(REACH);
    bench.succeed(&["run", "spec.toml", "--out", "out"]);
    let policy = bench.run("out", 0, 0) + "/policy.safetensors";
    let args = ["evaluate", &policy, "--spec", "spec.toml", "--plot", "nowhere/drive.svg"];
    assert_eq!(bench.fail(&args, 2), "error: --plot nowhere/drive.svg: there is no folder `nowhere`\n");
    fs::write(bench.path("spec.toml"), REACH.replace("[[axis]]", &(world.to_owned() + "[[axis]]"))).unwrap();
    let args = ["evaluate", &policy, "--spec", "spec.toml", "--plot", "drive.svg", "--cell", "reach=near"];
    bench.succeed(&args);
    assert!(fs::read_to_string(bench.path("drive.svg")).unwrap().contains("small, episode 0"));
}

/// Stages of a curriculum come one after the other, and the spec's own world last.
#[test]
fn a_curriculum_changes_what_is_trained_in() {
    use headway_experiments::spec::{RunSpec, Stage};
    use headway_experiments::train::Training;
    use headway_sim::WorldSpec;

    let layers = |curriculum: Vec<Stage>, world: WorldSpec| {
        let mut spec = RunSpec { world, ..RunSpec::default() };
        (spec.train.n_steps, spec.train.curriculum) = (6400, curriculum);
        let mut training = Training::new(&spec, 0).unwrap();
        while !training.is_over() {
            training.step().unwrap();
        }
        training.policy().unwrap().layers().to_vec()
    };
    let stage = |until, world| Stage { until, world };
    let (small, large) = (WorldSpec::Room10x15 {}, WorldSpec::Room25x25 {});
    let only_small = layers(vec![], small.clone());
    // A stage that lasts to the end is all there is; one in between makes a difference.
    assert_eq!(layers(vec![stage(1.0, small.clone())], large.clone()), only_small);
    assert_ne!(layers(vec![stage(0.3, large)], small), only_small);
}
