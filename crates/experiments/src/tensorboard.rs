//! TensorBoard event files: the training metrics of runs, to look at while they are made.
//!
//! They lie beside the runs, in `tensorboard/<cell>, seed <n>/`, because they hold the times at which rows were written, and what is
//! in a run's own folder never depends on the clock.

mod event;
mod record;

pub use event::EventFile;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::Error;
use crate::plan::Run;
use crate::spec::check_folder;
use crate::store::{Id, RunFolder};
use crate::train::MetricsRow;

/// The name of every event file: TensorBoard wants `tfevents` in it, and sorts a folder's files by what follows.
const FILE: &str = "events.out.tfevents.0000000000.headway";

/// The longest name of a folder that file systems take, in bytes.
const MAX_NAME: usize = 255;

/// The path of a run's event file in the results folder `root`, below a folder named by the run's label, which TensorBoard shows; or by
/// its id, if the label is no name of a folder.
///
/// ```
/// use headway_experiments::store::TrainKey;
/// use headway_experiments::tensorboard::path;
///
/// let id = TrainKey { spec: &[("gamma", 0.95)], seed: 3, reward_version: 1 }.id()?;
/// let folder = |label| path("out".as_ref(), label, &id).parent().unwrap().display().to_string();
/// assert_eq!(folder("agent=DQN, seed 3"), "out/tensorboard/agent=DQN, seed 3");
/// assert_eq!(folder("agent=a/b, seed 3"), format!("out/tensorboard/{id}"));
/// # Ok::<(), headway_experiments::store::StoreError>(())
/// ```
pub fn path(root: &Path, label: &str, id: &Id) -> PathBuf {
    let names_a_folder = check_folder(label).is_ok() && label.len() <= MAX_NAME;
    root.join("tensorboard").join(if names_a_folder { label } else { id.as_str() }).join(FILE)
}

/// Writes the event files of runs that are trained, where they do not hold just the rows that the runs have: those of runs made without
/// any, and those that an interrupted run or another spec left. All their rows have the time of the last one.
///
/// # Errors
/// If a run's metrics cannot be read, or a file cannot be read or written.
pub(crate) fn complete(root: &Path, runs: &[Run<'_>]) -> Result<(), Error> {
    for run in runs {
        let (folder, path) = (RunFolder::new(root, &run.id), path(root, &run.label, &run.id));
        let rows = folder.metrics()?;
        if rows.is_empty() || holds(&path, &rows).map_err(|error| Error::io("read", &path, error))? {
            continue;
        }
        let written = fs::metadata(folder.metrics_path()).and_then(|metadata| metadata.modified());
        let time = written.unwrap_or_else(|_| SystemTime::now());
        let file = EventFile::create(&path, time);
        let file = file.and_then(|mut file| rows.iter().try_for_each(|row| file.push(row, time)));
        file.map_err(|error| Error::io("write", &path, error))?;
    }
    Ok(())
}

/// Whether there is an event file at `path` that holds these rows, and nothing else.
fn holds(path: &Path, rows: &[MetricsRow]) -> io::Result<bool> {
    match fs::read(path) {
        Ok(file) => Ok(event::holds(&file, rows)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}
