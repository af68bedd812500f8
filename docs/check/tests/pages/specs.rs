//! Pieces of specs: laid over specs/default.toml, each is one that loads.

use std::fs;

use headway_experiments::spec::Grid;
use smooth_rewards as _; // docs/plugins.md names one of its rewards
use tempfile::TempDir;
use toml::Table;

use super::code::{files, from_root, of_pages};

/// A folder with the specs that a piece may be based on, and world files in `worlds`.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    for spec in files("specs", "toml") {
        fs::copy(&spec, folder.path().join(spec.file_name().unwrap())).unwrap();
    }
    fs::create_dir(folder.path().join("worlds")).unwrap();
    for name in ["a", "b", "c"] {
        let world = folder.path().join(format!("worlds/{name}.sdf"));
        fs::copy(from_root("fuzz/seeds/sdf/ours.sdf"), world).unwrap();
    }
    folder
}

#[test]
fn every_piece_of_a_spec_loads() {
    let folder = folder();
    let spec = folder.path().join("piece.toml");
    let blocks: Vec<_> = of_pages().into_iter().filter(|code| code.is_in("toml")).collect();
    let mut n_pieces = 0;
    for block in blocks {
        let table: Table = block.text.parse().unwrap_or_else(|error| panic!("{}: {error}", block.place));
        if table.contains_key("dependencies") {
            continue; // of a Cargo.toml
        }
        let base = if table.contains_key("base") { "" } else { "base = \"default.toml\"\n" };
        // Paths of worlds are those of the working directory.
        let worlds = format!("{:?}", folder.path().join("worlds"));
        fs::write(&spec, format!("{base}{}", block.text.replace("\"worlds\"", &worlds))).unwrap();
        Grid::load(&spec, &[]).unwrap_or_else(|error| panic!("{}: {error}", block.place));
        n_pieces += 1;
    }
    assert!(n_pieces >= 4, "only {n_pieces} were found");
}
