//! Event files beside the runs, and what TensorBoard itself reads in them.
//!
//! The latter needs a Python with `tests/tensorboard/requirements.txt` installed, named by `HEADWAY_PYTHON`; the checks make one:
//!
//! ```text
//! python3 -m venv VENV && VENV/bin/pip install -r crates/experiments/tests/tensorboard/requirements.txt
//! HEADWAY_PYTHON=VENV/bin/python cargo test --release -p headway-experiments --test tensorboard -- --ignored
//! ```

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use headway_experiments::store::{Index, RunFolder};
use headway_experiments::train::MetricsRow;

const SPEC: &str = r#"
name = "small"
seeds = { first = 3, count = 1 }
train = { n_steps = 2_000, log_every = 500 }
evaluate = { n_episodes = 2 }

[[axis]]
name = "agent"
[axis.levels]
DQN = { "agent.target" = "dqn" }
"a/b" = { "agent.target" = "double_dqn" }
"#;

const FILE: &str = "events.out.tfevents.0000000000.headway";

/// A results folder made with these arguments.
fn results(folder: &Path, out: &str, args: &[&str]) -> PathBuf {
    fs::write(folder.join("spec.toml"), SPEC).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    let output = command.current_dir(folder).args(["run", "spec.toml", "--out", out]).args(args).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join(out)
}

/// The event file and the rows of each run.
fn runs(root: &Path) -> Vec<(PathBuf, Vec<MetricsRow>)> {
    let index = Index::load(root).unwrap();
    let names = ["agent=DQN, seed 3".to_owned(), index.cells[1].runs[0].train_id.to_string()]; // "a/b" names no folder
    let runs = index.cells.iter().map(|cell| RunFolder::new(root, &cell.runs[0].train_id).metrics().unwrap());
    names.iter().map(|name| root.join("tensorboard").join(name).join(FILE)).zip(runs).collect()
}

/// The lengths of the records in a file.
fn records(file: &Path) -> Vec<usize> {
    let (bytes, mut lengths, mut at) = (fs::read(file).unwrap(), Vec::new(), 0);
    while at < bytes.len() {
        let length = u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
        lengths.push(length);
        at += 8 + 4 + length + 4;
    }
    assert_eq!(at, bytes.len());
    lengths
}

#[test]
fn event_files_lie_beside_runs_and_change_nothing_in_them() {
    let folder = tempfile::tempdir().unwrap();
    let (plain, logged) = (results(folder.path(), "plain", &[]), results(folder.path(), "logged", &["--tensorboard"]));
    assert!(!plain.join("tensorboard").exists());
    for cell in Index::load(&plain).unwrap().cells {
        let [one, other] = [&plain, &logged].map(|root| RunFolder::new(root, &cell.runs[0].train_id));
        // It has the hashes of all that a run leaves behind.
        let done = |run: &RunFolder| fs::read(run.path().join("done")).unwrap();
        assert_eq!(done(&one), done(&other));
    }
    let lengths: Vec<_> = runs(&logged).iter().map(|(file, _)| records(file)).collect();
    assert!(lengths.iter().all(|lengths| lengths.len() == 1 + 4), "a header and four rows: {lengths:?}");
    // Of runs that are there already, too.
    results(folder.path(), "plain", &["--tensorboard"]);
    assert_eq!(runs(&plain).iter().map(|(file, _)| records(file)).collect::<Vec<_>>(), lengths);
}

#[test]
fn event_files_that_lack_rows_or_have_others_are_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let root = results(folder.path(), "out", &["--tensorboard"]);
    let [(file, _), (others, _)] = &runs(&root)[..] else { panic!("two runs") };
    let [whole, other] = [file, others].map(|path| fs::read(path).unwrap());
    let lengths = records(file);
    let header = lengths[0] + 16;
    let last_row = whole.len() - lengths.last().unwrap() - 16;
    let mut changed = whole.clone();
    *changed.last_mut().unwrap() ^= 1;
    let replaced = [
        ("nothing", vec![]),
        ("a header", whole[..header].to_vec()),
        ("cut off between rows", whole[..last_row].to_vec()),
        ("cut off in a row", whole[..whole.len() - 5].to_vec()),
        ("a row too many", [&whole[..], &whole[last_row..]].concat()),
        ("another run's rows", other.clone()),
        ("damage", changed),
    ];
    for (what, bytes) in replaced {
        fs::write(file, &bytes).unwrap();
        results(folder.path(), "out", &["--tensorboard"]);
        let mended = fs::read(file).unwrap();
        // The times of rows are not those of their writing any more; all else is.
        assert_eq!(records(file), lengths, "{what}");
        results(folder.path(), "out", &["--tensorboard"]);
        assert_eq!(fs::read(file).unwrap(), mended, "{what}: what is whole stays");
    }
    assert_eq!(fs::read(others).unwrap(), other, "and so do the others");
}

#[test]
#[ignore = "needs a Python with tensorboard, named by HEADWAY_PYTHON"]
fn tensorboard_reads_every_number() {
    let python = std::env::var("HEADWAY_PYTHON").expect("HEADWAY_PYTHON names a Python");
    let folder = tempfile::tempdir().unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/tensorboard/read.py");
    for (file, rows) in runs(&results(folder.path(), "out", &["--tensorboard"])) {
        let output = Command::new(&python).arg(script).arg(file.parent().unwrap()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let found: BTreeMap<String, Vec<(u64, f32)>> = serde_json::from_slice(&output.stdout).unwrap();
        let mut expected: BTreeMap<String, Vec<(u64, f32)>> = BTreeMap::new();
        for row in &rows {
            for (name, value) in row.scalars() {
                expected.entry(name).or_default().push((row.env_steps, value as f32));
            }
        }
        assert!(expected.len() >= 20 && expected.contains_key("dead_units/2"));
        assert_eq!(found, expected);
    }
}
