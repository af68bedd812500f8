//! The report as JSON: a list of objects, one per cell and world.

use headway_stats::Estimate;
use serde::ser::{Serialize, SerializeMap, Serializer};

use super::{Report, Row};
use crate::episode::Metric;
use crate::store::AxisLevel;

impl Report {
    /// The rows as a JSON list of objects: `axes` (level by axis), `world`, `seeds`, `episodes` (of all seeds together),
    /// and for each [`Metric`] its `mean`, `low`, `high` and the `n` of seeds in which it is defined; `null` where
    /// undefined. Rates are shares in [0, 1]; those of outcomes of a single policy, which has no interval over seeds, also have
    /// `wilson_low` and `wilson_high`, over its episodes. `collapsed` says how many `seeds` `of` those trained collapsed, by
    /// their training or in that world, and in `verdicts` which ones, and how: see [`Collapse`](crate::collapse::Collapse).
    pub fn json(&self) -> String {
        let text = serde_json::to_string_pretty(&self.rows);
        text.expect("maps with string keys and numbers always have a JSON form") + "\n"
    }
}

impl Serialize for Row {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("axes", &Levels(&self.axes))?;
        map.serialize_entry("world", &self.world)?;
        map.serialize_entry("seeds", &self.n_seeds)?;
        map.serialize_entry("episodes", &self.n_episodes)?;
        for ((metric, estimate), wilson) in Metric::ALL.iter().zip(&self.estimates).zip(self.wilson) {
            match wilson {
                None => map.serialize_entry(metric.name(), estimate)?,
                Some((wilson_low, wilson_high)) => {
                    map.serialize_entry(metric.name(), &WithWilson { estimate, wilson_low, wilson_high })?;
                }
            }
        }
        map.serialize_entry("collapsed", &self.collapsed)?;
        map.end()
    }
}

#[derive(serde::Serialize)]
struct WithWilson<'a> {
    #[serde(flatten)]
    estimate: &'a Estimate,
    wilson_low: f64,
    wilson_high: f64,
}

/// Levels as a map from axis to level, in the order of the axes.
pub(super) struct Levels<'a>(pub(super) &'a [AxisLevel]);

impl Serialize for Levels<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|level| (&level.axis, &level.level)))
    }
}
