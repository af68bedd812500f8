//! In how many seeds the sides of contrasts collapsed.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::{Contrast, Contrasts, WORLD};
use crate::report::TABLE_WIDTH;
use crate::report::axes::shared;
use crate::report::layout::wrapped;
use crate::store::AxisLevel;

/// Numbers of seeds that are told of a level, and places that are told of a number; the others are counted.
const N_TOLD: usize = 4;

/// A cell in a world of which policies were trained.
struct Side {
    /// The levels of the other axes, and the world if it is one of several.
    place: Vec<AxisLevel>,
    n_collapsed: usize,
    n_seeds: usize,
}

impl Contrasts {
    /// Which levels collapsed, in how many seeds and where, the base first: a line for each of which any policy did.
    pub(super) fn collapsed(&self) -> Vec<String> {
        let mut levels: Vec<(&str, Vec<Side>)> = vec![(&self.base, Vec::new())];
        for contrast in &self.contrasts {
            for (k, level) in [&contrast.level, &self.base].into_iter().enumerate() {
                let Some(n_collapsed) = contrast.n_collapsed[k] else { continue };
                let side = Side { place: place(contrast), n_collapsed, n_seeds: contrast.n_seeds };
                match levels.iter_mut().find(|(name, _)| name == level) {
                    Some((_, sides)) => add(sides, side),
                    None => levels.push((level, vec![side])),
                }
            }
        }
        let lines = levels.iter().filter_map(|(level, sides)| Some(format!("{level} collapsed {}", told(sides)?)));
        lines.map(|line| wrapped(&line, TABLE_WIDTH)).collect()
    }
}

fn place(contrast: &Contrast) -> Vec<AxisLevel> {
    let world = contrast.world.iter().map(|world| AxisLevel { axis: WORLD.to_owned(), level: world.clone() });
    contrast.axes.iter().cloned().chain(world).collect()
}

/// The base is a side of several contrasts, with the seeds that each of them shares with it.
fn add(sides: &mut Vec<Side>, side: Side) {
    match sides.iter_mut().find(|known| known.place == side.place) {
        Some(known) if known.n_seeds < side.n_seeds => *known = side,
        Some(_) => {}
        None => sides.push(side),
    }
}

/// For example `in 20 of 20 seeds where reading=P; in 1 of 20 where reading=T agent=DQN`; nothing if none did.
fn told(sides: &[Side]) -> Option<String> {
    let all: Vec<&[AxisLevel]> = sides.iter().map(|side| &side.place[..]).collect();
    let mut groups: BTreeMap<Reverse<(usize, usize)>, Vec<&[AxisLevel]>> = BTreeMap::new();
    for side in sides.iter().filter(|side| side.n_collapsed > 0) {
        groups.entry(Reverse((side.n_collapsed, side.n_seeds))).or_default().push(&side.place);
    }
    let group = |(k, (Reverse((n, n_seeds)), places)): (usize, (&Reverse<(usize, usize)>, &Vec<&[AxisLevel]>))| {
        let seeds = if k == 0 { " seeds" } else { "" };
        format!("in {n} of {n_seeds}{seeds}{}", words(places, &all))
    };
    let mut told: Vec<String> = groups.iter().enumerate().take(N_TOLD).map(group).collect();
    let n_others: usize = groups.values().skip(N_TOLD).map(Vec::len).sum();
    if n_others > 0 {
        told.push(format!("in fewer in {n_others} more rows"));
    }
    (!told.is_empty()).then(|| told.join("; "))
}

/// Where some of the sides are; nothing if they are all that there are.
fn words(some: &[&[AxisLevel]], all: &[&[AxisLevel]]) -> String {
    if some.len() == all.len() {
        return String::new();
    }
    let places = shared(some, all);
    if places.len() > N_TOLD { format!(" in {} rows", some.len()) } else { format!(" where {}", places.join(" or ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sides in two worlds for each reading.
    fn sides(counts: &[(&str, usize, usize)]) -> Vec<Side> {
        let level = |axis: &str, level: &str| AxisLevel { axis: axis.into(), level: level.into() };
        let of = |(reading, a, b): &(&str, usize, usize)| {
            [("a", *a), ("b", *b)].map(|(world, n_collapsed)| Side {
                place: vec![level("reading", reading), level("world", world)],
                n_collapsed,
                n_seeds: 20,
            })
        };
        counts.iter().flat_map(of).collect()
    }

    #[test]
    fn places_are_told_in_few_words() {
        assert_eq!(told(&sides(&[("P", 0, 0), ("T", 0, 0)])), None);
        let told = |counts| told(&sides(counts)).unwrap();
        assert_eq!(told(&[("P", 20, 20), ("T", 0, 0), ("H", 0, 0)]), "in 20 of 20 seeds where reading=P");
        assert_eq!(told(&[("P", 7, 7), ("T", 7, 7)]), "in 7 of 20 seeds");
        assert_eq!(
            told(&[("P", 20, 20), ("T", 0, 1), ("H", 0, 0)]),
            "in 20 of 20 seeds where reading=P; in 1 of 20 where reading=T world=b"
        );
        assert_eq!(
            told(&[("P", 20, 19), ("T", 18, 17), ("H", 16, 15)]),
            "in 20 of 20 seeds where reading=P world=a; in 19 of 20 where reading=P world=b; in 18 of 20 where reading=T \
             world=a; in 17 of 20 where reading=T world=b; in fewer in 2 more rows"
        );
        let scattered = [("P", 5, 0), ("T", 0, 5), ("H", 5, 0), ("N", 0, 5), ("Q", 5, 0)];
        assert_eq!(told(&scattered), "in 5 of 20 seeds in 5 rows");
    }

    #[test]
    fn a_base_counts_where_it_has_most_seeds() {
        let mut sides = sides(&[("P", 3, 0)]);
        let place = sides[0].place.clone();
        add(&mut sides, Side { place: place.clone(), n_collapsed: 1, n_seeds: 5 });
        assert_eq!((sides.len(), sides[0].n_collapsed), (2, 3));
        add(&mut sides, Side { place, n_collapsed: 4, n_seeds: 30 });
        assert_eq!((sides.len(), sides[0].n_collapsed), (2, 4));
    }
}
