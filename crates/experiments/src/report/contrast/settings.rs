//! What else differs between two cells than the level that is looked at.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::{Serialize, Serializer};
use toml::Value;

use super::Contrasts;
use crate::Error;
use crate::difference::changes;
use crate::report::TABLE_WIDTH;
use crate::report::axes::shared;
use crate::report::json::Levels;
use crate::report::layout::wrapped;
use crate::store::{AxisLevel, Id, RunFolder};

/// The tables that are told first.
const FIRST: [&str; 3] = ["reward", "world", "env"];

/// The table that only those have who are trained.
const TRAINING: &str = "train";
/// The table that only those have who are not.
const POLICY: &str = "policy";

/// Dotted paths of a spec.
type Paths = BTreeSet<String>;

/// The levels of a cell, and the settings in which its two sides differ.
type Differing = (Vec<AxisLevel>, Paths);

/// In which settings a level differs from the base, evaluation aside: dotted paths of the spec, those of the reward, the world
/// and the env first; where one of them is not trained, what both have, and `policy`. A table of another type stands for all that is in it, a list for its numbers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LevelSettings {
    /// The level.
    pub level: String,
    /// Those in which it differs in every cell.
    #[serde(rename = "in_all_cells")]
    pub all: Vec<String>,
    /// Those in which it differs in some cells only, as a `[[when]]` of a grid has it.
    #[serde(rename = "in_some_cells")]
    pub some: Vec<SomeSettings>,
    /// The levels of all cells, of the other axes.
    #[serde(skip)]
    cells: Vec<Vec<AxisLevel>>,
}

/// Settings in which a level differs in some cells only.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SomeSettings {
    /// The levels of these cells, of the other axes.
    #[serde(serialize_with = "as_maps")]
    pub cells: Vec<Vec<AxisLevel>>,
    /// The settings.
    pub paths: Vec<String>,
}

fn as_maps<S: Serializer>(cells: &[Vec<AxisLevel>], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(cells.iter().map(|cell| Levels(cell)))
}

impl Contrasts {
    /// These contrasts with their [`settings`](Self::settings), from the specs in the results folder at `root`. A `[[when]]` of a grid
    /// can change more than a level says.
    ///
    /// # Errors
    /// If the spec of a run cannot be read.
    pub fn with_settings(mut self, root: &Path) -> Result<Self, Error> {
        let mut levels: Vec<(String, Vec<Differing>)> = Vec::new();
        for contrast in &self.contrasts {
            let Some([level, base]) = &contrast.runs else { continue };
            let place = levels.iter().position(|(name, _)| *name == contrast.level).unwrap_or_else(|| {
                levels.push((contrast.level.clone(), Vec::new()));
                levels.len() - 1
            });
            let cells = &mut levels[place].1;
            // It is there once for each world.
            if cells.iter().all(|(axes, _)| *axes != contrast.axes) {
                cells.push((contrast.axes.clone(), differing(root, base, level)?));
            }
        }
        levels.retain(|(_, cells)| cells.iter().any(|(_, paths)| !paths.is_empty()));
        self.settings = levels.into_iter().map(|(level, cells)| LevelSettings::new(level, cells)).collect();
        Ok(self)
    }

    /// The settings in words: a line for each level, or several where one is too wide.
    pub fn settings_in_words(&self) -> Vec<String> {
        let line = |of: &LevelSettings| format!("{} and {} differ in {}", of.level, self.base, of.in_words());
        self.settings.iter().map(|of| wrapped(&line(of), TABLE_WIDTH)).collect()
    }
}

/// In what two runs differ, which may be one.
fn differing(root: &Path, base: &Id, level: &Id) -> Result<Paths, Error> {
    if base == level {
        return Ok(Paths::new());
    }
    let [base, level] = [RunFolder::new(root, base).spec()?, RunFolder::new(root, level).spec()?];
    let mut paths: Paths = changes(&Value::Table(base.clone()), &Value::Table(level.clone())).into_keys().collect();
    if [&base, &level].iter().any(|spec| !spec.contains_key(TRAINING)) {
        // Who is not trained has no settings of training, which says `policy`.
        let is_of_both = |path: &String| [&base, &level].iter().all(|spec| spec.contains_key(first_key(path)));
        paths.retain(|path| first_key(path) == POLICY || is_of_both(path));
    }
    Ok(folded(paths))
}

fn first_key(path: &str) -> &str {
    path.split('.').next().unwrap_or(path)
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

/// The paths of the first tables, and then the others.
fn sorted(paths: Paths) -> Vec<String> {
    let mut paths: Vec<String> = paths.into_iter().collect();
    let rank = |path: &String| FIRST.iter().position(|table| first_key(path) == *table);
    paths.sort_by_key(|path| rank(path).unwrap_or(FIRST.len()));
    paths
}

impl LevelSettings {
    /// What all cells differ in, and then what only some do.
    fn new(level: String, cells: Vec<Differing>) -> Self {
        let common = cells.iter().map(|(_, paths)| paths.clone()).reduce(|a, b| &a & &b).unwrap_or_default();
        let mut groups: BTreeMap<Paths, Vec<Vec<AxisLevel>>> = BTreeMap::new();
        for (axes, paths) in &cells {
            groups.entry(paths - &common).or_default().push(axes.clone());
        }
        groups.remove(&Paths::new());
        let some = groups.into_iter().map(|(paths, cells)| SomeSettings { cells, paths: sorted(paths) });
        let (some, cells) = (some.collect(), cells.into_iter().map(|(axes, _)| axes).collect());
        Self { level, all: sorted(common), some, cells }
    }

    fn in_words(&self) -> String {
        let all: Vec<&[AxisLevel]> = self.cells.iter().map(|cell| &cell[..]).collect();
        let named = if self.all.is_empty() { "nothing".to_owned() } else { self.all.join(", ") };
        let some = self.some.iter().map(|SomeSettings { cells, paths }| {
            let cells: Vec<&[AxisLevel]> = cells.iter().map(|cell| &cell[..]).collect();
            format!("where {} also in {}", shared(&cells, &all).join(" or "), paths.join(", "))
        });
        std::iter::once(named).chain(some).collect::<Vec<_>>().join("; ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(names: &[&str]) -> Paths {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn another_type_stands_for_all_that_is_in_it() {
        let found = folded(paths(&["reward.type", "reward.terms.0.weight", "rewards", "env.goal"]));
        assert_eq!(found, paths(&["reward", "rewards", "env.goal"]));
        assert_eq!(folded(paths(&["speeds.0", "speeds.1", "terms.1.weight"])), paths(&["speeds", "terms.1.weight"]));
    }

    /// The first four in the order of letters stood for all, and hid the reward.
    #[test]
    fn what_matters_most_is_told_first() {
        let all = ["agent.n_step", "env.goal", "envelope", "reward", "train.n_envs", "world.min_gap"];
        assert_eq!(
            sorted(paths(&all)),
            ["reward", "world.min_gap", "env.goal", "agent.n_step", "envelope", "train.n_envs"]
        );
    }

    #[test]
    fn some_cells_differ_in_more() {
        let cell = |reading: &str, agent: &str| {
            let levels = [("reading", reading), ("agent", agent)];
            levels.map(|(axis, level)| AxisLevel { axis: axis.into(), level: level.into() }).to_vec()
        };
        let of = |reading: &str| paths(if reading == "H" { &["reward", "env.goal"] } else { &["reward"] });
        let all = [("P", "DQN"), ("P", "DDQN"), ("H", "DQN"), ("H", "DDQN")];
        let cells: Vec<Differing> = all.iter().map(|(reading, agent)| (cell(reading, agent), of(reading))).collect();
        let settings = LevelSettings::new("S".into(), cells);
        assert_eq!(settings.in_words(), "reward; where reading=H also in env.goal");
        let json = serde_json::json!({
            "level": "S",
            "in_all_cells": ["reward"],
            "in_some_cells": [{
                "cells": [{ "reading": "H", "agent": "DQN" }, { "reading": "H", "agent": "DDQN" }],
                "paths": ["env.goal"],
            }],
        });
        assert_eq!(serde_json::to_value(&settings).unwrap(), json);
        let apart = vec![(cell("P", "DQN"), paths(&[])), (cell("H", "DQN"), paths(&["world"]))];
        let settings = LevelSettings::new("S".into(), apart);
        assert_eq!(settings.in_words(), "nothing; where reading=H also in world");
    }
}
