//! What else differs between two cells than the level that is looked at.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use toml::Value;

use super::{Contrast, Contrasts};
use crate::Error;
use crate::difference::changes;
use crate::report::axes::fewest;
use crate::store::{Id, RunFolder};

/// Settings that are named; the others are counted.
const N_NAMED: usize = 4;

/// Dotted paths of a spec.
type Paths = BTreeSet<String>;

/// A contrast with the settings in which its two sides differ.
type Differing<'a> = (&'a Contrast, Paths);

impl Contrasts {
    /// In which settings the training of each level differs from that of the base, and in which more in some cells: a line for each
    /// level, from the specs in the results folder at `root`. A `[[when]]` of a grid can change more than a level says.
    ///
    /// # Errors
    /// If the spec of a run cannot be read.
    pub fn settings(&self, root: &Path) -> Result<Vec<String>, Error> {
        let mut levels: Vec<(&str, Vec<Differing<'_>>)> = Vec::new();
        for contrast in &self.contrasts {
            let Some([level, base]) = contrast.runs.as_ref().filter(|[level, base]| level != base) else { continue };
            let differing = folded(changes(&spec(root, base)?, &spec(root, level)?).into_keys().collect());
            match levels.iter_mut().find(|(name, _)| *name == contrast.level) {
                Some((_, cells)) => cells.push((contrast, differing)),
                None => levels.push((&contrast.level, vec![(contrast, differing)])),
            }
        }
        Ok(levels.iter().map(|(level, cells)| format!("{level} and {} differ in {}", self.base, told(cells))).collect())
    }
}

fn spec(root: &Path, id: &Id) -> Result<Value, Error> {
    Ok(Value::Table(RunFolder::new(root, id).spec()?))
}

/// What has another type is another thing: that stands for all that is in it; and a list for its numbers.
fn folded(paths: Paths) -> Paths {
    let of_list = |path: String| match path.rsplit_once('.') {
        Some((list, number)) if number.bytes().all(|byte| byte.is_ascii_digit()) => list.to_owned(),
        _ => path,
    };
    let paths: Paths = paths.into_iter().map(of_list).collect();
    let others: Vec<String> = paths.iter().filter_map(|path| Some(path.strip_suffix(".type")?.to_owned())).collect();
    let fold = |path: String| {
        let holder = others.iter().filter(|other| path.strip_prefix(*other).is_some_and(|rest| rest.starts_with('.')));
        holder.min_by_key(|other| other.len()).cloned().unwrap_or(path)
    };
    paths.into_iter().map(fold).collect()
}

/// What all cells differ in, and then what only some do.
fn told(cells: &[Differing<'_>]) -> String {
    let common = cells.iter().map(|(_, paths)| paths.clone()).reduce(|a, b| &a & &b).unwrap_or_default();
    let mut told = vec![named(&common)];
    let mut groups: BTreeMap<Paths, Vec<&Contrast>> = BTreeMap::new();
    for (contrast, paths) in cells {
        groups.entry(paths - &common).or_default().push(contrast);
    }
    groups.remove(&Paths::new());
    let all: Vec<&Contrast> = cells.iter().map(|(contrast, _)| *contrast).collect();
    told.extend(groups.iter().map(|(more, some)| format!("where {} also in {}", shared(some, &all), named(more))));
    told.join("; ")
}

fn named(paths: &Paths) -> String {
    let mut names: Vec<&str> = paths.iter().take(N_NAMED).map(String::as_str).collect();
    let more = format!("{} more", paths.len().saturating_sub(N_NAMED));
    if paths.len() > N_NAMED {
        names.push(&more);
    }
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}

/// What tells `some` of the contrasts from all others: their levels of as few axes as will do.
fn shared(some: &[&Contrast], all: &[&Contrast]) -> String {
    let label = |contrast: &Contrast, axes: &[usize]| {
        let levels = axes.iter().map(|axis| &contrast.axes[*axis]);
        levels.map(|level| format!("{}={}", level.axis, level.level)).collect::<Vec<_>>().join(" ")
    };
    let labels = |axes: &[usize]| some.iter().map(|contrast| label(contrast, axes)).collect::<BTreeSet<_>>();
    let will_do = |axes: &[usize]| {
        let labels = labels(axes);
        all.iter().filter(|contrast| labels.contains(&label(contrast, axes))).count() == some.len()
    };
    let n_axes = some[0].axes.len();
    let axes = fewest(n_axes, will_do).unwrap_or_else(|| (0..n_axes).collect());
    labels(&axes).into_iter().collect::<Vec<_>>().join(" or ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::Metric;
    use crate::report::contrast::Difference;
    use crate::store::AxisLevel;

    fn paths(names: &[&str]) -> Paths {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn another_type_stands_for_all_that_is_in_it() {
        let found = folded(paths(&["reward.type", "reward.terms.0.weight", "rewards", "env.goal"]));
        assert_eq!(found, paths(&["reward", "rewards", "env.goal"]));
        assert_eq!(folded(paths(&["speeds.0", "speeds.1", "terms.1.weight"])), paths(&["speeds", "terms.1.weight"]));
    }

    #[test]
    fn what_sets_cells_apart_is_said_in_few_words() {
        let contrast = |reading: &str, agent: &str| Contrast {
            axes: [("reading", reading), ("agent", agent)]
                .map(|(axis, level)| AxisLevel { axis: axis.into(), level: level.into() })
                .into(),
            world: None,
            level: "S".into(),
            runs: None,
            n_seeds: 0,
            differences: Metric::ALL.map(|_| Difference::new(&[])),
        };
        let all = [("P", "DQN"), ("P", "DDQN"), ("T", "DQN"), ("T", "DDQN"), ("H", "DQN"), ("H", "DDQN")];
        let all = all.map(|(reading, agent)| contrast(reading, agent));
        let all: Vec<&Contrast> = all.iter().collect();
        assert_eq!(shared(&all[4..], &all), "reading=H");
        assert_eq!(shared(&all[2..], &all), "reading=H or reading=T");
        assert_eq!(shared(&[all[0], all[2], all[4]], &all), "agent=DQN");
        assert_eq!(shared(&all[1..2], &all), "reading=P agent=DDQN");
        let cells: Vec<Differing<'_>> = all
            .iter()
            .map(|of| (*of, paths(if of.axes[0].level == "H" { &["reward", "env.goal"] } else { &["reward"] })))
            .collect();
        assert_eq!(told(&cells), "reward; where reading=H also in env.goal");
    }

    #[test]
    fn long_lists_are_counted() {
        assert_eq!(named(&paths(&[])), "nothing");
        assert_eq!(named(&paths(&["a", "b", "c", "d", "e", "f"])), "a, b, c, d, 2 more");
    }
}
