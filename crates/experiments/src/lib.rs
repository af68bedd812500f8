//! Specs, grids, the training loop, evaluation and reports: the experiments binary.

pub mod candidate;
pub mod cli;
mod difference;
pub mod episode;
mod error;
pub mod evaluate;
pub mod jobs;
mod plan;
pub mod plot;
pub mod protocol;
pub mod report;
pub mod spec;
pub mod store;
pub mod train;

pub use cli::main;
pub use error::Error;
