//! The shortest way through a world, by which times are measured.

use std::fs;
use std::path::{Path, PathBuf};

use headway_planning::{GridMap, plan};
use headway_sim::{Footprint, Point, World};
use serde::Serialize;

use super::score::REFERENCE_SPEED;
use super::{GOAL, START};
use crate::Error;

/// The shortest way from the start to the goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    /// Its length, metres.
    pub length: f64,
    /// Where that came from.
    pub source: Source,
}

/// Where the length of a reference came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// A path file.
    File,
    /// A path of our own: the shortest way over the true map, on a grid of 5 cm, for the largest disc within the footprint, pulled
    /// straight.
    Planned,
}

/// Cells that a path may have.
const MAX_CELLS: u64 = 1_000_000;
/// Bytes that a path file may have.
const MAX_BYTES: u64 = 32 << 20;
/// Edge of a cell of the grid of our own plans, metres.
const CELL: f64 = 0.05;

impl Reference {
    /// The path file of a world by its name, in `../paths` or `paths` beside or in one of two folders.
    pub(super) fn file(world: &str, folders: [&Path; 2]) -> Option<PathBuf> {
        let digits = world.trim_start_matches(|c: char| !c.is_ascii_digit());
        if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        let name = format!("path_{digits}.npy");
        let mut places = folders.into_iter().flat_map(|folder| [folder.join("../paths"), folder.join("paths")]);
        places.find_map(|folder| Some(folder.join(&name)).filter(|path| path.is_file()))
    }

    /// That of a path file.
    ///
    /// # Errors
    /// If the file cannot be read or holds no path.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Ok(Self { length: length_of_cells(&read_cells(path)?), source: Source::File })
    }

    /// One of our own: [`Source::Planned`]. `None` if no such disc gets through.
    #[must_use]
    pub fn plan(world: &World, footprint: &Footprint) -> Option<Self> {
        let map = GridMap::from_world(world, CELL, footprint.inradius());
        let route = plan(&map, &Point::new(START[0], START[1]), &Point::from(GOAL))?;
        Some(Self { length: route.length(), source: Source::Planned })
    }

    /// The time of the way at the speed that the protocol assumes, 2 m/s, in seconds: `OT` of the scores.
    ///
    /// ```
    /// use headway_experiments::protocol::barn::{Reference, Source};
    /// assert_eq!(Reference { length: 10.5, source: Source::File }.optimal_time(), 5.25);
    /// ```
    #[must_use]
    pub fn optimal_time(&self) -> f64 {
        self.length / REFERENCE_SPEED
    }
}

/// The length of a published path, metres: from the start over the middles of its cells to the goal, where cell (i, j) lies at
/// `x = 0.15 i - 4.575`, `y = 0.15 j + 5.075`.
fn length_of_cells(cells: &[[i64; 2]]) -> f64 {
    let middle = |[i, j]: &[i64; 2]| [0.15 * *i as f64 - 4.575, 0.15 * *j as f64 + 5.075];
    let ends = ([START[0], START[1]], GOAL);
    let points: Vec<[f64; 2]> = [ends.0].into_iter().chain(cells.iter().map(middle)).chain([ends.1]).collect();
    points.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum()
}

/// The cells of a path file: an array of whole numbers, 8 bytes each, of shape [n, 2], as numpy saves it.
fn read_cells(path: &Path) -> Result<Vec<[i64; 2]>, Error> {
    let bad = |what: String| Error::Input(format!("{}: {what}", path.display()));
    let io = |error| Error::io("read", path, error);
    if fs::metadata(path).map_err(io)?.len() > MAX_BYTES {
        return Err(bad(format!("larger than {MAX_BYTES} bytes, which no path is")));
    }
    let bytes = fs::read(path).map_err(io)?;
    let file = npyz::NpyFile::new(&bytes[..]).map_err(|error| bad(format!("not a .npy file: {error}")))?;
    let (shape, order) = (file.shape().to_vec(), file.order());
    let n_cells = match shape[..] {
        [n, 2] if (1..=MAX_CELLS).contains(&n) => n as usize,
        _ => return Err(bad(format!("an array of shape {shape:?}; a path has the shape [n, 2]"))),
    };
    let numbers = file.data::<i64>().map_err(|error| bad(format!("not 64-bit whole numbers: {error}")))?;
    let numbers: Vec<i64> = numbers.collect::<Result<_, _>>().map_err(|error| bad(format!("cut short: {error}")))?;
    let at = |cell: usize, axis: usize| match order {
        npyz::Order::C => numbers[2 * cell + axis],
        npyz::Order::Fortran => numbers[axis * n_cells + cell],
    };
    Ok((0..n_cells).map(|cell| [at(cell, 0), at(cell, 1)]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use npyz::WriterBuilder;

    fn write(path: &Path, shape: &[u64], numbers: &[i64], order: npyz::Order) {
        let mut bytes = Vec::new();
        let mut writer =
            npyz::WriteOptions::new().default_dtype().shape(shape).order(order).writer(&mut bytes).begin_nd().unwrap();
        writer.extend(numbers.iter().copied()).unwrap();
        writer.finish().unwrap();
        fs::write(path, bytes).unwrap();
    }

    #[test]
    fn the_length_by_hand() {
        // Straight up from (-2, 3) to (-2, 13): through no cell at all.
        assert_eq!(length_of_cells(&[]), 10.0);
        // By way of (-4.575, 5.075): cell (0, 0).
        let expected = 2.575f64.hypot(2.075) + 2.575f64.hypot(7.925);
        assert!((length_of_cells(&[[0, 0]]) - expected).abs() < 1e-12);
        // Two cells beside each other.
        // At x = -2.325 and -2.175.
        let expected = 0.325f64.hypot(2.075) + 0.15 + 0.175f64.hypot(7.925);
        assert!((length_of_cells(&[[15, 0], [16, 0]]) - expected).abs() < 1e-12);
    }

    #[test]
    fn path_files_are_read_in_either_order_and_found_by_number() {
        let folder = tempfile::tempdir().unwrap();
        let worlds = folder.path().join("worlds");
        fs::create_dir_all(&worlds).unwrap();
        fs::create_dir_all(folder.path().join("paths")).unwrap();
        let path = folder.path().join("paths/path_3.npy");
        write(&path, &[3, 2], &[1, 2, 3, 4, 5, 6], npyz::Order::C);
        assert_eq!(read_cells(&path).unwrap(), [[1, 2], [3, 4], [5, 6]]);
        write(&path, &[3, 2], &[1, 3, 5, 2, 4, 6], npyz::Order::Fortran);
        assert_eq!(read_cells(&path).unwrap(), [[1, 2], [3, 4], [5, 6]]);
        let length = length_of_cells(&[[1, 2], [3, 4], [5, 6]]);
        for given in [&worlds, folder.path()] {
            let found = Reference::file("world_3", [given, &worlds]).unwrap();
            assert_eq!(Reference::read(&found).unwrap(), Reference { length, source: Source::File });
        }
        for name in ["world_4", "world_33", "yard", "world_3b"] {
            assert_eq!(Reference::file(name, [&worlds, &worlds]), None, "{name}");
        }
    }

    #[test]
    fn what_is_no_path_is_refused_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("path_1.npy");
        let refusal = || read_cells(&path).unwrap_err().to_string();
        fs::write(&path, "no numbers").unwrap();
        assert!(refusal().contains("path_1.npy: not a .npy file"), "{}", refusal());
        write(&path, &[2, 3], &[0; 6], npyz::Order::C);
        assert!(refusal().ends_with("an array of shape [2, 3]; a path has the shape [n, 2]"), "{}", refusal());
        write(&path, &[2, 2], &[0; 4], npyz::Order::C);
        let bytes = fs::read(&path).unwrap();
        fs::write(&path, &bytes[..bytes.len() - 8]).unwrap();
        assert!(refusal().contains("cut short"), "{}", refusal());
    }
}
