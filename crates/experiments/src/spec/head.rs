//! The head of a spec file: its name, its seeds, and the axes of a grid.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use toml::Table;

use super::names::{check_folder, check_label};
use super::suggest::{did_you_mean, list};
use super::{Fault, KeyPath};
use crate::episode::Metric;

/// Columns that reports have beside those of the axes and of the metrics.
const COLUMNS: [&str; 23] = [
    "world",
    "seeds",
    "episodes",
    "collapsed",
    "trained",
    "base",
    "metric",
    "seeds_more",
    "difference",
    "low",
    "high",
    "p",
    "more",
    "more_low",
    "more_high",
    "collapsed_base",
    // Of the list of runs, here and on pages.
    "cell",
    "seed",
    "run",
    "id",
    "policy",
    "path",
    "collapse",
];

/// What stands behind a metric's name in the columns that belong to it.
const ENDS: [&str; 5] = ["", "_low", "_high", "_wilson_low", "_wilson_high"];

/// Whether reports have a column of this name, whatever the axes of the grid.
pub(crate) fn is_column(name: &str) -> bool {
    let of_metric = |metric: &Metric| name.strip_prefix(metric.name()).is_some_and(|end| ENDS.contains(&end));
    COLUMNS.contains(&name) || Metric::ALL.iter().any(of_metric)
}

/// The keys of a spec file that describe the grid rather than one run.
pub(crate) const HEAD_KEYS: [&str; 5] = ["name", "base", "seeds", "axis", "when"];

/// Runs that a spec may stand for.
const MAX_RUNS: u64 = 1_000_000;

/// What a spec file says about the grid; every key may be missing.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Head {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    #[serde(default)]
    pub(crate) seeds: Seeds,
    #[serde(default)]
    pub(crate) axis: Vec<Axis>,
    #[serde(default)]
    pub(crate) when: Vec<When>,
}

/// The training seeds: `count` whole numbers from `first` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Seeds {
    /// The first seed.
    pub first: u64,
    /// How many seeds, 1 or more; cells x seeds are at most 1 000 000.
    pub count: u64,
}

impl Default for Seeds {
    fn default() -> Self {
        Self { first: 0, count: 1 }
    }
}

impl Seeds {
    /// Every seed, in order.
    ///
    /// ```
    /// use headway_experiments::spec::Seeds;
    /// assert_eq!(Seeds { first: 5, count: 2 }.iter().collect::<Vec<_>>(), [5, 6]);
    /// ```
    pub fn iter(&self) -> impl Iterator<Item = u64> + use<> {
        self.first..self.first.saturating_add(self.count)
    }
}

/// One axis of a grid: a name and its levels in the file's order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// What the axis varies, as tables and plots call it.
    pub name: String,
    /// Level name -> table of dotted path -> value.
    pub levels: Table,
}

/// Replacements for the cells in which the named axes have the named levels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct When {
    /// Axis name -> level name; a cell must match all of them.
    #[serde(rename = "match")]
    pub(crate) matches: BTreeMap<String, String>,
    /// Dotted path -> value.
    pub(crate) set: Table,
}

impl Head {
    /// Refuses what no grid can be made of.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        self.check_name()?;
        for (index, axis) in self.axis.iter().enumerate() {
            self.check_axis(index, axis)?;
        }
        self.check_n_runs()?;
        self.check_seeds()?;
        for (index, when) in self.when.iter().enumerate() {
            self.check_when(index, when)?;
        }
        Ok(())
    }

    fn check_name(&self) -> Result<(), Fault> {
        match &self.name {
            Some(name) => check_folder(name).map_err(|problem| Fault::new(["name"], problem)),
            None => Ok(()),
        }
    }

    fn check_seeds(&self) -> Result<(), Fault> {
        let Seeds { first, count } = self.seeds;
        if count == 0 {
            let problem = "must be 1 or more: without a seed there is nothing to run";
            return Err(Fault::new(["seeds", "count"], problem));
        }
        match first.checked_add(count) {
            Some(end) if end <= i64::MAX as u64 => Ok(()),
            _ => Err(Fault::new(["seeds", "first"], "must leave every seed below 2^63")),
        }
    }

    fn check_n_runs(&self) -> Result<(), Fault> {
        let n_cells = self.axis.iter().fold(1, |n: u64, axis| n.saturating_mul(axis.levels.len() as u64));
        if n_cells > MAX_RUNS {
            return Err(Fault::new(
                ["axis"],
                format!("make {n_cells} cells; a spec may stand for {MAX_RUNS} runs at most"),
            ));
        }
        let at_most = MAX_RUNS / n_cells;
        if self.seeds.count > at_most {
            let problem =
                format!("must be {at_most} or less: a spec may stand for {MAX_RUNS} runs at most, cells x seeds");
            return Err(Fault::new(["seeds", "count"], problem));
        }
        Ok(())
    }

    fn check_axis(&self, index: usize, axis: &Axis) -> Result<(), Fault> {
        let here = KeyPath::new(["axis", &index.to_string()]);
        let fault = |key: &str, problem: &str| Err(Fault::new(here.join(key).segments(), problem));
        if let Err(problem) = check_label(&axis.name) {
            return fault("name", problem);
        }
        if is_column(&axis.name) {
            return fault("name", "is the name of a column of reports; give the axis another");
        }
        if self.axis[..index].iter().any(|other| other.name == axis.name) {
            return fault("name", "an earlier axis has this name; give each axis its own");
        }
        if axis.levels.is_empty() {
            return fault("levels", "must hold at least one level: NAME = { \"dotted.path\" = value }");
        }
        let of_level =
            |level: &String, problem: &str| Fault { path: here.join("levels").join(level), problem: problem.into() };
        axis.levels.iter().try_for_each(|(level, set)| match check_label(level) {
            Err(problem) => Err(of_level(level, &format!("the name {problem}"))),
            Ok(()) if !set.is_table() => Err(of_level(level, "must be a table: { \"dotted.path\" = value }")),
            Ok(()) => Ok(()),
        })
    }

    fn check_when(&self, index: usize, when: &When) -> Result<(), Fault> {
        let here = KeyPath::new(["when", &index.to_string(), "match"]);
        if when.matches.is_empty() {
            return Err(Fault::new(here.segments(), "must name at least one axis and its level"));
        }
        for (name, level) in &when.matches {
            self.check_match(name, level).map_err(|problem| Fault { path: here.join(name), problem })?;
        }
        Ok(())
    }

    fn check_match(&self, name: &str, level: &str) -> Result<(), String> {
        let axes: Vec<&str> = self.axis.iter().map(|axis| axis.name.as_str()).collect();
        let Some(axis) = self.axis.iter().find(|axis| axis.name == name) else {
            return Err(format!("unknown axis `{name}`{}", choices(name, &axes, "Axes")));
        };
        if axis.levels.contains_key(level) {
            return Ok(());
        }
        let levels: Vec<&String> = axis.levels.keys().collect();
        Err(format!("unknown level of axis `{name}`{}", choices(level, &levels, "Levels")))
    }
}

/// The end of a sentence about an unknown `word`: a suggestion, and the words that are known.
fn choices<S: AsRef<str>>(word: &str, known: &[S], label: &str) -> String {
    if known.is_empty() {
        return ": this spec has none".into();
    }
    format!("{}{label}: {}", did_you_mean(word, known), list(known))
}
