//! One evaluation episode: what is recorded of it, and how it is measured.
//!
//! [`EpisodeMeter`] turns the control steps of an episode into an [`EpisodeRecord`]; [`SeedSummary`] turns the episodes of
//! one trained policy into the metrics that reports show. All three are pure: they know no simulator and no file.

mod meter;
mod summary;

pub use meter::{BRAKING_MARGIN, DECELERATION_THRESHOLD, EpisodeMeter, NEAR_CLEARANCE, Sample};
pub use summary::{Metric, Quantity, SeedSummary};

use serde::{Deserialize, Serialize};

/// How an episode ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The vehicle came within the reach radius of its goal.
    Success,
    /// The vehicle touched an obstacle or a wall.
    Collision,
    /// The time limit passed with neither.
    Timeout,
}

impl Outcome {
    /// The name in records and titles.
    pub fn name(self) -> &'static str {
        match self {
            Self::Success => "success",
            Self::Collision => "collision",
            Self::Timeout => "timeout",
        }
    }
}

/// One evaluation episode, in SI units: a row of `episodes.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EpisodeRecord {
    /// Index of the scenario among the held-out ones; equal for every policy that meets the same scenario.
    pub scenario: u64,
    /// How the episode ended.
    pub outcome: Outcome,
    /// Time from the start to the end of the episode, s.
    pub duration: f64,
    /// Length of the path driven, m.
    pub distance: f64,
    /// Length of the shortest planned path from the start to the edge of the goal's disc, m.
    pub geodesic: f64,
    /// Success weighted by path length, in [0, 1]: `S L / max(P, L)` (Anderson et al., 2018), with `L` the geodesic and
    /// `P` the distance driven.
    pub spl: f64,
    /// Time spent with a clearance below [`NEAR_CLEARANCE`], s.
    pub near_time: f64,
    /// Distance driven with a clearance below [`NEAR_CLEARANCE`], m.
    pub near_distance: f64,
    /// Number of decelerations, see [`EpisodeMeter`].
    pub n_decelerations: u32,
    /// Number of decelerations for which nothing ahead gave a reason, see [`EpisodeMeter`].
    pub n_needless_decelerations: u32,
    /// The numbers that the episode drew by `[randomize]`, `path=value` each, divided by blanks; empty where there are none.
    #[serde(default)]
    pub drawn: String,
    /// Number of commands that a shield looked at; 0 where there was none.
    #[serde(default)]
    pub n_shielded: u64,
    /// Number of those that it did not pass on as they were.
    #[serde(default)]
    pub n_vetoes: u64,
    /// Number of those in whose place it braked.
    #[serde(default)]
    pub n_stops: u64,
}
