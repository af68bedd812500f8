//! World files in a folder.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};

use super::disk::Kind;
use super::{FileError, FileProblem};

/// The world files of a folder, by the endings that [`read`](super::read) knows, in natural order: `world_3` before
/// `world_15`.
///
/// # Errors
/// If the folder cannot be read.
pub fn list(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    let failed = |e: std::io::Error| FileError::at("", FileProblem::Unreadable(e.to_string())).in_file(folder);
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_file() && Kind::of(&path).is_ok() {
            paths.push(path);
        }
    }
    paths.sort_by_cached_key(|path| NaturalKey::new(&path.file_name().unwrap_or_default().to_string_lossy()));
    Ok(paths)
}

/// A name that is compared by its parts, runs of digits as numbers of any length.
#[derive(Debug, PartialEq, Eq)]
struct NaturalKey {
    parts: Vec<Part>,
    name: String,
}

#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    /// Without leading zeros, the number of digits first.
    Number(usize, String),
    Text(String),
}

impl NaturalKey {
    fn new(name: &str) -> Self {
        let chars: Vec<char> = name.chars().collect();
        let runs = chars.chunk_by(|a, b| a.is_ascii_digit() == b.is_ascii_digit());
        let part = |run: &[char]| {
            let text: String = run.iter().collect();
            if !run[0].is_ascii_digit() {
                return Part::Text(text);
            }
            let digits = text.trim_start_matches('0');
            Part::Number(digits.len(), digits.to_owned())
        };
        Self { parts: runs.map(part).collect(), name: name.to_owned() }
    }
}

impl Ord for NaturalKey {
    fn cmp(&self, other: &Self) -> Ordering {
        self.parts.cmp(&other.parts).then_with(|| self.name.cmp(&other.name))
    }
}

impl PartialOrd for NaturalKey {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_compared_as_numbers() {
        let mut names =
            ["w_15.world", "w_3.world", "w_03.world", "a.sdf", "w_3b.world", "w_300.world", "2.yaml", "10.yaml"];
        names.sort_by_cached_key(|name| NaturalKey::new(name));
        let sorted =
            ["2.yaml", "10.yaml", "a.sdf", "w_03.world", "w_3.world", "w_3b.world", "w_15.world", "w_300.world"];
        assert_eq!(names, sorted);
    }
}
