//! Specs: TOML files that say what to run.
//!
//! A file describes one run, or a grid of them. Its run tables are the fields of [`RunSpec`]; a key left out takes its
//! default, a key that does not exist is an error. Its head keys say what varies:
//!
//! | key | is |
//! |---|---|
//! | `name` | what results are called; the file's own name if it is left out |
//! | `base` | another spec file, relative to this one, over which this one is laid |
//! | `seeds = { first, count }` | the training seeds of every cell |
//! | `[[axis]]` | an axis of the grid: a `name`, and `levels`, each a table of `"dotted.path" = value` |
//! | `[[when]]` | `set = { "dotted.path" = value }` for the cells that `match = { axis = level }` |
//!
//! # How a cell comes about
//! 1. *Bases.* Tables merge key by key; all else is replaced. A table that names another `type` replaces the base's
//!    table whole.
//! 2. *Defaults* are filled in.
//! 3. *Levels*, axis by axis, then the `when`s that match, then the assignments of the command line *replace* the value
//!    at a path, which must exist: numbers index arrays, as in `reward.terms.1.weight`. A table without a `type` stands
//!    for its entries; another `type` alone, as in `reward.type=r`, for a whole table of that type. After each one
//!    defaults are filled in again, so that the next may name a key of a new `type`.
//! 4. Everything is built once, and every refusal becomes one [`SpecError`] that names file, line, path and value.
//!
//! ```
//! use headway_experiments::spec::{Assignment, Grid};
//!
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("targets.toml");
//! std::fs::write(&path, r#"
//!     seeds = { first = 0, count = 3 }
//!     [[axis]]
//!     name = "target"
//!     [axis.levels]
//!     DQN  = { "agent.target" = "dqn" }
//!     DDQN = { "agent.target" = "double_dqn" }
//! "#)?;
//! let set: Assignment = "train.n_steps=1000".parse()?;
//! let grid = Grid::load(&path, &[set])?;
//! assert_eq!((grid.cells.len(), grid.n_runs()), (2, 6));
//! assert_eq!(grid.cells[1].label(), "target=DDQN");
//! assert_eq!(grid.cells[1].spec.train.n_steps, 1000);
//!
//! let set: Assignment = "train.n_step=1000".parse()?;
//! let message = Grid::load(&path, &[set]).unwrap_err().to_string();
//! assert!(message.starts_with("--set: train.n_step = 1000: unknown key `n_step`; did you mean `n_steps`?"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assign;
mod barn;
mod check;
mod choices;
mod error;
mod grid;
mod head;
mod integers;
mod merge;
mod names;
mod path;
mod policy;
mod resolved;
mod run;
mod source;
mod suggest;
mod typed;

pub use assign::Assignment;
pub use choices::choices;
pub use error::{Fault, Place, SpecError};
pub use grid::{Cell, Grid};
#[cfg(test)]
pub(crate) use head::is_column;
pub use head::{Axis, Seeds};
pub(crate) use names::check_folder;
pub use path::KeyPath;
pub use policy::{PolicySpec, ShieldOption};
pub use run::{EvaluateSpec, EvaluateWorld, RunSpec, Stage, TrainSpec};
pub(crate) use suggest::did_you_mean;
