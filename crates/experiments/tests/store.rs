//! The results folder: what is written when, what survives an interruption, and who may write.

use std::fs;
use std::path::Path;

use headway_experiments::episode::{EpisodeMeter, EpisodeRecord, Outcome, Sample};
use headway_experiments::store::{
    AxisLevel, Cell, EvaluationKey, GridAxis, Id, Index, RunFolder, RunInfo, State, Stopwatch, Store, StoreError,
    Timing, TrainKey,
};
use serde::Serialize;

#[derive(Serialize)]
struct Spec {
    agent: Agent,
    n_steps: u64, // a value behind a table: TOML must put it first
}

#[derive(Serialize)]
struct Agent {
    gamma: f64,
}

#[derive(Serialize)]
struct MetricsRow {
    env_steps: u64,
    loss: Option<f64>,
}

const SPEC: Spec = Spec { agent: Agent { gamma: 0.95 }, n_steps: 1000 };

fn id(seed: u64) -> Id {
    TrainKey { spec: &SPEC, seed, reward_version: 1 }.id().unwrap()
}

fn key() -> EvaluationKey<'static, Agent> {
    EvaluationKey { n_episodes: 2, seed: 7, time_limit: 60.0, files: Vec::new(), shield: None, world: &SPEC.agent }
}

fn finish_run(run: &RunFolder) {
    let pending = run.start(&SPEC, &RunInfo::new(3, 1)).unwrap();
    let mut metrics = pending.metrics().unwrap();
    metrics.push(&MetricsRow { env_steps: 500, loss: None }).unwrap();
    metrics.push(&MetricsRow { env_steps: 1000, loss: Some(0.25) }).unwrap();
    pending.write_policy(b"weights").unwrap();
    pending.finish(&Stopwatch::start().stop()).unwrap();
}

fn episodes() -> Vec<EpisodeRecord> {
    let mut meter = EpisodeMeter::new(2.0);
    let sample =
        Sample { speed_before: 1.0, speed_after: 0.1, dt: 0.1, distance: 0.3, clearance: 0.7, free_range: 0.2 };
    meter.push(&sample);
    meter.push(&Sample { dt: 0.2, ..sample }); // 0.1 + 0.2: all digits must survive
    vec![meter.clone().finish(0, Outcome::Success, 0.55), meter.finish(1, Outcome::Collision, 4.0)]
}

fn timing() -> Timing {
    Stopwatch::start().stop()
}

fn text(path: impl AsRef<Path>) -> String {
    fs::read_to_string(path).unwrap()
}

#[test]
fn a_run_leaves_its_files_and_is_complete_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path().join("new/results")).unwrap();
    let run = store.run(&id(3));
    assert!(!run.is_complete() && !run.path().exists());
    let pending = run.start(&SPEC, &RunInfo::new(3, 1)).unwrap();
    assert!(!run.is_complete());
    drop(pending);
    finish_run(&run);
    assert!(run.is_complete());
    assert_eq!(text(run.path().join("spec.toml")), "n_steps = 1000\n\n[agent]\ngamma = 0.95\n");
    assert_eq!(text(run.path().join("metrics.csv")), "env_steps,loss\n500,\n1000,0.25\n");
    assert_eq!(fs::read(run.policy_path()).unwrap(), b"weights");
    assert_eq!(run.info().unwrap(), RunInfo::new(3, 1));
    assert!(run.timing().unwrap().wall_seconds >= 0.0);
    let mut names: Vec<_> = fs::read_dir(run.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["done", "metrics.csv", "policy.safetensors", "run.json", "spec.toml", "timing.json"]);
}

#[test]
fn only_the_timing_knows_the_time() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let files = || ["spec.toml", "run.json", "metrics.csv"].map(|file| text(store.run(&id(3)).path().join(file)));
    finish_run(&store.run(&id(3)));
    let first = files();
    finish_run(&store.run(&id(3)));
    assert_eq!(files(), first);
}

#[test]
fn metrics_are_visible_while_the_run_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let run = Store::open(folder.path()).unwrap().run(&id(0));
    let pending = run.start(&SPEC, &RunInfo::new(0, 1)).unwrap();
    let mut metrics = pending.metrics().unwrap();
    metrics.push(&MetricsRow { env_steps: 500, loss: None }).unwrap();
    assert_eq!(text(run.path().join("metrics.csv")), "env_steps,loss\n500,\n");
}

#[test]
fn a_half_written_run_is_removed_evaluations_and_all() {
    let folder = tempfile::tempdir().unwrap();
    let run = Store::open(folder.path()).unwrap().run(&id(3));
    finish_run(&run);
    let evaluation = run.evaluation(&key().id().unwrap());
    evaluation.write(&key(), &episodes(), &timing()).unwrap();
    fs::remove_file(run.path().join("done")).unwrap();
    run.start(&SPEC, &RunInfo::new(3, 1)).unwrap();
    assert!(!run.policy_path().exists() && !evaluation.path().exists() && !run.is_complete());
}

#[test]
fn episodes_come_back_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    let run = Store::open(folder.path()).unwrap().run(&id(3));
    finish_run(&run);
    let evaluation = run.evaluation(&key().id().unwrap());
    assert!(!evaluation.is_complete());
    evaluation.write(&key(), &episodes(), &timing()).unwrap();
    assert!(evaluation.is_complete());
    assert_eq!(evaluation.episodes().unwrap(), episodes());
    let spec = "n_episodes = 2\nseed = 7\ntime_limit = 60.0\n\n[world]\ngamma = 0.95\n";
    assert_eq!(text(evaluation.path().join("spec.toml")), spec);
    let csv = "scenario,outcome,duration,distance,geodesic,spl,near_time,near_distance,n_decelerations,\
               n_needless_decelerations,drawn,n_shielded,n_vetoes,n_stops\n0,success,";
    assert!(text(evaluation.path().join("episodes.csv")).starts_with(csv));
}

#[test]
fn a_damaged_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let run = Store::open(folder.path()).unwrap().run(&id(3));
    finish_run(&run);
    fs::write(run.path().join("run.json"), "{").unwrap();
    let message = run.info().unwrap_err().to_string();
    assert!(message.contains("run.json: cannot read this file: EOF"), "{message}");
}

/// A done-file that vouched for nothing left damaged runs for good.
#[test]
fn damage_shows_and_is_no_completion() {
    let folder = tempfile::tempdir().unwrap();
    let run = Store::open(folder.path()).unwrap().run(&id(3));
    let damaged = |folder: &Path, what: &str| State::Damaged { folder: folder.to_owned(), what: what.to_owned() };
    assert_eq!(run.state().unwrap(), State::Unfinished);
    finish_run(&run);
    let evaluation = run.evaluation(&key().id().unwrap());
    evaluation.write(&key(), &episodes(), &timing()).unwrap();
    assert_eq!((run.state().unwrap(), evaluation.state().unwrap()), (State::Complete, State::Complete));
    fs::remove_file(evaluation.path().join("episodes.csv")).unwrap();
    assert_eq!(evaluation.state().unwrap(), damaged(evaluation.path(), "episodes.csv is missing"));
    assert!(run.is_complete() && !evaluation.is_complete() && evaluation.has_finished());
    fs::write(run.policy_path(), b"weigh").unwrap();
    assert_eq!(run.state().unwrap(), damaged(run.path(), "policy.safetensors is not what was written"));
    assert!(!run.is_complete() && run.has_finished());
    finish_run(&run);
    assert_eq!(run.state().unwrap(), State::Complete);
}

#[test]
fn the_done_file_can_be_checked_with_sha256sum() {
    let folder = tempfile::tempdir().unwrap();
    let run = Store::open(folder.path()).unwrap().run(&id(3));
    finish_run(&run);
    let done = text(run.path().join("done"));
    let lines: Vec<_> = done.lines().map(|line| line.split_once("  ").unwrap()).collect();
    let names: Vec<_> = lines.iter().map(|(_, name)| *name).collect();
    assert_eq!(names, ["metrics.csv", "policy.safetensors", "run.json", "spec.toml"]);
    assert_eq!(lines[1].0, "9a129038d9a00aed0cf6a7ea059ca50a813449061ab87848cf1a13eafdf33b2c");
}

#[test]
fn one_writer_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let error = Store::open(folder.path()).unwrap_err();
    assert!(matches!(&error, StoreError::InUse { folder: used } if used == folder.path()), "{error}");
    assert!(error.to_string().contains(&folder.path().display().to_string()));
    drop(store);
    Store::open(folder.path()).unwrap();
}

#[test]
fn a_folder_that_cannot_be_written_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let message = Store::open(file.join("results")).unwrap_err().to_string();
    assert!(message.contains("file/results: cannot create the results folder"), "{message}");
}

#[test]
fn the_index_is_replaced_by_the_same_grid_only() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    assert!(matches!(Index::load(folder.path()), Err(StoreError::NoIndex { .. })));
    let axes = vec![GridAxis { name: "agent".into(), levels: vec!["DQN".into()] }];
    let first = Index { name: "table1".into(), axes, cells: vec![] };
    store.write_index(&first).unwrap();
    assert_eq!(Index::load(folder.path()).unwrap(), first);
    let level = AxisLevel { axis: "agent".into(), level: "DQN".into() };
    let cells = vec![Cell { axes: vec![level], runs: vec![], evaluations: vec![] }];
    let larger = Index { cells, ..first.clone() };
    store.write_index(&larger).unwrap();
    assert_eq!(Index::load(folder.path()).unwrap(), larger);
    let message = store.write_index(&Index { name: "other".into(), ..first }).unwrap_err().to_string();
    assert!(message.contains("holds the grid `table1`; give another folder for `other`"), "{message}");
    assert_eq!(Index::load(folder.path()).unwrap(), larger);
}

#[test]
fn a_folder_that_does_not_exist_is_said_not_to() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing");
    let error = Index::load(&missing).unwrap_err();
    assert!(matches!(error, StoreError::NoFolder { .. }), "{error}");
    assert_eq!(error.to_string(), format!("there is no folder `{}`", missing.display()));
}

#[test]
fn an_index_whose_cells_lack_an_axis_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let axes = vec![GridAxis { name: "agent".into(), levels: vec!["DQN".into()] }];
    let cells = vec![Cell { axes: vec![], runs: vec![], evaluations: vec![] }];
    let store = Store::open(folder.path()).unwrap();
    store.write_index(&Index { name: "table1".into(), axes, cells }).unwrap();
    let message = Index::load(folder.path()).unwrap_err().to_string();
    assert!(message.contains("index.json: cannot read this file: cells[0].axes"), "{message}");
}

#[test]
fn the_written_spec_has_the_id_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let spec = headway_experiments::spec::RunSpec::default();
    let key = |spec| TrainKey { spec, seed: 0, reward_version: 1 }.id().unwrap();
    let id = key(&spec);
    let run = Store::open(folder.path()).unwrap().run(&id);
    run.start(&spec, &RunInfo::new(0, 1)).unwrap();
    let written = toml::from_str(&text(run.path().join("spec.toml"))).unwrap();
    assert_eq!(key(&written), id);
}
