//! The report as CSV: a row per cell and world.

use super::{Report, Row};
use crate::episode::Metric;

impl Report {
    /// The rows as CSV with a header: the axes, `world`, `seeds`, `episodes` (of all seeds together), and for each
    /// [`Metric`] its mean, `_low` and `_high`; empty where undefined. Rates are shares in [0, 1].
    pub fn csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        std::iter::once(header(&self.axes))
            .chain(self.rows.iter().map(record))
            .try_for_each(|record| writer.write_record(record))
            .expect("records of equal length in memory");
        let bytes = writer.into_inner().expect("a writer in memory");
        String::from_utf8(bytes).expect("made of strings")
    }
}

fn header(axes: &[String]) -> Vec<String> {
    let mut fields = axes.to_vec();
    fields.extend(["world", "seeds", "episodes"].map(str::to_owned));
    fields.extend(Metric::ALL.iter().flat_map(|m| ["", "_low", "_high"].map(|end| format!("{}{end}", m.name()))));
    fields
}

fn record(row: &Row) -> Vec<String> {
    let mut fields: Vec<String> = row.axes.iter().map(|level| level.level.clone()).collect();
    fields.extend([row.world.clone(), row.n_seeds.to_string(), row.n_episodes.to_string()]);
    let numbers = row.estimates.iter().flat_map(|e| [e.mean, e.low, e.high]);
    fields.extend(numbers.map(|number| number.map_or_else(String::new, |number| number.to_string())));
    fields
}
