//! Which axes of a grid tell its cells apart.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use crate::store::AxisLevel;

/// The fewest of `n_axes` axes, one at least, that `will_do`; of as few, the first in the grid's order. None where not even all do.
pub(super) fn fewest(n_axes: usize, will_do: impl Fn(&[usize]) -> bool) -> Option<Vec<usize>> {
    // Grids of more axes have more cells than anyone can run.
    let mut sets: Vec<u64> = (1..1 << n_axes.min(20)).collect();
    sets.sort_by_key(|set| (set.count_ones(), Reverse(set.reverse_bits())));
    let axes = |set: u64| (0..n_axes).filter(|axis| (set >> axis) & 1 == 1).collect::<Vec<_>>();
    sets.into_iter().map(axes).find(|axes| will_do(axes))
}

/// What tells `some` cells from all others, in words: their levels of as few axes as will do, each combination once.
pub(super) fn shared(some: &[&[AxisLevel]], all: &[&[AxisLevel]]) -> Vec<String> {
    let label = |cell: &[AxisLevel], axes: &[usize]| {
        let levels = axes.iter().map(|axis| &cell[*axis]);
        levels.map(|level| format!("{}={}", level.axis, level.level)).collect::<Vec<_>>().join(" ")
    };
    let labels = |axes: &[usize]| some.iter().map(|cell| label(cell, axes)).collect::<BTreeSet<_>>();
    let will_do = |axes: &[usize]| {
        let labels = labels(axes);
        all.iter().filter(|cell| labels.contains(&label(cell, axes))).count() == some.len()
    };
    let n_axes = some.first().map_or(0, |cell| cell.len());
    let axes = fewest(n_axes, will_do).unwrap_or_else(|| (0..n_axes).collect());
    labels(&axes).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_sets_cells_apart_is_said_in_few_words() {
        let cell = |reading: &str, agent: &str| {
            [("reading", reading), ("agent", agent)]
                .map(|(axis, level)| AxisLevel { axis: axis.into(), level: level.into() })
        };
        let all = [("P", "DQN"), ("P", "DDQN"), ("T", "DQN"), ("T", "DDQN"), ("H", "DQN"), ("H", "DDQN")];
        let all = all.map(|(reading, agent)| cell(reading, agent));
        let all: Vec<&[AxisLevel]> = all.iter().map(|cell| &cell[..]).collect();
        assert_eq!(shared(&all[4..], &all), ["reading=H"]);
        assert_eq!(shared(&all[2..], &all), ["reading=H", "reading=T"]);
        assert_eq!(shared(&[all[0], all[2], all[4]], &all), ["agent=DQN"]);
        assert_eq!(shared(&all[1..2], &all), ["reading=P agent=DDQN"]);
    }

    #[test]
    fn as_few_as_will_do_and_of_those_the_first() {
        assert_eq!(fewest(3, |axes| axes.contains(&2)), Some(vec![2]));
        assert_eq!(fewest(3, |axes| axes.len() == 1), Some(vec![0]));
        assert_eq!(fewest(3, |axes| axes.len() == 2), Some(vec![0, 1]));
        assert_eq!(fewest(4, |axes| axes.len() == 2 && !axes.contains(&1)), Some(vec![0, 2]));
        // The first in the grid's order, not the one of the lowest places.
        assert_eq!(fewest(4, |axes| axes == [0, 3] || axes == [1, 2]), Some(vec![0, 3]));
        assert_eq!(fewest(2, |_| false), None);
        assert_eq!(fewest(0, |_| true), None);
    }
}
