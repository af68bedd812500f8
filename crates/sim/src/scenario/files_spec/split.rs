//! Files for training and files for tests.

use std::collections::HashMap;
use std::path::PathBuf;

use super::FilePart;
use crate::stream_seed;

/// The files of a part, in their order; the `n_test` files with the lowest draws are those for tests.
pub(super) fn part(files: Vec<PathBuf>, part: FilePart, n_test: usize, seed: u64) -> Vec<PathBuf> {
    let draws = draws(&files, seed);
    let mut order: Vec<usize> = (0..files.len()).collect();
    order.sort_by_key(|index| draws[*index]);
    let mut is_test = vec![false; files.len()];
    order[..n_test].iter().for_each(|index| is_test[*index] = true);
    let is_in = |is_test: bool| match part {
        FilePart::All => true,
        FilePart::Train => !is_test,
        FilePart::Test => is_test,
    };
    files.into_iter().zip(is_test).filter(|(_, is_test)| is_in(*is_test)).map(|(path, _)| path).collect()
}

/// A number for each file that depends on the seed, its name without the ending, and which of the files of this name it
/// is, and on no other file.
fn draws(files: &[PathBuf], seed: u64) -> Vec<u64> {
    let mut n_seen = HashMap::<String, u64>::new();
    let draw = |path: &PathBuf| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let of_name = name.as_bytes().chunks(8).fold(seed, |seed, chunk| {
            let mut bytes = [0; 8];
            bytes[..chunk.len()].copy_from_slice(chunk);
            stream_seed(seed, "split", u64::from_le_bytes(bytes))
        });
        let number = n_seen.entry(name).or_default();
        *number += 1;
        stream_seed(of_name, "split-number", *number)
    };
    files.iter().map(draw).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(n: usize) -> Vec<PathBuf> {
        (0..n).map(|k| format!("worlds/a_rather_long_name_of_world_{k}.world").into()).collect()
    }

    #[test]
    fn a_file_more_moves_one_other_at_most() {
        for n in 2..60 {
            let [before, after] = [n, n + 1].map(|n| part(names(n), FilePart::Test, n.div_ceil(5), 3));
            let n_moved = names(n).iter().filter(|name| before.contains(name) != after.contains(name)).count();
            assert!(n_moved <= 1, "{n_moved} of {n}");
        }
    }

    #[test]
    fn draws_are_of_names_alone() {
        let all = draws(&names(20), 1);
        assert_eq!(draws(&names(20)[7..9], 1), all[7..9]);
        assert_ne!(draws(&names(20), 2), all);
        // The folder and the ending do not count, the number of equal names does: not all of them go the same way.
        let paths = ["a/map.yaml", "b/map.yaml", "map.world"].map(PathBuf::from);
        let same = draws(&paths, 1);
        assert!(same[0] != same[1] && same[1] != same[2]);
        assert_eq!(draws(&paths[2..], 1), same[..1]);
    }

    #[test]
    fn each_file_is_drawn_as_often() {
        let mut counts = [0; 10];
        for seed in 0..1000 {
            for path in part(names(10), FilePart::Test, 3, seed) {
                counts[names(10).iter().position(|name| *name == path).unwrap()] += 1;
            }
        }
        // 300 expected, with a standard deviation of 14.5.
        assert!(counts.iter().all(|count| (230..370).contains(count)), "{counts:?}");
    }
}
