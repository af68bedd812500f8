//! What `watch` sees of a results folder, and how it shows it.

use std::fs;
use std::process::Command;

use headway_experiments::collapse::Collapse;
use headway_experiments::episode::{EpisodeMeter, Outcome, Sample};
use headway_experiments::store::{
    AxisLevel, Cell, EvaluationKey, GridAxis, Index, IndexedEvaluation, IndexedRun, RunInfo, Stopwatch, Store, TrainKey,
};
use headway_experiments::train::MetricsRow;
use headway_experiments::watch::{RunProgress, Stage, Tone, View, Watcher};
use serde_json::json;

fn row(k: u64) -> MetricsRow {
    MetricsRow {
        env_steps: 10_000 * k,
        gradient_steps: 300 * k,
        reward_mean: 0.5,
        n_reached: 3,
        n_collisions: 1,
        n_timeouts: 0,
        loss: Some(0.25),
        mean_q: Some(1.0),
        grad_norm: Some(1.0),
        epsilon: 0.02,
        learning_rate: 1e-3,
        return_mean: Some(k as f64),
        arrived: Some(0.75),
        timed_out: Some(0.0),
        progress: Some(0.5),
        abs_progress: Some(0.6),
        spinning: Some(0.0),
        action_entropy: Some(0.5),
        dead_units: vec![0.125, 0.25],
        max_abs_q: Some(2.0),
        q_bound: Some(20.0),
    }
}

fn key() -> EvaluationKey<'static, str> {
    EvaluationKey { n_episodes: 1, seed: 1, time_limit: 60.0, files: Vec::new(), shield: None, world: "room" }
}

/// A grid of one cell and four seeds: done, evaluating, training, waiting.
fn grid() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let spec = json!({ "train": { "n_steps": 40_000 } });
    let run = |seed| IndexedRun { seed, train_id: TrainKey { spec: &spec, seed, reward_version: 1 }.id().unwrap() };
    let runs: Vec<IndexedRun> = (0..4).map(run).collect();
    for (seed, n_rows) in [(0, 4), (1, 4), (2, 1)] {
        let pending = store.run(&runs[seed].train_id).start(&spec, &RunInfo::new(seed as u64, 1)).unwrap();
        let mut metrics = pending.metrics().unwrap();
        (1..=n_rows).for_each(|k| metrics.push(&row(k)).unwrap());
        if seed < 2 {
            pending.write_policy(b"weights").unwrap();
            pending.finish(&Stopwatch::start().stop()).unwrap();
        }
    }
    let mut meter = EpisodeMeter::new(2.0);
    let still = Sample { speed_before: 0.0, speed_after: 0.0, dt: 1.0, distance: 0.0, clearance: 1.0, free_range: 1.0 };
    meter.push(&still);
    let evaluation = store.run(&runs[0].train_id).evaluation(&key().id().unwrap());
    evaluation.write(&key(), &[meter.finish(0, Outcome::Success, 1.0)], &Stopwatch::start().stop()).unwrap();
    let axes = vec![GridAxis { name: "agent".into(), levels: vec!["DQN".into()] }];
    let level = AxisLevel { axis: "agent".into(), level: "DQN".into() };
    let evaluations = vec![IndexedEvaluation { world: "room".into(), eval_id: key().id().unwrap() }];
    let cells = vec![Cell { axes: vec![level], runs, evaluations }];
    store.write_index(&Index { name: "small".into(), axes, cells }).unwrap();
    folder
}

#[test]
fn every_stage_shows_in_the_folders() {
    let folder = grid();
    let mut watcher = Watcher::new(folder.path());
    let (index, runs) = watcher.look().unwrap();
    let stages: Vec<_> = runs.iter().map(|run| run.stage).collect();
    assert_eq!(stages, [Stage::Done, Stage::Evaluating, Stage::Training, Stage::Waiting]);
    assert_eq!(runs.iter().map(RunProgress::share).collect::<Vec<_>>(), [Some(1.0), Some(1.0), Some(0.25), None]);
    assert_eq!((&runs[0].success[..], &runs[1].success[..]), (&[Some(1.0)][..], &[None][..]));
    assert_eq!(runs[2].rows, [row(1)]);
    assert!(runs[0].steps_per_second.unwrap() > 0.0);
    // The next row is there as soon as it is written, and not before it is whole.
    let run = folder.path().join("runs").join(index.cells[0].runs[2].train_id.as_str());
    let metrics = fs::read_to_string(run.join("metrics.csv")).unwrap();
    fs::write(run.join("metrics.csv"), metrics.clone() + "20000,600,0.").unwrap();
    assert_eq!(watcher.look().unwrap().1[2].rows, [row(1)]);
    let line = metrics.lines().nth(1).unwrap();
    fs::write(run.join("metrics.csv"), format!("{metrics}{line}\n")).unwrap();
    assert_eq!(watcher.look().unwrap().1[2].rows, [row(1), row(1)]);
}

#[test]
fn the_view_is_a_line_for_each_run() {
    let progress = |level: &str, seed, stage, n_rows| RunProgress {
        axes: vec![AxisLevel { axis: "agent".into(), level: level.into() }],
        seed,
        stage,
        n_steps: (stage != Stage::Waiting).then_some(80_000),
        rows: (1..=n_rows).map(row).collect(),
        steps_per_second: (n_rows > 0).then_some(20_000.0),
        success: vec![(stage == Stage::Done).then_some(0.975), None],
        collapse: Vec::new(),
        damage: None,
    };
    let spins = vec![Collapse::Spinning { share: 0.9 }];
    let runs = [
        progress("DQN", 0, Stage::Done, 8),
        RunProgress { collapse: spins, ..progress("DQN", 1, Stage::Training, 5) },
        progress("DDQN", 0, Stage::Training, 0),
        progress("DDQN", 1, Stage::Waiting, 0),
    ];
    let axes = vec![GridAxis { name: "agent".into(), levels: vec!["DQN".into(), "DDQN".into()] }];
    let index = Index { name: "small".into(), axes, cells: vec![] };
    let view = View::new(&index, &runs, 160, 100);
    assert_eq!(view.title, "small: 1 of 4 runs done, 2 training, 1 waiting; 1 of 3 collapsed");
    let tones: Vec<_> = view.lines.iter().map(|(_, tone)| *tone).collect();
    assert_eq!(tones, [Tone::Plain, Tone::Faint, Tone::Plain, Tone::Alarm, Tone::Active, Tone::Faint]);
    let lines: Vec<_> = view.lines.iter().map(|(line, _)| line.as_str()).collect();
    let expected = "
agent  seed            progress          env steps  steps/s  left  return    last  arrived %  loss  success %  collapsed
────────────────────────────────────────────────────────────────────────────────────────────────────────────────────────
DQN       0  done      ██████████ 100 %     80 000   20 000     –  ▁▂▃▄▅▆▇█  8.00       75.0  0.25   97.5 / –
DQN       1  training  ██████░░░░  62 %     50 000   20 000  0:02  ▁▃▅▆█     5.00       75.0  0.25      – / –  spins
DDQN      0  training  ░░░░░░░░░░   0 %          –        –     –               –          –     –      – / –
DDQN      1  waiting   –                         –        –     –               –          –     –      – / –";
    assert_eq!(lines.join("\n"), expected.trim_start_matches('\n'), "\n{}", lines.join("\n"));
    // Less room: what matters least leaves, columns and runs alike.
    let narrow = View::new(&index, &runs, 80, 9);
    assert!(narrow.lines.iter().all(|(line, _)| line.chars().count() <= 80));
    assert!(!narrow.lines[0].0.contains("loss") && narrow.lines[0].0.contains("progress"));
    assert_eq!(narrow.lines.len(), 2 + 2 + 1);
    assert!(narrow.lines[2..4].iter().all(|(line, _)| line.contains("training")));
    assert_eq!(narrow.lines[4].0, "and 2 more runs, done or waiting");
}

/// One such file ended the view of all the others with an error.
#[test]
fn damaged_runs_are_marked_and_the_rest_is_shown() {
    let folder = grid();
    let runs = Index::load(folder.path()).unwrap().cells.remove(0).runs;
    let append = |seed: usize, text: &str| {
        let path = folder.path().join("runs").join(runs[seed].train_id.as_str()).join("metrics.csv");
        fs::write(&path, fs::read_to_string(&path).unwrap() + text).unwrap();
        path
    };
    let mut watcher = Watcher::new(folder.path());
    let done = append(0, "xx"); // not even a line: only the done-file tells
    let training = append(2, "xx\n");
    let (index, runs) = watcher.look().unwrap();
    let stages: Vec<_> = runs.iter().map(|run| run.stage).collect();
    assert_eq!(stages, [Stage::Damaged, Stage::Evaluating, Stage::Damaged, Stage::Waiting]);
    let view = View::new(&index, &runs, 1000, usize::MAX);
    assert_eq!(view.title, "small: 0 of 4 runs done, 1 evaluating, 2 damaged, 1 waiting");
    assert!(view.lines[2].0.contains("  damaged ") && view.lines[2].1 == Tone::Alarm, "{:?}", view.lines);
    let below: Vec<_> = view.lines[6..].iter().map(|(line, _)| line.as_str()).collect();
    let redo = "; `experiments run` will redo it";
    let of_done = format!("metrics.csv is not what was written{redo}");
    assert_eq!(below[..2], ["success in room", &format!("warning: `{}` is damaged: {of_done}", parent(&done))]);
    assert!(below[2].starts_with(&format!("warning: `{}` is damaged: ", training.display())), "{below:?}");
    assert!(below[2].ends_with(redo) && below.len() == 3);
    let narrow = View::new(&index, &runs, 80, 40).lines;
    assert!(narrow.iter().any(|(line, _)| line.ends_with("will redo it") && line.chars().count() <= 80), "{narrow:?}");
    // Both runs twice over, as if two cells shared them: each is told once. A low terminal has room for a few.
    let twice = [&runs[..], &runs[..]].concat();
    let n_warnings = |runs: &[RunProgress], n_lines| {
        let view = View::new(&index, runs, 1000, n_lines);
        assert!(view.lines.len() + 4 <= n_lines, "{} lines", view.lines.len());
        view.lines.iter().filter(|(line, _)| line.starts_with("warning: ")).count()
    };
    assert_eq!(n_warnings(&twice, usize::MAX), 2);
    let many = |k: usize| RunProgress { damage: Some(format!("`{k}` is damaged")), ..runs[0].clone() };
    let many: Vec<_> = (0..10).map(many).collect();
    assert_eq!((n_warnings(&many, usize::MAX), n_warnings(&many, 20)), (10, 2));
    assert_eq!(View::new(&index, &many, 160, 20).lines.last().unwrap().0, "and 8 more are damaged");
    append(1, "xx");
    assert_eq!(watcher.look().unwrap().1[1].stage, Stage::Damaged, "though not all of its evaluations are done");
}

fn parent(path: &std::path::Path) -> std::path::Display<'_> {
    path.parent().unwrap().display()
}

#[test]
fn the_binary_prints_once_where_there_is_no_terminal() {
    let folder = grid();
    let watch = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
        command.arg("watch").args(args).output().unwrap()
    };
    let path = folder.path().to_str().unwrap();
    let output = watch(&[path]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success() && text.starts_with("small: 1 of 4 runs done, 1 training, 1 evaluating, 1 waiting\n")
    );
    assert!(!text.contains('\x1b') && text.ends_with("\nsuccess in room\n"), "{text}");
    assert_eq!(text.lines().next(), String::from_utf8(watch(&[path, "--once"]).stdout).unwrap().lines().next());
    assert_eq!(watch(&["nowhere"]).status.code(), Some(2));
}
