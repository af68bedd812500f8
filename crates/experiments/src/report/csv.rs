//! The report as CSV: a row per cell and world.

use super::{Interval, Report, Row};
use crate::episode::Metric;

/// Records of equal length as CSV.
pub(super) fn written(mut records: impl Iterator<Item = Vec<String>>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    records.try_for_each(|record| writer.write_record(record)).expect("records of equal length in memory");
    let bytes = writer.into_inner().expect("a writer in memory");
    String::from_utf8(bytes).expect("made of strings")
}

impl Report {
    /// The rows as CSV with a header: the axes, `world`, `seeds`, `episodes` (of all seeds together), and for each
    /// [`Metric`] its mean, `_low` and `_high`; empty where undefined. Rates are shares in [0, 1]. Then, of a single
    /// policy, `_wilson_low` and `_wilson_high` of its rates. At the end `trained`, the seeds that were trained, evaluated or not,
    /// and `collapsed`, how many of them collapsed, by their training or in that world; both empty where none was.
    pub fn csv(&self) -> String {
        written(std::iter::once(self.header()).chain(self.rows.iter().map(|row| self.record(row))))
    }

    fn header(&self) -> Vec<String> {
        let mut fields = self.axes.clone();
        fields.extend(["world", "seeds", "episodes"].map(str::to_owned));
        fields.extend(Metric::ALL.iter().flat_map(|m| ["", "_low", "_high"].map(|end| m.name().to_owned() + end)));
        fields.extend(
            self.with_wilson().flat_map(|m| ["_wilson_low", "_wilson_high"].map(|end| m.name().to_owned() + end)),
        );
        fields.extend(["trained", "collapsed"].map(str::to_owned));
        fields
    }

    fn record(&self, row: &Row) -> Vec<String> {
        let mut fields: Vec<String> = row.axes.iter().map(|level| level.level.clone()).collect();
        fields.extend([row.world.clone(), row.n_seeds.to_string(), row.n_episodes.to_string()]);
        let over_seeds = row.estimates.iter().flat_map(|e| [e.mean, e.low, e.high]);
        let over_episodes = self.with_wilson().flat_map(|metric| {
            let wilson = row.wilson[super::place(metric)];
            [wilson.map(|(low, _)| low), wilson.map(|(_, high)| high)]
        });
        let numbers = over_seeds.chain(over_episodes);
        fields.extend(numbers.map(|number| number.map_or_else(String::new, |number| number.to_string())));
        let of_trained =
            row.collapsed.n().map(|n_collapsed| [row.collapsed.n_trained, n_collapsed].map(|n| n.to_string()));
        fields.extend(of_trained.unwrap_or_default());
        fields
    }

    /// The metrics that have columns for intervals over the episodes.
    fn with_wilson(&self) -> impl Iterator<Item = Metric> {
        let is_wanted = self.interval == Interval::Episodes;
        Metric::ALL.into_iter().filter(move |metric| is_wanted && metric.outcome().is_some())
    }
}
