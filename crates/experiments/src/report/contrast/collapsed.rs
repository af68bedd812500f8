//! In how many seeds the sides of contrasts collapsed.

use super::{Contrast, Contrasts, WORLD};
use crate::report::TABLE_WIDTH;
use crate::report::axes::shared;
use crate::report::layout::wrapped;
use crate::store::AxisLevel;

/// Places that are told one by one; more are counted.
const N_TOLD: usize = 3;

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

/// For example `in 18 to 20 of 20 seeds where reading=P; in 1 of 20 where reading=T, agent=DQN`: where half of the seeds or more did,
/// and where fewer; nothing if none did.
fn told(sides: &[Side]) -> Option<String> {
    let all: Vec<&[AxisLevel]> = sides.iter().map(|side| &side.place[..]).collect();
    let (most, few): (Vec<&Side>, Vec<&Side>) =
        sides.iter().filter(|side| side.n_collapsed > 0).partition(|side| 2 * side.n_collapsed >= side.n_seeds);
    let groups = [most, few].into_iter().filter(|group| !group.is_empty()).enumerate();
    let group = |(k, group): (usize, Vec<&Side>)| {
        let (seeds, some): (_, Vec<&[AxisLevel]>) =
            (if k == 0 { " seeds" } else { "" }, group.iter().map(|side| &side.place[..]).collect());
        format!("in {}{seeds}{}", numbers(&group), words(&some, &all))
    };
    let told: Vec<String> = groups.map(group).collect();
    (!told.is_empty()).then(|| told.join("; "))
}

/// For example `18 to 20 of 20`; `3 of 5 to 20 of 20` where the numbers of seeds differ.
fn numbers(sides: &[&Side]) -> String {
    let share = |side: &&&Side| side.n_collapsed as f64 / side.n_seeds as f64;
    let least = sides.iter().min_by(|a, b| share(a).total_cmp(&share(b))).expect("groups are not empty");
    let most = sides.iter().max_by(|a, b| share(a).total_cmp(&share(b))).expect("groups are not empty");
    let of = |side: &Side| format!("{} of {}", side.n_collapsed, side.n_seeds);
    match (of(least), of(most)) {
        (least, most) if least == most => most,
        (_, of_most) if least.n_seeds == most.n_seeds => format!("{} to {of_most}", least.n_collapsed),
        (least, most) => format!("{least} to {most}"),
    }
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
            told(&[("P", 20, 18), ("T", 0, 1), ("H", 0, 0)]),
            "in 18 to 20 of 20 seeds where reading=P; in 1 of 20 where reading=T, world=b"
        );
        let crossed = [("P", 20, 0), ("T", 0, 19), ("H", 0, 0)];
        assert_eq!(told(&crossed), "in 19 to 20 of 20 seeds where reading=P world=a or reading=T world=b");
        let scattered = [("P", 5, 0), ("T", 0, 5), ("H", 5, 0), ("N", 0, 5), ("Q", 5, 0)];
        assert_eq!(told(&scattered), "in 5 of 20 seeds in 5 rows");
    }

    #[test]
    fn numbers_of_seeds_may_differ() {
        let mut sides = sides(&[("P", 3, 20)]);
        sides[0].n_seeds = 5;
        assert_eq!(numbers(&sides.iter().collect::<Vec<_>>()), "3 of 5 to 20 of 20");
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
