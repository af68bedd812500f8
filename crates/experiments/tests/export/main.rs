//! The tables that `export` writes, from runs of a small grid: they hold what the runs left behind, and other tools read them.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use headway_experiments::store::{Index, RunFolder};
use parquet::basic::{LogicalType, Repetition, Type as PhysicalType};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use serde_json::Value;

const SPEC: &str = r#"
name = "small"
seeds = { first = 3, count = 2 }
train = { n_steps = 2_000, log_every = 500 }
[evaluate]
n_episodes = 6
worlds = [
    { name = "room", time_limit = 20.0, world = { type = "room_10x15" } },
    { name = "empty", time_limit = 20.0, world = { type = "room", obstacles = { count = 0 } } },
]
[[axis]]
name = "driver"
[axis.levels]
"a/b" = { "agent.target" = "dqn" }
VFH = { "policy.type" = "vfh" }
"#;

/// A results folder `out`, and its tables in `tables`.
struct Bench(tempfile::TempDir);

impl Bench {
    /// The runs, made once for all tests.
    fn get() -> &'static Self {
        static BENCH: OnceLock<Bench> = OnceLock::new();
        BENCH.get_or_init(|| {
            let bench = Self(tempfile::tempdir().unwrap());
            fs::write(bench.path("spec.toml"), SPEC).unwrap();
            bench.succeed(&["run", "spec.toml", "--out", "out"]);
            bench.succeed(&["export", "out", "--out", "tables", "--drives", "2", "--drive", "*/room/3/5"]);
            bench
        })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn experiments(&self, args: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_experiments")).current_dir(self.0.path()).args(args).output().unwrap()
    }

    fn succeed(&self, args: &[&str]) -> String {
        let output = self.experiments(args);
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    fn table(&self, name: &str) -> Table {
        Table::read(&self.path("tables").join(name).with_extension("parquet"))
    }
}

/// A table as it is read: names with types, and rows.
struct Table {
    /// Names, types as in `docs/data.md`, and whether nulls are allowed.
    columns: Vec<(String, &'static str, bool)>,
    rows: Vec<BTreeMap<String, Field>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
        let schema = reader.metadata().file_metadata().schema().clone();
        let columns = schema.get_fields().iter().map(|field| {
            let kind = if field.is_group() {
                assert_eq!(field.get_basic_info().logical_type_ref(), Some(&LogicalType::List));
                "floats"
            } else {
                match field.get_physical_type() {
                    PhysicalType::BYTE_ARRAY => "text",
                    PhysicalType::INT64 => "integer",
                    PhysicalType::DOUBLE => "float",
                    PhysicalType::BOOLEAN => "flag",
                    other => panic!("{other}"),
                }
            };
            (field.name().to_owned(), kind, field.get_basic_info().repetition() == Repetition::OPTIONAL)
        });
        let rows = reader.get_row_iter(None).unwrap().map(|row| row.unwrap().into_columns().into_iter().collect());
        Self { columns: columns.collect(), rows: rows.collect() }
    }

    fn names_and_types(&self) -> Vec<(String, String)> {
        self.columns.iter().map(|(name, kind, _)| (name.clone(), (*kind).to_owned())).collect()
    }
}

/// A value as a CSV file has it.
fn text(field: &Field) -> String {
    match field {
        Field::Null => String::new(),
        Field::Str(text) => text.clone(),
        Field::ULong(number) => number.to_string(),
        Field::Double(number) => number.to_string(),
        Field::ListInternal(list) => list.elements().iter().map(text).collect::<Vec<_>>().join(" "),
        other => panic!("{other:?}"),
    }
}

fn number(row: &BTreeMap<String, Field>, column: &str) -> f64 {
    let Field::Double(number) = row[column] else { panic!("{column}: {:?}", row[column]) };
    number
}

/// Whether this field of a CSV file is that value; numbers may be written in several ways.
fn is_same(field: &str, value: &str) -> bool {
    let numbers = |text: &str| text.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
    field == value || numbers(field).is_some_and(|field| Some(field) == numbers(value))
}

/// A run, and the files of its episodes.
struct Run {
    cell: String,
    seed: u64,
    folder: RunFolder,
    /// By world.
    episodes: Vec<(String, PathBuf)>,
}

/// The runs of the grid, cell by cell.
fn runs(root: &Path) -> Vec<Run> {
    let mut runs = Vec::new();
    for cell in Index::load(root).unwrap().cells {
        for run in &cell.runs {
            let folder = RunFolder::new(root, &run.train_id);
            let csv = |id| folder.evaluation(id).path().join("episodes.csv");
            let episodes = cell.evaluations.iter().map(|its| (its.world.clone(), csv(&its.eval_id))).collect();
            runs.push(Run { cell: cell.axes[0].level.clone(), seed: run.seed, folder, episodes });
        }
    }
    runs
}

/// Checks that the next rows of a table are those of a CSV file, of this run.
fn assert_next(rows: &mut std::slice::Iter<'_, BTreeMap<String, Field>>, csv: &Path, of: &[(&str, String)]) {
    let mut reader = csv::Reader::from_path(csv).unwrap();
    let header = reader.headers().unwrap().clone();
    for record in reader.records() {
        let (row, record) = (rows.next().expect("as many rows"), record.unwrap());
        for (name, value) in of {
            assert_eq!(text(&row[*name]), *value, "{name}");
        }
        for (name, field) in header.iter().zip(&record) {
            assert!(is_same(field, &text(&row[name])), "{name}: {field} is not {:?}", row[name]);
        }
        assert_eq!(row.len(), of.len() + header.len());
    }
}

#[test]
fn episodes_and_training_are_those_of_the_runs() {
    let bench = Bench::get();
    let (episodes, training) = (bench.table("episodes"), bench.table("training"));
    // VFH learns nothing, and has one run.
    assert_eq!((episodes.rows.len(), training.rows.len()), ((2 + 1) * 2 * 6, 2 * 4));
    let (mut episodes, mut training) = (episodes.rows.iter(), training.rows.iter());
    for Run { cell, seed, folder, episodes: files } in runs(&bench.path("out")) {
        let id = folder.path().file_name().unwrap().to_str().unwrap().to_owned();
        let of = vec![("axis_driver", cell.clone()), ("cell", cell.clone()), ("seed", seed.to_string()), ("run", id)];
        for (world, csv) in files {
            assert_next(&mut episodes, &csv, &[&of[..], &[("world", world)]].concat());
        }
        if cell == "a/b" {
            assert_next(&mut training, &folder.metrics_path(), &of);
        }
    }
    assert!(episodes.next().is_none() && training.next().is_none());
}

#[test]
fn what_is_undefined_is_null() {
    let training = Bench::get().table("training");
    // Learning has not started in the first row.
    for column in ["loss", "mean_q", "grad_norm"] {
        assert_eq!(training.rows[0][column], Field::Null, "{column}");
    }
    let optional = training.columns.iter().filter(|(.., is_optional)| *is_optional).count();
    assert_eq!(optional, 3 + 10);
}

#[test]
fn steps_are_those_of_the_episodes() {
    let bench = Bench::get();
    let (episodes, steps) = (bench.table("episodes"), bench.table("steps"));
    let key = |row: &BTreeMap<String, Field>| ["cell", "world", "seed", "scenario"].map(|name| text(&row[name]));
    let mut drives: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for row in &steps.rows {
        assert_eq!(row["is_as_recorded"], Field::Bool(true));
        drives.entry(key(row)).or_default().push(row);
    }
    for cell in ["a/b", "VFH"] {
        assert!(drives.contains_key(&[cell, "room", "3", "5"].map(str::to_owned)), "asked for");
    }
    for (drive, rows) in &drives {
        let episode = episodes.rows.iter().find(|row| key(row) == *drive).unwrap();
        let (last, before) = rows.split_last().unwrap();
        assert!((number(last, "t") - number(episode, "duration")).abs() < 1e-9);
        let way: f64 = rows
            .windows(2)
            .map(|two| (number(two[1], "x") - number(two[0], "x")).hypot(number(two[1], "y") - number(two[0], "y")))
            .sum();
        let driven = number(episode, "distance");
        assert!(way <= driven + 1e-9 && way >= 0.8 * driven, "chords of the path: {way} m of {driven} m");
        for (k, row) in (0..).zip(rows) {
            assert_eq!(row["step"], Field::ULong(k));
        }
        for column in ["commanded_speed", "commanded_lateral_speed", "commanded_yaw_rate", "action"] {
            assert_eq!(last[column], Field::Null);
        }
        assert!(before.iter().all(|row| number(row, "commanded_speed").is_finite()));
        assert!(before.iter().all(|row| (row["action"] == Field::Null) == (drive[0] == "VFH")));
    }
}

/// The names and types in the table below a heading of `docs/data.md`.
fn documented(heading: &str) -> Vec<(String, String)> {
    let docs = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/data.md")).unwrap();
    let section = docs.split(&format!("## {heading}\n")).nth(1).unwrap().split("\n## ").next().unwrap().to_owned();
    let row = |line: &str| {
        let mut cells = line.strip_prefix("| `")?.split(" | ");
        let name = cells.next()?.trim_end_matches('`').replace("axis_NAME", "axis_driver");
        Some((name, cells.next()?.to_owned()))
    };
    section.lines().filter_map(row).collect()
}

#[test]
fn every_column_is_documented_with_its_type() {
    let bench = Bench::get();
    let (of_run, world) = (documented("Parquet files of all runs"), vec![("world".to_owned(), "text".to_owned())]);
    let expect = |table: &str, parts: &[Vec<(String, String)>]| {
        assert_eq!(bench.table(table).names_and_types(), parts.concat(), "{table}");
    };
    expect("episodes", &[of_run.clone(), world, documented("episodes.csv")]);
    expect("training", &[of_run.clone(), documented("metrics.csv")]);
    expect("steps", &[of_run, documented("steps.parquet")]);
}

#[test]
fn equal_results_give_equal_bytes() {
    let bench = Bench::get();
    let names = ["episodes", "training", "steps"];
    let printed = bench.succeed(&["export", "out", "--drives", "2", "--drive", "*/room/3/5"]);
    assert!(names.iter().all(|name| printed.contains(&format!("out/tables/{name}.parquet ("))), "{printed}");
    for name in names {
        let bytes = |folder: &str| fs::read(bench.path(folder).join(name).with_extension("parquet")).unwrap();
        assert!(bytes("tables") == bytes("out/tables"), "{name}");
    }
}

#[test]
fn bad_input_is_refused_and_writes_nothing() {
    let bench = Bench::get();
    fs::create_dir_all(bench.path("nothing")).unwrap();
    fs::write(bench.path("file"), "").unwrap();
    for (args, message) in [
        (&["missing"][..], "there is no folder `missing`"),
        (&["nothing"], "`nothing` holds no results: there is no index.json in it"),
        (&["out", "--out", "file"], "--out file: is a file; give a folder"),
        (&["out", "--out", "new", "--drive", "c/room/3/0"], "--drive: there is no cell `c`; there are a/b; VFH"),
    ] {
        let output = bench.experiments(&[&["export"], args].concat());
        assert_eq!(String::from_utf8_lossy(&output.stderr), format!("error: {message}\n"));
        assert_eq!(output.status.code(), Some(2));
    }
    assert!(!bench.path("new").exists() && !bench.path("nothing/tables").exists());
}

/// A folder with tables of an earlier export, which are one word each.
fn with_old_tables(bench: &Bench, folder: &str, names: &[&str]) {
    fs::create_dir_all(bench.path(folder)).unwrap();
    for name in names {
        fs::write(bench.path(folder).join(name), "old").unwrap();
    }
}

fn files_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Found when the last of them was to be put in its place: the others were new by then.
#[test]
fn a_folder_in_a_tables_place_is_refused_before_any_is_replaced() {
    let bench = Bench::get();
    with_old_tables(bench, "blocked", &["episodes.parquet", "training.parquet"]);
    fs::create_dir_all(bench.path("blocked/steps.parquet")).unwrap();
    let output = bench.experiments(&["export", "out", "--out", "blocked"]);
    let message = "error: `blocked/steps.parquet` is a folder; a table belongs there\n";
    assert_eq!((output.status.code(), &String::from_utf8_lossy(&output.stderr)[..]), (Some(2), message));
    assert_eq!(files_in(&bench.path("blocked")), ["episodes.parquet", "steps.parquet", "training.parquet"]);
    assert_eq!(fs::read_to_string(bench.path("blocked/episodes.parquet")).unwrap(), "old");
}

/// A full disk at the last table left the others new, and what was half-written.
#[test]
#[cfg(target_os = "linux")]
fn tables_are_replaced_together_or_not_at_all() {
    let (bench, names) = (Bench::get(), ["episodes.parquet", "steps.parquet", "training.parquet"]);
    with_old_tables(bench, "full", &names);
    std::os::unix::fs::symlink("/dev/full", bench.path("full/steps.parquet.partial")).unwrap();
    let output = bench.experiments(&["export", "out", "--out", "full"]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("error: full/steps.parquet: cannot write: "), "{message}");
    assert!(message.contains("No space left"), "{message}");
    assert_eq!(files_in(&bench.path("full")), names);
    for name in names {
        assert_eq!(fs::read_to_string(bench.path("full").join(name)).unwrap(), "old", "{name}");
    }
}

#[test]
#[ignore = "needs a Python with polars and duckdb, named by HEADWAY_PYTHON"]
fn polars_and_duckdb_find_what_the_report_says() {
    let python = std::env::var("HEADWAY_PYTHON").expect("HEADWAY_PYTHON names a Python");
    let bench = Bench::get();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/read.py");
    let output = Command::new(python).arg(script).arg(bench.path("tables")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let report: Value = serde_json::from_str(&bench.succeed(&["report", "out", "--format", "json"])).unwrap();
    let tables = ["episodes", "training", "steps"].map(|name| bench.table(name));
    let n_actions = tables[2].rows.iter().filter(|row| row["action"] != Field::Null).count();
    let dead_units = tables[1].rows.iter().map(|row| match &row["dead_units"] {
        Field::ListInternal(list) => list.elements().iter().map(text).map(|share| share.parse::<f64>().unwrap()).sum(),
        _ => 0.0,
    });
    let dead_units: f64 = dead_units.sum();
    for tool in ["polars", "duckdb"] {
        let found = &found[tool];
        for (name, table) in ["episodes", "training", "steps"].iter().zip(&tables) {
            assert_eq!(found["rows"][name], table.rows.len(), "{tool}: {name}");
        }
        assert_eq!(found["actions"], n_actions, "{tool}");
        assert!((found["dead_units"].as_f64().unwrap() - dead_units).abs() < 1e-9, "{tool}");
        for row in report.as_array().unwrap() {
            let (cell, world) = (row["axes"]["driver"].as_str().unwrap(), row["world"].as_str().unwrap());
            let (mean, expected) = (&found["success"][cell][world], &row["success"]["mean"]);
            assert!((mean.as_f64().unwrap() - expected.as_f64().unwrap()).abs() < 1e-12, "{tool}: {cell}, {world}");
        }
    }
}
