//! Which episodes are shown.

use std::num::NonZeroUsize;
use std::str::FromStr;

use crate::episode::{EpisodeRecord, Metric, Outcome};
use crate::report::RunRow;

/// Which episodes of every cell and world a page shows.
#[derive(Debug, Clone)]
pub struct Choice {
    /// How many of each outcome of the typical seed, by the rule of [`Self::RULE`].
    pub n_per_outcome: NonZeroUsize,
    /// Those asked for beside them.
    pub asked: Vec<Pick>,
}

/// An episode that was asked for: `CELL/WORLD/SEED/SCENARIO`.
///
/// ```
/// use headway_experiments::report::Pick;
/// let pick: Pick = "R_couple,DDQN/10x15/0/17".parse()?;
/// assert_eq!((&pick.cell[..], &pick.world[..], pick.seed, pick.scenario), ("R_couple,DDQN", "10x15", 0, 17));
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pick {
    /// The cell: its levels in the order of the axes, joined by commas; or `*` for every cell.
    pub cell: String,
    /// The name of the world.
    pub world: String,
    /// The training seed.
    pub seed: u64,
    /// The number of the scenario.
    pub scenario: u64,
}

impl Default for Choice {
    fn default() -> Self {
        Self { n_per_outcome: NonZeroUsize::MIN, asked: Vec::new() }
    }
}

impl Choice {
    /// The rule, in words for the reader.
    pub const RULE: &'static str = "For each cell and world, the typical seed is the one with the median success rate \
        (of two, the lower). Of its episodes with each outcome the page shows the one of median duration (of timeouts, which \
        all last equally long, of median distance), the commonest outcome of the cell in this world first. In brackets: \
        how many of the cell\u{2019}s episodes in this world, of all seeds, end so.";

    /// The typical of the runs in their world number `world`: that of median success.
    pub(super) fn typical_run(runs: &[RunRow], world: usize) -> Option<&RunRow> {
        let success = |run: &RunRow| run.summaries[world].1.and_then(|summary| Metric::Success.of(&summary));
        let mut known: Vec<(f64, &RunRow)> = runs.iter().filter_map(|run| Some((success(run)?, run))).collect();
        known.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.seed.cmp(&b.1.seed)));
        known.get(known.len().saturating_sub(1) / 2).map(|(_, run)| *run)
    }

    /// The episodes of the typical seed that are shown, the most typical of each outcome first; outcomes in the order of how
    /// common they are, given by `share`.
    pub(super) fn of_episodes<'a>(
        &self,
        episodes: &'a [EpisodeRecord],
        share: impl Fn(Outcome) -> f64,
    ) -> Vec<(&'static str, &'a EpisodeRecord)> {
        let typical = |outcome: Outcome| {
            let mut of: Vec<&EpisodeRecord> = episodes.iter().filter(|episode| episode.outcome == outcome).collect();
            of.sort_by(|a, b| length(a).total_cmp(&length(b)).then(a.scenario.cmp(&b.scenario)));
            from_the_middle(&of)
        };
        let mut outcomes = [
            (Outcome::Success, "typical success"),
            (Outcome::Collision, "typical collision"),
            (Outcome::Timeout, "typical timeout"),
        ];
        outcomes.sort_by(|a, b| share(b.0).total_cmp(&share(a.0)));
        let named =
            |(outcome, why)| typical(outcome).into_iter().take(self.n_per_outcome.get()).map(move |it| (why, it));
        outcomes.into_iter().flat_map(named).collect()
    }
}

/// By what the episodes of one outcome are ordered: their duration, or their distance where all last equally long.
fn length(episode: &EpisodeRecord) -> f64 {
    match episode.outcome {
        Outcome::Success | Outcome::Collision => episode.duration,
        Outcome::Timeout => episode.distance,
    }
}

/// A list from its (lower) middle outwards.
fn from_the_middle<T: Copy>(list: &[T]) -> Vec<T> {
    let middle = list.len().saturating_sub(1) / 2;
    let mut places: Vec<usize> = (0..list.len()).collect();
    places.sort_by_key(|place| (place.abs_diff(middle), *place));
    places.into_iter().map(|place| list[place]).collect()
}

impl Pick {
    /// Whether it names a cell, given by its levels.
    pub(super) fn is_of(&self, levels: &str) -> bool {
        self.cell == "*" || self.cell == levels
    }
}

impl FromStr for Pick {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const FORM: &str = "write CELL/WORLD/SEED/SCENARIO, for example R_couple,DDQN/10x15/0/17 or */10x15/0/17";
        // Names of cells may hold slashes.
        let mut parts = text.rsplitn(4, '/');
        let mut next = || parts.next().ok_or(FORM);
        let (scenario, seed, world, cell) = (next()?, next()?, next()?, next()?);
        let number = |text: &str| text.parse().map_err(|_| FORM);
        Ok(Self { cell: cell.into(), world: world.into(), seed: number(seed)?, scenario: number(scenario)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::EpisodeMeter;

    fn episode(scenario: u64, outcome: Outcome, duration: f64, distance: f64) -> EpisodeRecord {
        EpisodeRecord { duration, distance, ..EpisodeMeter::new(1.0).finish(scenario, outcome, 1.0) }
    }

    #[test]
    fn the_rule_by_hand() {
        let episodes = [
            episode(0, Outcome::Success, 9.0, 5.0),
            episode(1, Outcome::Collision, 4.0, 2.0),
            episode(2, Outcome::Success, 7.0, 5.0),
            episode(3, Outcome::Timeout, 60.0, 80.0),
            episode(4, Outcome::Success, 8.0, 5.0),
            episode(5, Outcome::Collision, 0.2, 0.1),
            episode(6, Outcome::Timeout, 60.0, 0.0),
            episode(7, Outcome::Collision, 30.0, 9.0),
            episode(8, Outcome::Timeout, 60.0, 29.5),
        ];
        let shares = |choice: &Choice, shares: [f64; 3]| {
            let share = |outcome| match outcome {
                Outcome::Success => shares[0],
                Outcome::Collision => shares[1],
                Outcome::Timeout => shares[2],
            };
            let shown = choice.of_episodes(&episodes, share);
            let is_named = |(why, it): &(&str, &EpisodeRecord)| *why == format!("typical {}", it.outcome.name());
            assert!(shown.iter().all(is_named), "{shown:?}");
            shown.iter().map(|(_, episode)| episode.scenario).collect::<Vec<_>>()
        };
        let mut choice = Choice::default();
        assert_eq!(shares(&choice, [0.4, 0.3, 0.2]), [4, 1, 8]);
        // What once stood for nine in ten drives that time out: the one that never moved.
        assert_eq!(shares(&choice, [0.0, 0.1, 0.9]), [8, 1, 4]);
        choice.n_per_outcome = NonZeroUsize::new(2).unwrap();
        assert_eq!(shares(&choice, [0.1, 0.1, 0.8]), [8, 6, 4, 2, 1, 5]);
        assert!(choice.of_episodes(&[], |_| 0.0).is_empty());
    }

    #[test]
    fn picks_are_read_from_the_right() {
        let pick: Pick = "a/b,DDQN/10x15/3/17".parse().unwrap();
        assert_eq!((&pick.cell[..], &pick.world[..], pick.seed, pick.scenario), ("a/b,DDQN", "10x15", 3, 17));
        assert!(pick.is_of("a/b,DDQN") && !pick.is_of("a"));
        assert!("*/w/0/1".parse::<Pick>().unwrap().is_of("any"));
        assert!("w/0/1".parse::<Pick>().unwrap_err().starts_with("write CELL/WORLD/SEED/SCENARIO"));
        assert!("c/w/x/1".parse::<Pick>().is_err());
    }
}
