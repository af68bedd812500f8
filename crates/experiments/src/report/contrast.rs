//! The levels of one axis beside each other, all else alike: what a change is worth, and whether it can be told from luck.

mod records;
mod table;

pub(super) use table::{difference_text, probability_text};

use headway_stats::{Bootstrap, Estimate, Interval, Scores, improvement_bootstrap, over_units};
use serde::Serialize;

use super::{Report, RunRow};
use crate::Error;
use crate::episode::{Metric, SeedSummary};
use crate::store::AxisLevel;

/// The name under which the worlds of the evaluations are compared, unless the grid has an axis of that name.
pub const WORLD: &str = "world";

/// Every level of one axis against one of them, made by [`Report::contrasts`].
///
/// [`table`](Self::table), [`json`](Self::json) and [`csv`](Self::csv) show the same contrasts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contrasts {
    /// The axis, or [`WORLD`].
    pub over: String,
    /// The level that the others are held against.
    pub base: String,
    /// One for each other level and each setting of all the rest, in the order of the grid.
    pub contrasts: Vec<Contrast>,
}

/// One level against the base, all else alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Contrast {
    /// The levels of the other axes, which both have.
    pub axes: Vec<AxisLevel>,
    /// The world that both were evaluated in; `None` if worlds are what is compared.
    pub world: Option<String>,
    /// The level.
    pub level: String,
    /// Number of training seeds that both have.
    pub n_seeds: usize,
    /// In the order of [`Metric::ALL`].
    pub differences: [Difference; Metric::ALL.len()],
}

/// One metric of a level against the base's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Difference {
    /// The mean of level less base, seed by seed, and its 95 % percentile bootstrap interval over the seeds in which both are
    /// defined. Seeds start from the same weights and meet the same scenarios with both, so that their luck cancels.
    #[serde(rename = "difference")]
    pub paired: Estimate,
    /// In how many of these seeds the level has more.
    #[serde(rename = "seeds_more")]
    pub n_more: usize,
    /// How likely a run of the level is to have more than a run of the base, ties by half, with its 95 % bootstrap interval, for
    /// which the seeds of the two are redrawn independently: the probability of improvement (Agarwal et al., 2021, section 4.3),
    /// if more is better. From three seeds on.
    pub more: Option<Interval>,
}

/// A cell in a world: what has one value for each seed.
struct Arm<'a> {
    axes: Vec<AxisLevel>,
    world: Option<String>,
    level: String,
    seeds: Vec<(u64, &'a SeedSummary)>,
}

impl Report {
    /// Every level of the axis `over` against `base`, or else the first: pairs of cells that differ in that axis alone, in each
    /// world that both were evaluated in. With [`WORLD`], the same policies in one world and in another.
    ///
    /// # Errors
    /// [`Error::Input`] if there is no such axis or level, or the axis has but one.
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
        let against = |arm: &Arm<'_>| {
            let is_alike = |other: &&Arm<'_>| other.level == base && other.axes == arm.axes && other.world == arm.world;
            (arm.level != base).then(|| arms.iter().find(is_alike).map(|other| arm.against(other)))?
        };
        let contrasts = arms.iter().filter_map(against).collect();
        Ok(Contrasts { over: over.to_owned(), base: base.to_owned(), contrasts })
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
        let world = runs[0].summaries[k].0.clone();
        let (level, world) = match axis {
            Some(axis) => (axes.remove(axis).level, Some(world)),
            None => (world, None),
        };
        let seeds = runs.iter().filter_map(|run| Some((run.seed, run.summaries[k].1.as_ref()?))).collect();
        Self { axes, world, level, seeds }
    }

    fn against(&self, base: &Self) -> Contrast {
        let shared = |(seed, summary): &(u64, &'a SeedSummary)| {
            let other = base.seeds.iter().find(|(other, _)| other == seed)?;
            Some((*summary, other.1))
        };
        let pairs: Vec<_> = self.seeds.iter().filter_map(shared).collect();
        Contrast {
            axes: self.axes.clone(),
            world: self.world.clone(),
            level: self.level.clone(),
            n_seeds: pairs.len(),
            differences: Metric::ALL.map(|metric| {
                let less: Vec<Option<f64>> = pairs.iter().map(|(x, y)| Some(metric.of(x)? - metric.of(y)?)).collect();
                let n_more = less.iter().flatten().filter(|less| **less > 0.0).count();
                let scores = |arm: &Self| {
                    let rows: Vec<_> =
                        arm.seeds.iter().filter_map(|(_, summary)| Some([metric.of(summary)?])).collect();
                    Scores::from_rows(&rows).ok().filter(|scores| scores.n_runs() >= headway_stats::MIN_UNITS)
                };
                let both = scores(self).zip(scores(base));
                let more = both.and_then(|(x, y)| improvement_bootstrap(&x, &y, &Bootstrap::default()).ok());
                Difference { paired: over_units(less.iter().copied(), &Bootstrap::default()), n_more, more }
            }),
        }
    }
}

impl Contrast {
    /// The difference in a metric.
    pub fn difference(&self, metric: Metric) -> &Difference {
        &self.differences[super::place(metric)]
    }
}

impl Difference {
    /// Whether it can be told from nothing: its interval does not hold 0.
    pub fn leaves_out_zero(&self) -> bool {
        let Estimate { low, high, .. } = self.paired;
        low.is_some_and(|low| low > 0.0) || high.is_some_and(|high| high < 0.0)
    }
}

#[cfg(test)]
mod tests;
