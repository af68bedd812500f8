//! Files, worlds, and what is written where.

use std::fs;

use tempfile::TempDir;

use crate::{check_all, experiments};

#[test]
fn impossible_scenarios() {
    let giant = "type = \"room\"\nwidth = 10\nheight = 10\nobstacle_radius = 6\nobstacles = { count = 3 }";
    let problem = "cannot place";
    for (table, place) in [
        (format!("[world]\n{giant}"), "spec.toml:1: world: "),
        (
            format!("[[evaluate.worlds]]\nname = \"a\"\ntime_limit = 60\n[evaluate.worlds.world]\n{giant}"),
            "spec.toml:4: evaluate.worlds.0.world: ",
        ),
    ] {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("spec.toml"), table).unwrap();
        let output = experiments(folder.path(), &["check", "spec.toml"]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(stderr.starts_with(&format!("error: {place}{problem}")), "{stderr}");
        assert_eq!(output.status.code(), Some(2));
    }
}

#[test]
fn files() {
    check_all(&[
        (
            "base = \"missing.toml\"",
            &[],
            "spec.toml:1: base = \"missing.toml\": cannot read the base missing.toml: No such file or directory (os \
             error 2)",
        ),
        ("base = 3", &[], "spec.toml:1: base = 3: must be a string: the path of a spec file, relative to this one"),
        ("base = \"spec.toml\"", &[], "spec.toml:1: base = \"spec.toml\": is a cycle: spec.toml -> spec.toml"),
        (
            "[agent]\ngamma = 0.9\ngamma = 0.8",
            &[],
            "spec.toml:3: not valid TOML: duplicate key `gamma`; levels, like all keys, need names of their own",
        ),
        ("[agent\ngamma = 0.9", &[], "spec.toml:1: not valid TOML: unclosed table, expected `]`"),
        (
            "\nseeds = { first = 18446744073709551615, count = 1 }",
            &[],
            "spec.toml:2: seeds.first = 18446744073709551615: whole numbers reach from -2^63 to 2^63 - 1",
        ),
    ]);
    let folder = TempDir::new().unwrap();
    let output = experiments(folder.path(), &["check", "missing.toml"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(stderr, "error: missing.toml: cannot read the spec: No such file or directory (os error 2)\n");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_fault_of_a_base_is_placed_in_the_base() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("base.toml"), "\n[agent]\ngamma = 3").unwrap();
    fs::write(folder.path().join("leaf.toml"), "base = \"base.toml\"\n[agent]\nn_step = 1").unwrap();
    let output = experiments(folder.path(), &["check", "leaf.toml"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(stderr, "error: base.toml:3: agent.gamma = 3.0: must be in [0, 1]\n");
}

#[test]
fn a_run_of_a_bad_spec_creates_no_folder() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("spec.toml"), "[agent]\ngamma = 3").unwrap();
    let output = experiments(folder.path(), &["run", "spec.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(!folder.path().join("out").exists());
}

#[test]
fn a_metric_that_is_none_is_met_with_their_names() {
    let folder = TempDir::new().unwrap();
    let output = experiments(folder.path(), &["compare", "results", "--over", "reward", "--metric", "success,speed"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    let expected = "error: invalid value 'speed' for '--metric <NAME[,NAME]...>': must be one of success, collision,";
    assert!(stderr.starts_with(expected), "{stderr}");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_list_of_runs_is_no_page() {
    let folder = TempDir::new().unwrap();
    let output = experiments(folder.path(), &["report", "results", "--runs", "--format", "html"]);
    assert_eq!(String::from_utf8_lossy(&output.stderr), "error: --runs goes with --format table, json or csv\n");
    assert_eq!(output.status.code(), Some(2));
}

/// The help said "one object", which it is not.
#[test]
fn the_help_says_what_the_json_is() {
    let folder = TempDir::new().unwrap();
    for (command, said) in [
        ("report", "JSON, a list of objects: one per cell and world"),
        ("evaluate", "a list of objects, one per world"),
        ("evaluate", "over_worlds    95 % intervals with the world as the unit"),
    ] {
        let help = String::from_utf8(experiments(folder.path(), &[command, "--help"]).stdout).unwrap();
        assert!(help.contains(said), "{help}");
    }
}
