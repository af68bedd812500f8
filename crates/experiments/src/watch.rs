//! A view of a grid while it is made: how far every run is, and whether it learns.
//!
//! It reads what runs leave in their folders, and knows nothing of the program that makes them: a grid on another machine's disk can
//! be watched as well as one that was finished long ago.

mod progress;
mod spark;
mod view;

pub use progress::{RunProgress, Stage, Watcher};
pub use spark::sparkline;
pub use view::{Tone, View};
