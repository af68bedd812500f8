//! What the worlds of a grid lack of their files.

use std::collections::BTreeSet;
use std::fmt::Write;

use headway_sim::WorldSpec;

use crate::Error;
use crate::spec::{Grid, RunSpec};

/// Entries that are told; the others are counted.
const N_TOLD: usize = 20;

/// What the world files of a grid hold and its worlds do not, since `unsupported = "ignore"` allows it, as lines of text; empty
/// where that is nothing.
///
/// # Errors
/// If a file can no longer be read.
pub(super) fn in_words(grid: &Grid) -> Result<String, Error> {
    let mut entries = BTreeSet::new();
    let mut seen: Vec<(&WorldSpec, &RunSpec)> = Vec::new();
    for spec in grid.cells.iter().map(|cell| &cell.spec) {
        for world in worlds(spec).filter(|world| has_files(world)) {
            if seen.iter().any(|(known, by)| *known == world && by.vehicle == spec.vehicle) {
                continue;
            }
            seen.push((world, spec));
            let vehicle = spec.vehicle.build().map_err(Error::failure)?;
            let source = world.build(vehicle.footprint()).map_err(|error| Error::Input(error.to_string()))?;
            entries.extend(source.left_out());
        }
    }
    Ok(listed(&entries))
}

/// The worlds that a run trains and is evaluated in.
fn worlds(spec: &RunSpec) -> impl Iterator<Item = &WorldSpec> {
    let training = std::iter::once(&spec.world).chain(spec.train.curriculum.iter().map(|stage| &stage.world));
    let training = training.filter(|_| spec.policy.is_learned());
    training.chain(spec.evaluate.worlds.iter().map(|world| &world.world))
}

fn has_files(world: &WorldSpec) -> bool {
    match world {
        WorldSpec::Files(_) => true,
        WorldSpec::Mixture { worlds } => worlds.iter().any(|part| has_files(&part.world)),
        _ => false,
    }
}

fn listed(entries: &BTreeSet<String>) -> String {
    if entries.is_empty() {
        return String::new();
    }
    // Writing to a string cannot fail.
    let mut text = format!("left out of the world files, as `unsupported = \"ignore\"` has it: {}\n", entries.len());
    for entry in entries.iter().take(N_TOLD) {
        let _ = writeln!(text, "  {entry}");
    }
    if let Some(more @ 1..) = entries.len().checked_sub(N_TOLD) {
        let _ = writeln!(text, "  and {more} more");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_entries_are_counted() {
        let entries = |n: usize| (0..n).map(|k| format!("a.world: mesh '{k:02}.dae'")).collect();
        assert_eq!(listed(&entries(0)), "");
        let text = listed(&entries(N_TOLD + 2));
        assert!(text.contains("has it: 22\n") && text.ends_with("'19.dae'\n  and 2 more\n"), "{text}");
        assert!(!listed(&entries(N_TOLD)).contains("more"));
    }
}
