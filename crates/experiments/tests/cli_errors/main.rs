//! Bad input: one message that names file, place, value and what is allowed; exit code 2; nothing written.

mod files;
mod grids;
mod values;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// Runs the binary in `folder`, its messages without colours.
fn experiments(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    command.args(args).current_dir(folder).env_remove("CLICOLOR_FORCE").output().unwrap()
}

/// Checks that `check spec.toml ARGS` refuses this file with this message.
fn assert_refused(text: &str, args: &[&str], expected: &str) {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("spec.toml"), text).unwrap();
    let output = experiments(folder.path(), &[&["check", "spec.toml"], args].concat());
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(stderr, format!("error: {expected}\n"), "for\n{text}\n{args:?}");
    assert_eq!(output.status.code(), Some(2), "{expected}");
    assert!(output.stdout.is_empty(), "{expected}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "something was written: {expected}");
}

/// The file, the options, and the message.
type Case = (&'static str, &'static [&'static str], &'static str);

fn check_all(cases: &[Case]) {
    for (text, args, expected) in cases {
        assert_refused(text, args, expected);
    }
}
