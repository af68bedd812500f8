//! `index.json`: which runs and evaluations belong to which cell of the grid.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::Id;
use super::error::{StoreError, at, unreadable};

/// The name of the index in the results folder.
pub(super) const FILE: &str = "index.json";

/// The grid that a results folder holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Index {
    /// The grid's name.
    pub name: String,
    /// The axes in the order of the grid.
    pub axes: Vec<GridAxis>,
    /// The cells in the order of the grid.
    pub cells: Vec<Cell>,
}

/// One axis of a grid.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GridAxis {
    /// The axis's name.
    pub name: String,
    /// The names of its levels, in the order of the grid.
    pub levels: Vec<String>,
}

/// One cell of a grid: a level of each axis, run with every seed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cell {
    /// The levels, in the order of the axes.
    pub axes: Vec<AxisLevel>,
    /// The training runs, in the order of the seeds.
    pub runs: Vec<IndexedRun>,
    /// The evaluations that each of the runs undergoes, in the order of the spec.
    pub evaluations: Vec<IndexedEvaluation>,
}

/// The level of one axis.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisLevel {
    /// The axis's name.
    pub axis: String,
    /// The level's name.
    pub level: String,
}

/// One training run of a cell.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IndexedRun {
    /// The seed.
    pub seed: u64,
    /// The run's folder.
    pub train_id: Id,
}

/// One evaluation of a cell's runs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IndexedEvaluation {
    /// The name of the evaluation's world.
    pub world: String,
    /// The evaluation's folder within each run's.
    pub eval_id: Id,
}

impl Index {
    /// Reads the index of the results folder at `root`; needs no lock.
    ///
    /// # Errors
    /// [`StoreError::NoFolder`] and [`StoreError::NoIndex`] if there is none, [`StoreError::Io`], and [`StoreError::Parse`] if it is not what this
    /// version writes.
    pub fn load(root: &Path) -> Result<Self, StoreError> {
        let path = root.join(FILE);
        match fs::read(&path) {
            Ok(bytes) => {
                let index: Self = serde_json::from_slice(&bytes).map_err(unreadable(&path))?;
                index.check().map_err(unreadable(&path))?;
                Ok(index)
            }
            Err(_) if !root.is_dir() => Err(StoreError::NoFolder { folder: root.to_owned() }),
            Err(error) if error.kind() == ErrorKind::NotFound => Err(StoreError::NoIndex { folder: root.to_owned() }),
            Err(error) => Err(at("read", &path)(error)),
        }
    }

    /// Whether every cell has a level of each axis, in their order.
    fn check(&self) -> Result<(), String> {
        let names = || self.axes.iter().map(|axis| &axis.name);
        let wrong = self.cells.iter().position(|cell| !names().eq(cell.axes.iter().map(|level| &level.axis)));
        wrong.map_or(Ok(()), |i| Err(format!("cells[{i}].axes are not those of the grid")))
    }
}
