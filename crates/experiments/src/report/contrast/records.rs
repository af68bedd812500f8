//! Contrasts for programs: JSON and CSV.

use headway_stats::Estimate;
use serde::ser::{Serialize, SerializeMap, Serializer};

use super::{Contrast, Contrasts, Difference};
use crate::episode::Metric;
use crate::report::csv::written;
use crate::report::json::Levels;

/// The columns of a difference in CSV.
const NUMBERS: [&str; 12] = [
    "metric",
    "seeds",
    "seeds_more",
    "difference",
    "low",
    "high",
    "p",
    "more",
    "more_low",
    "more_high",
    "collapsed",
    "collapsed_base",
];

impl Contrasts {
    /// The contrasts as a JSON object: `over`, `base`, `settings`, and `contrasts`, a list of objects: `axes` (level by axis, without the one
    /// that is compared over), `world` (`null` if worlds are compared), `level`, `seeds`, `collapsed` (of how many of them the policy of
    /// `level` and of `base` did, by its training or in that world; `null` where nothing was trained), and for each [`Metric`] `difference`
    /// (`mean`, `low`, `high`; rates as shares; `n`, the shared seeds in which both have it), `p`, `seeds_more`, and `more` (`point`,
    /// `low`, `high`; `null` for fewer than three seeds). `n_alone` counts what has nothing to be held against.
    /// The `settings`, one object for each `level` whose training differs from the base's, are lists of dotted paths: `in_all_cells`, and
    /// `in_some_cells` objects of `cells` (level by axis) and the `paths` in which these differ besides.
    pub fn json(&self) -> String {
        let text = serde_json::to_string_pretty(self);
        text.expect("maps with string keys and numbers always have a JSON form") + "\n"
    }

    /// The contrasts as CSV, a row for each in each metric: the other axes, `world`, the axis that is compared over, `base`, and
    /// [`Difference`]'s numbers, of which `seeds` counts those in which both have the metric; empty where undefined. At the end
    /// `collapsed` and `collapsed_base`: of how many of all shared seeds the policy did. Settings are not in it.
    pub fn csv(&self) -> String {
        let rows = self.contrasts.iter().flat_map(|contrast| Metric::ALL.map(|metric| self.record(contrast, metric)));
        written(std::iter::once(self.header()).chain(rows))
    }

    fn header(&self) -> Vec<String> {
        let first = self.contrasts.first();
        let mut fields: Vec<String> =
            first.iter().flat_map(|c| c.axes.iter().map(|level| level.axis.clone())).collect();
        if first.is_some_and(|contrast| contrast.world.is_some()) {
            fields.push(super::WORLD.to_owned());
        }
        fields.extend([self.over.clone(), "base".to_owned()]);
        fields.extend(NUMBERS.map(str::to_owned));
        fields
    }

    fn record(&self, contrast: &Contrast, metric: Metric) -> Vec<String> {
        let Difference { paired, p, n_more, more } = contrast.difference(metric);
        let mut fields: Vec<String> = contrast.axes.iter().map(|level| level.level.clone()).collect();
        fields.extend(contrast.world.clone());
        fields.extend([contrast.level.clone(), self.base.clone(), metric.name().to_owned()]);
        fields.extend([paired.n, *n_more].map(|n| n.to_string()));
        let Estimate { mean, low, high, .. } = *paired;
        let more = [more.map(|more| more.point), more.map(|more| more.low), more.map(|more| more.high)];
        let numbers = [mean, low, high, *p].into_iter().chain(more);
        fields.extend(numbers.map(|number| number.map_or_else(String::new, |number| number.to_string())));
        fields.extend(contrast.n_collapsed.map(|n| n.map_or_else(String::new, |n| n.to_string())));
        fields
    }
}

/// Counts of the seeds that collapsed.
#[derive(serde::Serialize)]
struct Sides {
    level: Option<usize>,
    base: Option<usize>,
}

impl Serialize for Contrast {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("axes", &Levels(&self.axes))?;
        map.serialize_entry("world", &self.world)?;
        map.serialize_entry("level", &self.level)?;
        map.serialize_entry("seeds", &self.n_seeds)?;
        let [level, base] = self.n_collapsed;
        map.serialize_entry("collapsed", &Sides { level, base })?;
        for (metric, difference) in Metric::ALL.iter().zip(&self.differences) {
            map.serialize_entry(metric.name(), difference)?;
        }
        map.end()
    }
}
