//! The results folder: which runs there are, what each left behind, and when it counts as finished.
//!
//! ```text
//! results/
//!   index.json                     the grid: axes, cells, seeds, and the ids of their runs and evaluations
//!   runs/<train id>/               one training run
//!     spec.toml                    its resolved training spec
//!     run.json                     seed, versions, code revision
//!     metrics.csv                  one row per logging interval
//!     policy.safetensors           what it learned
//!     collapse.json                how it had collapsed by the end; `[]` if it had not
//!     timing.json                  wall and CPU seconds of the training, dates
//!     done                         written last: the hashes of the files beside it
//!     evaluations/<eval id>/       one evaluation of that policy
//!       spec.toml  episodes.csv  timing.json  done
//!   tensorboard/<cell, seed>/      the metrics again, if wanted, with the times of their rows
//! ```
//!
//! Ids are hashes of all that determines a result, so that the same run is never made twice. What has no `done` is
//! half-written, and what is not as its `done` says is damaged: both are made anew. Apart from `timing.json`, files depend on nothing but their id and the
//! code's revision.

mod atomic;
mod done;
mod error;
mod id;
mod index;
mod lock;
mod run;
mod timing;

pub use done::State;
pub(crate) use done::digest;
pub use error::StoreError;
pub(crate) use error::damage;
pub use id::{EvaluationKey, Id, TrainKey};
pub use index::{AxisLevel, Cell, GridAxis, Index, IndexedEvaluation, IndexedRun};
pub use run::{EvaluationFolder, MetricsWriter, PendingRun, RunFolder, RunInfo};
pub use timing::{Stopwatch, Timing};

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use atomic::write_atomically;
use error::at;

/// The version of what runs compute: raised by hand whenever the same spec and seed would give other results.
pub const RESULTS_VERSION: u32 = 4;

/// The revision of the code, as git abbreviates it; `unknown` where it was built without git.
pub const CODE_REVISION: &str = env!("HEADWAY_REVISION");

/// A results folder, held for writing by this process until it is dropped.
///
/// Reading needs no lock: [`Index::load`] and [`RunFolder`] work beside a process that writes.
///
/// ```
/// use headway_experiments::store::{Store, TrainKey};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = tempfile::tempdir()?;
/// let store = Store::open(folder.path())?;
/// let key = TrainKey { spec: &[("gamma", 0.95)], seed: 0, reward_version: 1 };
/// let run = store.run(&key.id()?);
/// assert!(!run.is_complete());
/// assert!(Store::open(folder.path()).is_err()); // in use
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Store {
    root: PathBuf,
    /// The operating system frees the lock when the file is closed, however the process ends.
    _lock: File,
}

impl Store {
    /// Opens the results folder at `root`, which it creates if need be, and locks it.
    ///
    /// # Errors
    /// [`StoreError::Io`] if the folder cannot be created or written to, [`StoreError::InUse`] if another process holds
    /// it; both name the folder.
    pub fn open(root: impl Into<PathBuf>) -> Result<Self, StoreError> {
        let root = root.into();
        fs::create_dir_all(root.join("runs")).map_err(at("create the results folder", &root))?;
        let lock = lock::hold(&root)?;
        let probe = root.join("runs").join(".writable");
        fs::write(&probe, []).map_err(at("write to the results folder", &root))?;
        fs::remove_file(&probe).map_err(at("write to the results folder", &root))?;
        Ok(Self { root, _lock: lock })
    }

    /// The folder's path.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The folder of a run, which may not exist yet.
    pub fn run(&self, id: &Id) -> RunFolder {
        RunFolder::new(&self.root, id)
    }

    /// Records which runs and evaluations belong to which cells, in place of what an earlier start of the grid recorded.
    ///
    /// # Errors
    /// [`StoreError::OtherGrid`] if the folder holds a grid of another name, whose report would be lost;
    /// [`StoreError::Io`] and [`StoreError::Parse`].
    pub fn write_index(&self, index: &Index) -> Result<(), StoreError> {
        match Index::load(&self.root) {
            Err(StoreError::NoIndex { .. }) => {}
            Err(error) => return Err(error),
            Ok(held) if held.name == index.name => {}
            Ok(held) => {
                let folder = self.root.clone();
                return Err(StoreError::OtherGrid { folder, held: held.name, given: index.name.clone() });
            }
        }
        let path = self.root.join(index::FILE);
        let mut text = serde_json::to_string_pretty(index).map_err(error::unserialisable(&path))?;
        text.push('\n');
        write_atomically(&path, text.as_bytes())
    }
}
