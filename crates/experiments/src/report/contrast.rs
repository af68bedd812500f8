//! The levels of one axis beside each other, the other axes alike: what a change is worth, and whether it can be told from luck.

mod collapsed;
mod records;
mod settings;
mod table;

pub use settings::{LevelSettings, SomeSettings};
pub(super) use table::{difference_text, probability_text, seeds_text};

use headway_stats::{Bootstrap, Estimate, Interval, MIN_UNITS, Scores, improvement_bootstrap, over_units, sign_flip};
use serde::Serialize;

use super::{Policy, Report, RunRow};
use crate::Error;
use crate::episode::{Metric, SeedSummary};
use crate::store::{AxisLevel, Id};

/// The name under which the worlds of the evaluations are compared; no axis of a grid has it.
pub const WORLD: &str = "world";

/// The greatest p of a difference that is told from luck.
const MOST_P: f64 = 0.05;

/// Every level of one axis against one of them, made by [`Report::contrasts`].
///
/// [`table`](Self::table), [`json`](Self::json) and [`csv`](Self::csv) show the same contrasts; [`settings`](Self::settings), which
/// the first two have too, say what else differs between the two sides.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contrasts {
    /// The axis, or [`WORLD`].
    pub over: String,
    /// The level that the others are held against.
    pub base: String,
    /// For each level what differs in its training, from [`with_settings`](Self::with_settings); none before.
    pub settings: Vec<LevelSettings>,
    /// One or more: for each other level and each setting of all the rest, in the order of the grid.
    pub contrasts: Vec<Contrast>,
    /// Number of cells in a world that are of another level, and have nothing to be held against.
    pub n_alone: usize,
}

/// One level against the base, the other axes alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Contrast {
    /// The levels of the other axes, which both have.
    pub axes: Vec<AxisLevel>,
    /// The world that both were evaluated in; `None` if worlds are what is compared.
    pub world: Option<String>,
    /// The level.
    pub level: String,
    /// A run of the level's cell and one of the base's, of the first seed that both have.
    pub runs: Option<[Id; 2]>,
    /// Number of training seeds that both have.
    pub n_seeds: usize,
    /// Of how many of these the policy collapsed, the level's and the base's: by its training, or in that world. `None` where nothing was
    /// trained.
    pub n_collapsed: [Option<usize>; 2],
    /// In the order of [`Metric::ALL`].
    pub differences: [Difference; Metric::ALL.len()],
}

/// One metric of a level against the base's, over the seeds in which both are defined. Seeds start from the same weights and meet the
/// same scenarios with both, so that their luck cancels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Difference {
    /// The mean of level less base, seed by seed, and its 95 % percentile bootstrap interval over the seeds.
    #[serde(rename = "difference")]
    pub paired: Estimate,
    /// How likely such differences, or ones farther from 0, are if the two are drawn alike: [`sign_flip`]. `None` without a seed.
    pub p: Option<f64>,
    /// In how many of the seeds the level has more.
    #[serde(rename = "seeds_more")]
    pub n_more: usize,
    /// How likely a run of the level is to have more than a run of the base, of whatever seeds, ties by half: the probability of
    /// improvement (Agarwal et al., 2021, section 4.3), if more is better. Its 95 % bootstrap interval redraws the seeds of the two
    /// independently, so that it is too wide where they are alike seed by seed, as one policy in two worlds. From three seeds on.
    pub more: Option<Interval>,
}

/// A cell in a world: what has one value for each seed.
struct Arm<'a> {
    axes: Vec<AxisLevel>,
    world: Option<String>,
    level: String,
    /// The name of the world that its seeds were evaluated in.
    evaluated_in: &'a str,
    seeds: Vec<(&'a RunRow, &'a SeedSummary)>,
}

impl Report {
    /// Every level of the axis `over` against `base`, or else the first: pairs of cells that differ in that axis alone, in each
    /// world that both were evaluated in. With [`WORLD`], the same policies in one world and in another.
    ///
    /// # Errors
    /// [`Error::Input`] if there is no such axis or level, the axis has but one, or no two cells differ in it alone.
    ///
    /// ```
    /// use headway_experiments::report::of_policy;
    ///
    /// let refusal = of_policy(&[("room", vec![])]).contrasts("gamma", None).unwrap_err();
    /// assert_eq!(refusal.to_string(), "no axis `gamma` to compare over: must be one of world");
    /// ```
    pub fn contrasts(&self, over: &str, base: Option<&str>) -> Result<Contrasts, Error> {
        let arms = self.arms(over)?;
        let mut levels: Vec<&str> = Vec::new();
        for arm in &arms {
            if !levels.contains(&&*arm.level) {
                levels.push(&arm.level);
            }
        }
        let base = match (base, &levels[..]) {
            (Some(base), levels) if !levels.contains(&base) => {
                return Err(Error::Input(format!(
                    "axis `{over}` has no level `{base}`: must be one of {}",
                    levels.join(", ")
                )));
            }
            (_, [] | [_]) => {
                return Err(Error::Input(format!("axis `{over}` has one level only: nothing to compare")));
            }
            (Some(base), _) => base,
            (None, [first, ..]) => first,
        };
        let others = || arms.iter().filter(|arm| arm.level != base);
        let against = |arm: &Arm<'_>| {
            let is_alike = |other: &&Arm<'_>| other.level == base && other.axes == arm.axes && other.world == arm.world;
            Some(arm.against(arms.iter().find(is_alike)?))
        };
        let contrasts: Vec<Contrast> = others().filter_map(against).collect();
        if contrasts.is_empty() {
            return Err(Error::Input(format!(
                "nothing to hold against `{base}`: no other cell has the same world and the same levels of all axes but `{over}`"
            )));
        }
        let n_alone = others().count() - contrasts.len();
        let (over, base, settings) = (over.to_owned(), base.to_owned(), Vec::new());
        Ok(Contrasts { over, base, settings, contrasts, n_alone })
    }

    /// What can be compared over an axis.
    fn arms(&self, over: &str) -> Result<Vec<Arm<'_>>, Error> {
        let axis = self.axes.iter().position(|axis| axis == over);
        if axis.is_none() && over != WORLD {
            let mut names: Vec<&str> = self.axes.iter().map(String::as_str).collect();
            names.push(WORLD);
            return Err(Error::Input(format!("no axis `{over}` to compare over: must be one of {}", names.join(", "))));
        }
        let cells = self.runs.chunk_by(|run, next| run.axes == next.axes);
        Ok(cells.flat_map(|runs| (0..runs[0].summaries.len()).map(move |k| Arm::new(axis, runs, k))).collect())
    }
}

impl<'a> Arm<'a> {
    /// The runs of a cell in the `k`-th of their worlds; without an axis, the world is the level.
    fn new(axis: Option<usize>, runs: &'a [RunRow], k: usize) -> Self {
        let mut axes = runs[0].axes.clone();
        let evaluated_in = &runs[0].summaries[k].0;
        let (level, world) = match axis {
            Some(axis) => (axes.remove(axis).level, Some(evaluated_in.clone())),
            None => (evaluated_in.clone(), None),
        };
        let seeds = runs.iter().filter_map(|run| Some((run, run.summaries[k].1.as_ref()?))).collect();
        Self { axes, world, level, evaluated_in, seeds }
    }

    fn against(&self, base: &Self) -> Contrast {
        let shared = |of: &(&'a RunRow, &'a SeedSummary)| {
            Some((*of, *base.seeds.iter().find(|(other, _)| other.seed == of.0.seed)?))
        };
        let pairs: Vec<_> = self.seeds.iter().filter_map(shared).collect();
        let defined =
            |metric: Metric| pairs.iter().filter_map(move |((_, x), (_, y))| Some((metric.of(x)?, metric.of(y)?)));
        Contrast {
            axes: self.axes.clone(),
            world: self.world.clone(),
            level: self.level.clone(),
            runs: pairs.first().map(|((level, _), (base, _))| [level.train_id.clone(), base.train_id.clone()]),
            n_seeds: pairs.len(),
            n_collapsed: [
                self.n_collapsed(pairs.iter().map(|((run, _), _)| *run)),
                base.n_collapsed(pairs.iter().map(|(_, (run, _))| *run)),
            ],
            differences: Metric::ALL.map(|metric| Difference::new(&defined(metric).collect::<Vec<_>>())),
        }
    }

    /// How many of some of its runs collapsed; none if none was trained.
    fn n_collapsed(&self, runs: impl Iterator<Item = &'a RunRow>) -> Option<usize> {
        let trained: Vec<&RunRow> = runs.filter(|run| matches!(run.policy, Policy::At(_))).collect();
        let collapsed = trained.iter().filter(|run| run.collapse_in(self.evaluated_in).next().is_some());
        (!trained.is_empty()).then(|| collapsed.count())
    }
}

impl Contrast {
    /// The difference in a metric.
    pub fn difference(&self, metric: Metric) -> &Difference {
        &self.differences[super::place(metric)]
    }
}

impl Difference {
    /// Of the level's number and the base's, seed by seed.
    fn new(pairs: &[(f64, f64)]) -> Self {
        let less: Vec<f64> = pairs.iter().map(|(x, y)| x - y).collect();
        let scores = |side: fn(&(f64, f64)) -> f64| Scores::new(pairs.len(), 1, pairs.iter().map(side).collect()).ok();
        let both = scores(|pair| pair.0).zip(scores(|pair| pair.1)).filter(|_| pairs.len() >= MIN_UNITS);
        let how = Bootstrap::default();
        Self {
            paired: over_units(less.iter().copied().map(Some), &how),
            p: (!less.is_empty()).then(|| sign_flip(&less)),
            n_more: less.iter().filter(|less| **less > 0.0).count(),
            more: both.and_then(|(x, y)| improvement_bootstrap(&x, &y, &how).ok()),
        }
    }

    /// Whether it is 0 in every seed, as where both sides are the same runs, or defined in none.
    pub fn is_none_at_all(&self) -> bool {
        let Estimate { mean, low, high, .. } = self.paired;
        mean.is_none_or(|mean| mean == 0.0 && low == high)
    }

    /// Whether it can be told from luck: `p <= 0.05`.
    pub fn is_told_from_luck(&self) -> bool {
        self.p.is_some_and(|p| p <= MOST_P)
    }
}

#[cfg(test)]
mod tests;
