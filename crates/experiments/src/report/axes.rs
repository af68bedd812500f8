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

/// What tells `some` cells from all others, in words: their levels of as few axes as will do. One piece, such as
/// `reading=P or T, reward=R`, if they are all that have one of these levels of each axis; or else one for each combination.
pub(super) fn shared(some: &[&[AxisLevel]], all: &[&[AxisLevel]]) -> Vec<String> {
    let part =
        |cell: &[AxisLevel], axes: &[usize]| axes.iter().map(|axis| cell[*axis].level.clone()).collect::<Vec<_>>();
    let parts = |axes: &[usize]| some.iter().map(|cell| part(cell, axes)).collect::<BTreeSet<_>>();
    let will_do = |axes: &[usize]| {
        let parts = parts(axes);
        all.iter().filter(|cell| parts.contains(&part(cell, axes))).count() == some.len()
    };
    let Some(first) = some.first() else { return Vec::new() };
    let axes = fewest(first.len(), will_do).unwrap_or_else(|| (0..first.len()).collect());
    let parts = parts(&axes);
    let names: Vec<&str> = axes.iter().map(|axis| &*first[*axis].axis).collect();
    let levels: Vec<BTreeSet<&str>> = (0..axes.len()).map(|k| parts.iter().map(|part| &*part[k]).collect()).collect();
    if levels.iter().map(BTreeSet::len).product::<usize>() == parts.len() {
        let of_axis = |(name, levels): (&&str, &BTreeSet<&str>)| {
            format!("{name}={}", levels.iter().copied().collect::<Vec<_>>().join(" or "))
        };
        return vec![names.iter().zip(&levels).map(of_axis).collect::<Vec<_>>().join(", ")];
    }
    let label = |part: &Vec<String>| {
        names.iter().zip(part).map(|(name, level)| format!("{name}={level}")).collect::<Vec<_>>().join(" ")
    };
    parts.iter().map(label).collect()
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
        assert_eq!(shared(&all[2..], &all), ["reading=H or T"]);
        assert_eq!(shared(&[all[0], all[2], all[4]], &all), ["agent=DQN"]);
        assert_eq!(shared(&all[1..2], &all), ["reading=P, agent=DDQN"]);
        assert_eq!(shared(&[all[0], all[3]], &all), ["reading=P agent=DQN", "reading=T agent=DDQN"]);
        assert_eq!(shared(&[], &all), Vec::<String>::new());
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
