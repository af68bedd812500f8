//! Which axes of a grid tell its cells apart.

use std::cmp::Reverse;

/// The fewest of `n_axes` axes, one at least, that `will_do`; of as few, the first in the grid's order. None where not even all do.
pub(super) fn fewest(n_axes: usize, will_do: impl Fn(&[usize]) -> bool) -> Option<Vec<usize>> {
    // Grids of more axes have more cells than anyone can run.
    let mut sets: Vec<u64> = (1..1 << n_axes.min(20)).collect();
    sets.sort_by_key(|set| (set.count_ones(), Reverse(set.reverse_bits())));
    let axes = |set: u64| (0..n_axes).filter(|axis| (set >> axis) & 1 == 1).collect::<Vec<_>>();
    sets.into_iter().map(axes).find(|axes| will_do(axes))
}

#[cfg(test)]
mod tests {
    use super::*;

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
