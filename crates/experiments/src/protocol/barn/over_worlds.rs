//! How sure the overall figures are, with the world as the unit.

use serde::Serialize;

use super::{Clip, Reference, Run};
use crate::episode::Outcome;
use headway_stats::{Bootstrap, Clustered, Estimate, clustered, over_units};

/// 95 % intervals of the figures of all worlds for other worlds like these: runs of one world are alike, so that intervals over
/// the runs are too narrow for that.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OverWorlds {
    /// How many worlds there are.
    pub n_worlds: usize,
    /// Of the share of successes.
    pub success: Clustered,
    /// Of the share of collisions.
    pub collision: Clustered,
    /// Of the share of timeouts.
    pub timeout: Clustered,
    /// Of the score of the first edition: the mean of the worlds' means, with a bootstrap interval.
    pub score_2022: Estimate,
    /// Of the score of the later ones, likewise.
    pub score_2023: Estimate,
}

impl OverWorlds {
    /// Those of the runs of each world, with what they are measured by; none for fewer than three worlds.
    #[must_use]
    pub fn of(worlds: &[(Reference, &[Run])]) -> Option<Self> {
        let rate = |outcome: Outcome| {
            let count = |runs: &[Run]| (runs.iter().filter(|run| run.outcome == outcome).count(), runs.len());
            clustered(&worlds.iter().map(|(_, runs)| count(runs)).collect::<Vec<_>>())
        };
        let score = |clip: Clip| {
            let mean = |(reference, runs): &(Reference, &[Run])| {
                let optimal = reference.optimal_time();
                Some(runs.iter().map(|run| clip.score(optimal, run)).sum::<f64>() / runs.len() as f64)
            };
            over_units(worlds.iter().map(mean), &Bootstrap::default())
        };
        Some(Self {
            n_worlds: worlds.len(),
            success: rate(Outcome::Success)?,
            collision: rate(Outcome::Collision)?,
            timeout: rate(Outcome::Timeout)?,
            score_2022: score(Clip::From4To8),
            score_2023: score(Clip::From2To8),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Source;
    use super::*;
    use headway_stats::{Confidence, Interval};

    fn wilson(successes: usize, n: usize) -> (f64, f64) {
        headway_stats::wilson(successes, n, Confidence::default()).map(Interval::ends).unwrap()
    }

    #[test]
    fn runs_that_are_alike_in_each_world_count_once() {
        let reference = Reference { length: 10.0, source: Source::File };
        let run = |outcome| Run { outcome, time: 10.0, interventions: Default::default() };
        let [good, bad] = [Outcome::Success, Outcome::Collision].map(|outcome| vec![run(outcome); 10]);
        let worlds: Vec<(Reference, &[Run])> = [&good, &good, &good, &bad].map(|runs| (reference, &runs[..])).into();
        let over = OverWorlds::of(&worlds).unwrap();
        assert_eq!((over.success.low, over.success.high), wilson(3, 4));
        assert_eq!((over.collision.low, over.collision.high), wilson(1, 4));
        assert_eq!((over.score_2023.mean, over.score_2023.high), (Some(0.375), Some(0.5)));
        assert_eq!(OverWorlds::of(&worlds[..2]), None);
    }
}
