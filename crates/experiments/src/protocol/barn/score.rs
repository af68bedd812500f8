//! Scores of a run.

use super::Run;
use crate::episode::Outcome;

/// Speed at which the reference path is thought to be driven, m/s.
pub(super) const REFERENCE_SPEED: f64 = 2.0;

/// Between which multiples of the optimal time the time of a run counts: the editions of the challenge differ in that.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clip {
    /// 4 to 8: the first edition; at most 0.25.
    From4To8,
    /// 2 to 8: the later ones; at most 0.5.
    From2To8,
}

impl Clip {
    /// The score of a run, in [0, 0.5]: `success * OT / clip(AT, low OT, 8 OT)`, with AT the time that the run took and
    /// `OT` the optimal time, seconds: [`Reference::optimal_time`](super::Reference::optimal_time).
    ///
    /// ```
    /// use headway_experiments::episode::Outcome;
    /// use headway_experiments::protocol::barn::{Clip, Run};
    /// let run = |outcome, time| Run { outcome, time, interventions: Default::default() };
    /// let score = |clip: Clip, time| clip.score(5.0, &run(Outcome::Success, time));
    /// assert_eq!([5.0, 15.0, 30.0, 60.0].map(|time| score(Clip::From2To8, time)), [0.5, 1.0 / 3.0, 1.0 / 6.0, 0.125]);
    /// assert_eq!([5.0, 15.0, 30.0, 60.0].map(|time| score(Clip::From4To8, time)), [0.25, 0.25, 1.0 / 6.0, 0.125]);
    /// assert_eq!(Clip::From2To8.score(5.0, &run(Outcome::Collision, 5.0)), 0.0);
    /// ```
    #[must_use]
    pub fn score(self, optimal: f64, run: &Run) -> f64 {
        let least = match self {
            Self::From4To8 => 4.0,
            Self::From2To8 => 2.0,
        };
        match run.outcome {
            Outcome::Success => optimal / run.time.clamp(least * optimal, 8.0 * optimal),
            _ => 0.0,
        }
    }
}
