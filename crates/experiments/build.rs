//! Tells the crate which revision of the code it is built from.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=HEADWAY_REVISION={}", revision().unwrap_or_else(|| "unknown".into()));
}

/// The short hash of the checked-out commit, if this crate is built from a checkout of its own workspace.
fn revision() -> Option<String> {
    // A crate unpacked by cargo may lie inside a repository that has nothing to do with it.
    let is_checkout = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.git").exists();
    let revision = is_checkout.then(|| git(&["rev-parse", "--short", "HEAD"])).flatten()?;
    // The log of HEAD grows with every commit and checkout, HEAD itself only with some.
    for file in ["logs/HEAD", "HEAD"] {
        if let Some(path) = git(&["rev-parse", "--git-path", file]).filter(|path| Path::new(path).exists()) {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    Some(revision)
}

fn git(args: &[&str]) -> Option<String> {
    let output = Command::new("git").args(args).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
