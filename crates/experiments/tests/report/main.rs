//! What `report` prints of a results folder, to the letter.

mod collapse;
mod contrasts;

use std::path::Path;

use headway_experiments::collapse::Collapse;
use headway_experiments::episode::{EpisodeRecord, Outcome, SeedSummary};
use headway_experiments::report::{Interval, Report, Row, TABLE_WIDTH, load, of_policy};
use headway_experiments::store::{
    AxisLevel, Cell, EvaluationKey, GridAxis, Id, Index, IndexedEvaluation, IndexedRun, RESULTS_VERSION, RunInfo,
    Stopwatch, Store, TrainKey,
};
use serde_json::{Value, json};

const WORLDS: [&str; 2] = ["room_10x15", "room_25x25"];

/// Eight episodes of which as many fail as `skill` is below 8; all numbers have few digits.
fn episodes(skill: u32, world: u32) -> Vec<EpisodeRecord> {
    (0..8)
        .map(|scenario| {
            let outcome = match scenario {
                s if s < skill => Outcome::Success,
                7 => Outcome::Collision,
                _ => Outcome::Timeout,
            };
            let success = outcome == Outcome::Success;
            EpisodeRecord {
                scenario: scenario.into(),
                outcome,
                duration: if success { 10.0 } else { 5.0 },
                distance: if success { 8.0 + f64::from(world) } else { 2.0 },
                geodesic: 7.5,
                spl: if success { 7.5 / (8.0 + f64::from(world)) } else { 0.0 },
                near_time: f64::from(world) + 1.0,
                near_distance: 0.5,
                n_decelerations: scenario,
                n_needless_decelerations: scenario / 4,
                mean_jerk: Some(1.5),
                drawn: String::new(),
                n_shielded: 0,
                n_vetoes: 0,
                n_stops: 0,
            }
        })
        .collect()
}

/// A grid of 2 x 2 cells, `n_seeds` seeds and 2 worlds, of which the cells are as good as `skill` says.
struct Fixture {
    folder: tempfile::TempDir,
}

impl Fixture {
    fn new(n_seeds: u64, skill: impl Fn(usize, u64) -> u32) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        let names = [("R", "DQN"), ("R", "DDQN"), ("R_couple", "DQN"), ("R_couple", "DDQN")];
        let cells = names.iter().enumerate().map(|(k, (reward, agent))| {
            let seeds = 0..n_seeds;
            let runs = seeds.map(|seed| IndexedRun { seed, train_id: run(&store, k, seed, skill(k, seed)) }).collect();
            let level = |axis: &str, level: &str| AxisLevel { axis: axis.into(), level: level.into() };
            Cell { axes: vec![level("reward", reward), level("agent", agent)], runs, evaluations: evaluations() }
        });
        let cells = cells.collect();
        let axis =
            |name: &str, levels: [&str; 2]| GridAxis { name: name.into(), levels: levels.map(Into::into).into() };
        let axes = vec![axis("reward", ["R", "R_couple"]), axis("agent", ["DQN", "DDQN"])];
        store.write_index(&Index { name: "table1".into(), axes, cells }).unwrap();
        Self { folder }
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn report(&self) -> Report {
        load(self.path()).unwrap()
    }

    /// The folder of the run of a cell and seed.
    fn run(&self, cell: usize, seed: usize) -> std::path::PathBuf {
        let index = Index::load(self.path()).unwrap();
        self.path().join("runs").join(index.cells[cell].runs[seed].train_id.as_str())
    }
}

fn key(world: &&'static str) -> EvaluationKey<'static, str> {
    EvaluationKey { n_episodes: 8, seed: 1, time_limit: 60.0, files: Vec::new(), shield: None, world }
}

fn evaluations() -> Vec<IndexedEvaluation> {
    WORLDS.iter().map(|world| IndexedEvaluation { world: (*world).into(), eval_id: key(world).id().unwrap() }).collect()
}

fn run(store: &Store, cell: usize, seed: u64, skill: u32) -> Id {
    run_of(store, cell, skill, &RunInfo::new(seed, 1))
}

fn run_of(store: &Store, cell: usize, skill: u32, info: &RunInfo) -> Id {
    run_with(store, cell, skill, info, &[], |episode| episode)
}

/// A run whose training left this verdict, and whose episodes are changed like this.
fn run_with(
    store: &Store,
    cell: usize,
    skill: u32,
    info: &RunInfo,
    verdict: &[Collapse],
    change: impl Fn(EpisodeRecord) -> EpisodeRecord,
) -> Id {
    let spec = json!({ "cell": cell });
    let id = TrainKey { spec: &spec, seed: info.seed, reward_version: 1 }.id().unwrap();
    let pending = store.run(&id).start(&spec, info).unwrap();
    pending.write_policy(b"").unwrap();
    pending.write_collapse(verdict).unwrap();
    let run = pending.finish(&Stopwatch::start().stop()).unwrap();
    for (k, world) in (0..).zip(&WORLDS) {
        let evaluation = run.evaluation(&key(world).id().unwrap());
        let episodes: Vec<_> = episodes(skill, k).into_iter().map(&change).collect();
        evaluation.write(&key(world), &episodes, &Stopwatch::start().stop()).unwrap();
    }
    id
}

#[track_caller]
fn assert_text(text: &str, expected: &str) {
    let expected = &expected[1..]; // the first line may start with spaces
    assert!(text == expected, "--- got\n{text}--- expected\n{expected}");
    assert!(text.lines().all(|line| line.chars().count() <= TABLE_WIDTH), "wider than {TABLE_WIDTH} columns");
}

fn skill(cell: usize, seed: u64) -> u32 {
    [[0, 0, 0, 0], [0, 1, 5, 2], [7, 8, 7, 8], [8, 8, 8, 8]][cell][seed as usize]
}

#[test]
fn the_table_of_a_grid() {
    let table = Fixture::new(4, skill).report().table();
    assert_text(
        &table,
        "
                                                                     mean   speed in  speed near   needless
reward    agent  world           success  collision    timeout      speed  successes   obstacles     decel.        SPL
                                       %          %          %        m/s        m/s         m/s        1/m
──────────────────────────────────────────────────────────────────────────────────────────────────────────────────────
R         DQN    room_10x15          0.0       12.5       87.5       0.40          –        0.50       0.25       0.00
                                 0.0–0.0  12.5–12.5  87.5–87.5  0.40–0.40              0.50–0.50  0.25–0.25  0.00–0.00
R         DQN    room_25x25          0.0       12.5       87.5       0.40          –        0.25       0.25       0.00
                                 0.0–0.0  12.5–12.5  87.5–87.5  0.40–0.40              0.25–0.25  0.25–0.25  0.00–0.00
R         DDQN   room_10x15         25.0       12.5       62.5       0.54    0.80 *3        0.50       0.17       0.23
                                6.2–50.0  12.5–12.5  37.5–81.2  0.44–0.65  0.80–0.80   0.50–0.50  0.11–0.22  0.06–0.47
R         DDQN   room_25x25         25.0       12.5       62.5       0.57    0.90 *3        0.25       0.16       0.21
                                6.2–50.0  12.5–12.5  37.5–81.2  0.45–0.72  0.90–0.90   0.25–0.25  0.10–0.22  0.05–0.42
R_couple  DQN    room_10x15         93.8        6.2        0.0       0.79       0.80        0.50       0.07       0.88
                              87.5–100.0   0.0–12.5    0.0–0.0  0.77–0.80  0.80–0.80   0.50–0.50  0.06–0.07  0.82–0.94
R_couple  DQN    room_25x25         93.8        6.2        0.0       0.88       0.90        0.25       0.06       0.78
                              87.5–100.0   0.0–12.5    0.0–0.0  0.87–0.90  0.90–0.90   0.25–0.25  0.06–0.06  0.73–0.83
R_couple  DDQN   room_10x15        100.0        0.0        0.0       0.80       0.80        0.50       0.06       0.94
                             100.0–100.0    0.0–0.0    0.0–0.0  0.80–0.80  0.80–0.80   0.50–0.50  0.06–0.06  0.94–0.94
R_couple  DDQN   room_25x25        100.0        0.0        0.0       0.90       0.90        0.25       0.06       0.83
                             100.0–100.0    0.0–0.0    0.0–0.0  0.90–0.90  0.90–0.90   0.25–0.25  0.06–0.06  0.83–0.83
Mean over 4 training seeds, 8 episodes each; below it: 95 % percentile bootstrap over the seeds.
Intervals over 3 to 5 seeds are too narrow: over 3 each is the range of the seeds, which misses the mean 1 time in 4.
mean speed: all distance / all time, failures included; near obstacles: clearance < 1 m; needless: the way was clear
*n: defined in n of the seeds only; the mean is over those
left out for want of room (see --format json or csv): decelerations_per_m, mean_jerk
",
    );
}

#[test]
fn the_table_of_a_single_policy() {
    let table = of_policy(&[("room_10x15", episodes(6, 0)), ("hall", episodes(8, 1))]).table();
    assert_text(
        &table,
        "
                                              mean   speed in  speed near  decele-  needless        mean
world          success  collision   timeout  speed  successes   obstacles  rations    decel.   SPL  jerk
                     %          %         %    m/s        m/s         m/s      1/m       1/m        m/s³
────────────────────────────────────────────────────────────────────────────────────────────────────────
room_10x15        75.0       12.5      12.5   0.74       0.80        0.50     0.54      0.08  0.70  1.50
             40.9–92.9   2.2–47.1  2.2–47.1
hall             100.0        0.0       0.0   0.90       0.90        0.25     0.39      0.06  0.83  1.50
            67.6–100.0   0.0–32.4  0.0–32.4
One policy, 8 episodes a world; below the rates: 95 % Wilson intervals over the episodes.
mean speed: all distance / all time, failures included; near obstacles: clearance < 1 m; needless: the way was clear
",
    );
}

#[test]
fn fewer_than_three_seeds_have_no_intervals() {
    let table = Fixture::new(2, skill).report().table();
    assert_text(
        &table,
        "
                                                           mean   speed in  speed near  decele-  needless        mean
reward    agent  world       success  collision  timeout  speed  successes   obstacles  rations    decel.   SPL  jerk
                                   %          %        %    m/s        m/s         m/s      1/m       1/m        m/s³
─────────────────────────────────────────────────────────────────────────────────────────────────────────────────────
R         DQN    room_10x15      0.0       12.5     87.5   0.40          –        0.50     1.75      0.25  0.00  1.50
R         DQN    room_25x25      0.0       12.5     87.5   0.40          –        0.25     1.75      0.25  0.00  1.50
R         DDQN   room_10x15      6.2       12.5     81.2   0.44    0.80 *1        0.50     1.51      0.22  0.06  1.50
R         DDQN   room_25x25      6.2       12.5     81.2   0.46    0.90 *1        0.25     1.48      0.21  0.05  1.50
R_couple  DQN    room_10x15     93.8        6.2      0.0   0.79       0.80        0.50     0.46      0.07  0.88  1.50
R_couple  DQN    room_25x25     93.8        6.2      0.0   0.88       0.90        0.25     0.41      0.06  0.78  1.50
R_couple  DDQN   room_10x15    100.0        0.0      0.0   0.80       0.80        0.50     0.44      0.06  0.94  1.50
R_couple  DDQN   room_25x25    100.0        0.0      0.0   0.90       0.90        0.25     0.39      0.06  0.83  1.50
Mean over 2 training seeds, 8 episodes each; no intervals below 3 seeds.
mean speed: all distance / all time, failures included; near obstacles: clearance < 1 m; needless: the way was clear
*n: defined in n of the seeds only; the mean is over those
",
    );
}

/// The legend spoke of intervals where cells had no seed or one or two, and passed over what few seeds are worth.
#[test]
fn the_legend_says_which_seeds_have_intervals() {
    let legend = |n_seeds: &[usize]| -> Vec<String> {
        let seed = SeedSummary::of(&episodes(6, 0));
        let rows = n_seeds.iter().map(|n| Row::of_seeds(Vec::new(), "room".into(), &vec![seed; *n])).collect();
        let report = Report { rows, interval: Interval::Seeds, ..of_policy(&[("room", Vec::new())]) };
        let table = report.table();
        table.lines().skip_while(|line| !line.starts_with("Mean over")).take(2).map(str::to_owned).collect()
    };
    let start = "Mean over the training seeds, 8 episodes each; ";
    assert_eq!(legend(&[2, 1])[0], format!("{start}no intervals below 3 seeds."));
    let some = "below it, from 3 seeds on: 95 % percentile bootstrap over the seeds.";
    assert_eq!(legend(&[2, 6])[0], format!("{start}{some}"));
    assert_eq!(legend(&[6, 0, 7])[0], format!("{start}below it: 95 % percentile bootstrap over the seeds."));
    let few = "Intervals over 3 to 5 seeds are too narrow: ";
    for (n_seeds, are_few) in [(&[2, 1][..], false), (&[3], true), (&[9, 5], true), (&[6, 2], false)] {
        assert_eq!(legend(n_seeds)[1].starts_with(few), are_few, "{n_seeds:?} seeds");
    }
}

#[test]
fn an_unfinished_grid_shows_what_there_is() {
    let fixture = Fixture::new(4, skill);
    std::fs::remove_file(fixture.run(3, 1).join("done")).unwrap();
    let evaluation = fixture.run(2, 2).join("evaluations").join(key(&WORLDS[1]).id().unwrap().as_str());
    std::fs::remove_file(evaluation.join("done")).unwrap();
    for seed in 0..4 {
        std::fs::remove_dir_all(fixture.run(0, seed)).unwrap();
    }
    assert_text(
        &fixture.report().table(),
        "
                                                                            mean   speed in  speed near   needless
reward    agent  world       seeds      success  collision    timeout      speed  successes   obstacles     decel.
                                              %          %          %        m/s        m/s         m/s        1/m
──────────────────────────────────────────────────────────────────────────────────────────────────────────────────
R         DQN    room_10x15      0            –          –          –          –          –           –          –
R         DQN    room_25x25      0            –          –          –          –          –           –          –
R         DDQN   room_10x15      4         25.0       12.5       62.5       0.54    0.80 *3        0.50       0.17
                                       6.2–50.0  12.5–12.5  37.5–81.2  0.44–0.65  0.80–0.80   0.50–0.50  0.11–0.22
R         DDQN   room_25x25      4         25.0       12.5       62.5       0.57    0.90 *3        0.25       0.16
                                       6.2–50.0  12.5–12.5  37.5–81.2  0.45–0.72  0.90–0.90   0.25–0.25  0.10–0.22
R_couple  DQN    room_10x15      4         93.8        6.2        0.0       0.79       0.80        0.50       0.07
                                     87.5–100.0   0.0–12.5    0.0–0.0  0.77–0.80  0.80–0.80   0.50–0.50  0.06–0.07
R_couple  DQN    room_25x25      3         95.8        4.2        0.0       0.89       0.90        0.25       0.06
                                     87.5–100.0   0.0–12.5    0.0–0.0  0.87–0.90  0.90–0.90   0.25–0.25  0.06–0.06
R_couple  DDQN   room_10x15      3        100.0        0.0        0.0       0.80       0.80        0.50       0.06
                                    100.0–100.0    0.0–0.0    0.0–0.0  0.80–0.80  0.80–0.80   0.50–0.50  0.06–0.06
R_couple  DDQN   room_25x25      3        100.0        0.0        0.0       0.90       0.90        0.25       0.06
                                    100.0–100.0    0.0–0.0    0.0–0.0  0.90–0.90  0.90–0.90   0.25–0.25  0.06–0.06
Mean over the training seeds, 8 episodes each; below it: 95 % percentile bootstrap over the seeds.
Intervals over 3 to 5 seeds are too narrow: over 3 each is the range of the seeds, which misses the mean 1 time in 4.
mean speed: all distance / all time, failures included; near obstacles: clearance < 1 m; needless: the way was clear
*n: defined in n of the seeds only; the mean is over those
left out for want of room (see --format json or csv): decelerations_per_m, spl, mean_jerk
unfinished: 10 of 16 runs are complete
",
    );
}

#[test]
fn mixed_versions_and_revisions_are_flagged() {
    let fixture = Fixture::new(3, skill);
    let info = RunInfo { results_version: 0, revision: "abc1234".into(), ..RunInfo::new(1, 1) };
    run_of(&Store::open(fixture.path()).unwrap(), 1, skill(1, 1), &info);
    let notes = fixture.report().notes();
    let expected = format!("warning: runs of several results versions: 0 (1 runs), {RESULTS_VERSION} (11 runs)");
    assert_eq!(notes[0], expected);
    assert!(notes[1].starts_with("warning: runs of several code revisions: "), "{notes:?}");
    assert!(notes[1].contains("abc1234 (1 runs)"), "{notes:?}");
}

/// A missing file made the report fail, and every later `run`.
#[test]
fn damaged_folders_are_named_and_the_rest_is_shown() {
    let fixture = Fixture::new(4, skill);
    let (run, other) = (fixture.run(1, 1), fixture.run(2, 2));
    std::fs::write(run.join("policy.safetensors"), "half").unwrap();
    let evaluation = other.join("evaluations").join(key(&WORLDS[1]).id().unwrap().as_str());
    std::fs::remove_file(evaluation.join("episodes.csv")).unwrap();
    let report = fixture.report();
    let redo = "`experiments run` will redo it";
    assert_eq!(
        report.notes(),
        [
            "unfinished: 14 of 16 runs are complete".to_owned(),
            format!("warning: `{}` is damaged: policy.safetensors is not what was written; {redo}", run.display()),
            format!("warning: `{}` is damaged: episodes.csv is missing; {redo}", evaluation.display()),
        ]
    );
    let n_seeds: Vec<_> = report.rows.iter().map(|row| row.n_seeds).collect();
    assert_eq!(n_seeds, [4, 4, 3, 3, 4, 3, 4, 4]);
}

/// Intervals over episodes stood under the keys of those over seeds.
#[test]
fn a_single_policy_has_no_interval_over_seeds() {
    let report = of_policy(&[("room_10x15", episodes(6, 0))]);
    let rows: Vec<Value> = serde_json::from_str(&report.json()).unwrap();
    let success = &rows[0]["success"];
    assert_eq!((&success["mean"], &success["n"]), (&json!(0.75), &json!(1)));
    assert!(success["low"].is_null() && success["high"].is_null(), "{success}");
    assert!((success["wilson_low"].as_f64().unwrap() - 0.409).abs() < 1e-3, "{success}");
    assert!((success["wilson_high"].as_f64().unwrap() - 0.929).abs() < 1e-3, "{success}");
    assert_eq!(rows[0]["spl"].as_object().unwrap().len(), 4, "rates only");
    let (csv, grid) = (report.csv(), Fixture::new(3, skill).report());
    assert!(csv.starts_with("world,seeds,episodes,success,success_low,success_high,collision,"), "{csv}");
    assert!(
        csv.lines().next().unwrap().ends_with(",timeout_wilson_low,timeout_wilson_high,trained,collapsed"),
        "{csv}"
    );
    assert!(!grid.json().contains("wilson") && !grid.csv().contains("wilson"));
}

#[test]
fn a_shield_has_columns_of_its_own() {
    let shielded = |episode| EpisodeRecord { n_shielded: 50, n_vetoes: 5, n_stops: 1, ..episode };
    let report = of_policy(&[("room_10x15", episodes(6, 0).into_iter().map(shielded).collect())]);
    let rows: Vec<Value> = serde_json::from_str(&report.json()).unwrap();
    assert_eq!((&rows[0]["vetoes"]["mean"], &rows[0]["stops"]["mean"]), (&json!(0.1), &json!(0.02)));
    assert!(report.table().contains("vetoes"), "{}", report.table());
    let without = of_policy(&[("room_10x15", episodes(6, 0))]);
    assert!(!without.table().contains("vetoes") && without.json().contains("\"vetoes\""));
}

#[test]
fn the_list_of_runs() {
    let fixture = Fixture::new(3, skill);
    std::fs::remove_file(fixture.run(3, 2).join("done")).unwrap();
    let text = fixture.report().runs_table();
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(lines[0], ["reward", "agent", "seed", "id", "room_10x15", "room_25x25", "policy"]);
    assert_eq!(lines[1], ["success", "%", "success", "%"]);
    assert_eq!(lines.len(), 3 + 12 + 1);
    let policy = fixture.run(2, 1).join("policy.safetensors").display().to_string();
    assert_eq!([&lines[10][..3], &lines[10][4..]].concat(), ["R_couple", "DQN", "1", "100.0", "100.0", &policy]);
    assert_eq!(lines[14][4..], ["–", "–", "unfinished"]);
    assert_eq!(text.lines().last().unwrap(), "unfinished: 11 of 12 runs are complete");
}

/// The list of runs had no form for programs.
#[test]
fn records_of_runs_have_all_metrics() {
    let fixture = Fixture::new(2, skill);
    let store = Store::open(fixture.path()).unwrap();
    let times_out = |episode| EpisodeRecord { outcome: Outcome::Timeout, duration: 4.0, distance: 2.0, ..episode };
    let spins = [Collapse::Spinning { share: 0.75 }];
    run_with(&store, 1, skill(1, 1), &RunInfo::new(1, 1), &spins, times_out);
    std::fs::remove_file(fixture.run(3, 0).join("done")).unwrap();
    let report = fixture.report();
    let runs: Vec<Value> = serde_json::from_str(&report.runs_json()).unwrap();
    let csv = report.runs_csv();
    let mut records = csv::Reader::from_reader(csv.as_bytes());
    let header: Vec<String> = records.headers().unwrap().iter().map(str::to_owned).collect();
    let first = ["reward", "agent", "seed", "id", "policy", "path", "world", "episodes", "collapse", "success"];
    assert_eq!(header[..10], first);
    let records: Vec<_> = records.records().map(Result::unwrap).collect();
    assert_eq!((runs.len(), records.len()), (8, 16));
    for (k, record) in records.iter().enumerate() {
        let (run, world) = (&runs[k / 2], WORLDS[k % 2]);
        let numbers = &run["worlds"][world];
        let is_there = run["policy"] != "unfinished";
        assert_eq!(is_there, k / 2 != 6);
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let (reward, id) = (text(&run["axes"]["reward"]), text(&run["id"]));
        assert_eq!((&record[0], &record[3], &record[5], &record[6]), (&*reward, &*id, &*text(&run["path"]), world));
        assert_eq!(record[2].parse::<u64>().unwrap(), run["seed"].as_u64().unwrap());
        assert_eq!((numbers.is_object(), &record[7]), (is_there, if is_there { "8" } else { "0" }));
        for (column, name) in header.iter().enumerate().skip(9) {
            assert_eq!(record[column].parse::<f64>().ok(), numbers[name].as_f64(), "{name} of {record:?}");
        }
    }
    assert_eq!(runs[4]["worlds"]["room_10x15"]["success"], json!(0.875));
    assert_eq!(runs[6]["worlds"], json!({ "room_10x15": null, "room_25x25": null }));
    assert_eq!((&records[6][8], &records[0][8]), ("spinning times_out", ""));
    let kinds: Vec<_> = runs[3]["collapse"].as_array().unwrap().iter().map(|how| how["kind"].clone()).collect();
    assert_eq!(kinds, ["spinning", "times_out", "times_out"]);
    assert_eq!(runs[3]["path"], json!(fixture.run(1, 1).join("policy.safetensors")));
    assert!(runs[6]["path"].is_null());
}

#[test]
fn json_is_a_list_with_one_object_per_cell_and_world() {
    let text = Fixture::new(4, skill).report().json();
    let rows: Vec<Value> = serde_json::from_str(&text).unwrap();
    assert_eq!(rows.len(), 8);
    let undefined = json!({ "mean": null, "low": null, "high": null, "n": 0 });
    assert_eq!(rows[0]["axes"], json!({ "reward": "R", "agent": "DQN" }));
    assert_eq!(
        (&rows[0]["world"], &rows[0]["seeds"], &rows[0]["episodes"]),
        (&json!("room_10x15"), &json!(4), &json!(32))
    );
    assert_eq!(rows[0]["success"], json!({ "mean": 0.0, "low": 0.0, "high": 0.0, "n": 4 }));
    assert_eq!(rows[0]["timeout"]["mean"], json!(0.875));
    assert_eq!(rows[0]["speed_in_successes"], undefined);
    assert_eq!(rows[2]["speed_in_successes"]["n"], json!(3));
    assert!(text.find("\"reward\"").unwrap() < text.find("\"agent\"").unwrap(), "axes keep the order of the grid");
}

#[test]
fn csv_has_a_row_per_cell_and_world() {
    let text = Fixture::new(4, skill).report().csv();
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines.len(), 1 + 8);
    assert!(lines[0].starts_with("reward,agent,world,seeds,episodes,success,success_low,success_high,collision,"));
    assert!(lines[0].ends_with(
        ",mean_jerk,mean_jerk_low,mean_jerk_high,vetoes,vetoes_low,vetoes_high,stops,stops_low,stops_high,trained,collapsed"
    ));
    assert!(lines[1].starts_with("R,DQN,room_10x15,4,32,0,0,0,0.125,0.125,0.125,0.875,") && lines[1].ends_with(",4,0"));
}

/// The three formats show the same numbers.
#[test]
fn the_formats_agree() {
    let report = Fixture::new(4, skill).report();
    let rows: Vec<Value> = serde_json::from_str(&report.json()).unwrap();
    let (csv, table) = (report.csv(), report.table());
    let mut records = csv::Reader::from_reader(csv.as_bytes());
    let header = records.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    let means = table.lines().skip(4).step_by(2);
    for ((row, record), line) in rows.iter().zip(records.records()).zip(means) {
        let record = record.unwrap();
        let success = row["success"]["mean"].as_f64().unwrap();
        assert_eq!(record[column("success")].parse::<f64>().unwrap(), success);
        assert_eq!(record[column("spl_high")].parse::<f64>().ok(), row["spl"]["high"].as_f64());
        let cells: Vec<_> = line.split_whitespace().collect();
        assert_eq!(
            cells[..3],
            [&row["axes"]["reward"], &row["axes"]["agent"], &row["world"]].map(|v| v.as_str().unwrap())
        );
        assert!((cells[3].parse::<f64>().unwrap() - 100.0 * success).abs() <= 0.05, "{line}");
        assert!(
            (cells[6].parse::<f64>().unwrap() - row["mean_speed"]["mean"].as_f64().unwrap()).abs() <= 0.005,
            "{line}"
        );
    }
}

#[test]
fn a_folder_without_results_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let message = load(folder.path()).unwrap_err().to_string();
    assert!(
        message.contains("holds no results") && message.contains(&folder.path().display().to_string()),
        "{message}"
    );
}
