//! The statistics of comparing policies.
//!
//! The *unit* is what was drawn independently: the training seed, for all episodes of a policy share its luck, and
//! pooled episodes would give intervals that are far too narrow. Scores stand in a matrix, [`Scores`], of N runs (one
//! per seed) by M tasks (worlds, scenarios), and intervals come from redrawing the runs. [`Redrawn`] says how: within each
//! task, as do Agarwal, Schwarzer, Castro, Courville & Bellemare (2021, "Deep Reinforcement Learning at the Edge of the
//! Statistical Precipice"), where every task has policies of its own; whole, where one policy drives in all tasks.
//!
//! | question | answer |
//! |---|---|
//! | how good is it over all tasks? | [`stratified_bootstrap`] of an [`Estimator`]: IQM, median, mean, optimality gap |
//! | how good is it in one figure per seed? | [`over_units`], or [`bootstrap`] of any statistic |
//! | is X better than Y? | [`paired_differences`] on shared seeds and scenarios, else [`probability_of_improvement`] |
//! | is that difference more than luck? | [`sign_flip`], which holds for few seeds too |
//! | at what score does it break down? | [`performance_profile`] |
//! | what is the success rate of one policy? | [`wilson`]; [`clustered()`] where episodes share scenarios |
//!
//! An interval says what other seeds might have given. It does not repair what is shared by all of them: few seeds
//! (up to five, percentile intervals are too narrow; below three, meaningless), scenarios tuned on, or the best of many
//! checkpoints. The crate knows numbers only: no policy, no simulator, no file. Equal values and equal seeds give equal
//! bytes.
//!
//! ```
//! use headway_stats::{Bootstrap, Estimator, Scores, stratified_bootstrap};
//!
//! // Five seeds in two worlds: the share of episodes that reached the goal.
//! let rows = [[0.90, 0.40], [0.95, 0.35], [0.85, 0.50], [0.92, 0.45], [0.88, 0.30]];
//! let scores = Scores::from_rows(&rows)?;
//! let iqm = stratified_bootstrap(&scores, Estimator::Iqm, &Bootstrap::default());
//! assert!((iqm.point - 3.98 / 6.0).abs() < 1e-12); // of 0.40, 0.45, 0.50, 0.85, 0.88, 0.90
//! assert!(iqm.low < iqm.point && iqm.point < iqm.high);
//! # Ok::<(), headway_stats::StatsError>(())
//! ```

mod bootstrap;
mod clustered;
mod confidence;
mod error;
mod estimator;
mod improvement;
mod paired;
mod profile;
mod scores;
mod seeds;
mod sign_flip;
mod wilson;

pub use bootstrap::{Bootstrap, Interval, Redrawn, bootstrap};
pub use clustered::{Clustered, clustered};
pub use confidence::Confidence;
pub use error::StatsError;
pub use estimator::{Estimator, stratified_bootstrap};
pub use improvement::{improvement_bootstrap, probability_of_improvement};
pub use paired::{Unit, cluster_bootstrap, paired_differences};
pub use profile::{Profile, performance_profile};
pub use scores::Scores;
pub use seeds::{Estimate, MIN_UNITS, over_units};
pub use sign_flip::sign_flip;
pub use wilson::wilson;
