//! Specs, grids, the training loop, evaluation and reports: the experiments binary.

pub mod audit;
pub mod candidate;
pub mod cli;
pub mod collapse;
mod difference;
pub mod episode;
mod error;
pub mod evaluate;
pub mod export;
pub mod jobs;
mod plan;
pub mod plot;
pub mod protocol;
pub mod report;
pub mod spec;
pub mod store;
pub mod tensorboard;
pub mod train;
pub mod watch;

pub use cli::main;
pub use error::Error;
