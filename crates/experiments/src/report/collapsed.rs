//! Which seeds of a cell collapsed.

use std::collections::BTreeMap;

use serde::ser::{Serialize, SerializeMap, Serializer};

use super::layout::wrapped;
use super::{Policy, Report, RunRow, TABLE_WIDTH};
use crate::collapse::{self, Collapse};

/// Which of a cell's seeds collapsed, of those whose training is over.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Collapsed {
    /// Number of seeds that were trained.
    pub n_trained: usize,
    /// Those that collapsed, in the order of the seeds.
    pub seeds: Vec<CollapsedSeed>,
}

/// One seed that collapsed.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct CollapsedSeed {
    /// The training seed.
    pub seed: u64,
    /// How it collapsed; in one way or more.
    pub how: Vec<Collapse>,
}

impl Collapsed {
    /// Those among the runs of a cell, whatever the world.
    fn in_any_world(runs: &[RunRow]) -> Self {
        Self::of(runs, |run| run.collapse.clone())
    }

    /// Those among the runs of a cell by their training, or in this world.
    pub(super) fn in_world(runs: &[RunRow], world: &str) -> Self {
        Self::of(runs, |run| run.collapse_in(world).cloned().collect())
    }

    fn of(runs: &[RunRow], how: impl Fn(&RunRow) -> Vec<Collapse>) -> Self {
        let seeds = runs.iter().map(|run| CollapsedSeed { seed: run.seed, how: how(run) });
        Self {
            n_trained: runs.iter().filter(|run| matches!(run.policy, Policy::At(_))).count(),
            seeds: seeds.filter(|seed| !seed.how.is_empty()).collect(),
        }
    }

    /// How many collapsed; `None` where nothing was trained.
    pub fn n(&self) -> Option<usize> {
        (self.n_trained > 0).then_some(self.seeds.len())
    }

    /// For example `3 of 5 seeds collapsed: makes no progress (seeds 0, 2), times out in room (seeds 0 to 2)`; nothing if none did.
    pub fn text(&self) -> Option<String> {
        let mut kinds: Vec<(String, Vec<u64>)> = Vec::new();
        for (seed, how) in
            self.seeds.iter().flat_map(|of| collapse::kinds(&of.how).into_iter().map(|how| (of.seed, how)))
        {
            match kinds.iter_mut().find(|(kind, _)| *kind == how) {
                Some((_, seeds)) => seeds.push(seed),
                None => kinds.push((how, vec![seed])),
            }
        }
        let kinds: Vec<String> = kinds.iter().map(|(kind, seeds)| format!("{kind} ({})", listed(seeds))).collect();
        (!kinds.is_empty())
            .then(|| format!("{} of {} seeds collapsed: {}", self.seeds.len(), self.n_trained, kinds.join(", ")))
    }
}

/// Seeds in ascending order, three or more in a row as `a to b`.
fn listed(seeds: &[u64]) -> String {
    let runs: Vec<String> = seeds
        .chunk_by(|a, b| a + 1 == *b)
        .flat_map(|run| match run {
            [first, _, .., last] => vec![format!("{first} to {last}")],
            few => few.iter().map(u64::to_string).collect(),
        })
        .collect();
    format!("seed{} {}", if seeds.len() == 1 { "" } else { "s" }, runs.join(", "))
}

impl Serialize for Collapsed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(3))?;
        map.serialize_entry("seeds", &self.seeds.len())?;
        map.serialize_entry("of", &self.n_trained)?;
        map.serialize_entry("verdicts", &self.seeds)?;
        map.end()
    }
}

impl Report {
    /// How many of the runs that were trained collapsed, in whatever world, and how many were trained; runs that cells share count once.
    pub(super) fn n_collapsed(&self) -> (usize, usize) {
        let trained = self.runs.iter().filter(|run| matches!(run.policy, Policy::At(_)));
        // What an evaluation shows may be in one cell only.
        let runs = trained.fold(BTreeMap::new(), |mut runs, run| {
            *runs.entry(&run.train_id).or_insert(false) |= !run.collapse.is_empty();
            runs
        });
        (runs.values().filter(|collapsed| **collapsed).count(), runs.len())
    }

    /// The lines that stand below the table: one for each cell of which a seed collapsed.
    pub(super) fn collapsed(&self) -> Vec<String> {
        let cells = self.runs.chunk_by(|run, next| run.axes == next.axes);
        let line = |runs: &[RunRow]| {
            let levels: Vec<&str> = runs[0].axes.iter().map(|level| level.level.as_str()).collect();
            let start = if levels.is_empty() { String::new() } else { levels.join(" ") + ": " };
            Collapsed::in_any_world(runs).text().map(|text| wrapped(&(start + &text), TABLE_WIDTH))
        };
        cells.filter_map(line).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_in_a_row_are_a_range() {
        assert_eq!(listed(&[0, 2, 3, 4, 7, 8]), "seeds 0, 2 to 4, 7, 8");
        assert_eq!(listed(&[5]), "seed 5");
    }

    #[test]
    fn how_many_and_which() {
        let how = vec![Collapse::Spinning { share: 0.8 }, Collapse::OneAction { entropy: 0.0 }];
        let other = vec![Collapse::TimesOut { world: "room".into(), timeouts: 1.0, mean_speed: 0.0 }];
        let seeds = vec![CollapsedSeed { seed: 0, how }, CollapsedSeed { seed: 3, how: other }];
        let collapsed = Collapsed { n_trained: 5, seeds };
        let text = "2 of 5 seeds collapsed: spins (seed 0), has one action (seed 0), times out in room (seed 3)";
        assert_eq!(collapsed.text().unwrap(), text);
        assert_eq!(Collapsed { n_trained: 5, seeds: Vec::new() }.text(), None);
    }
}
