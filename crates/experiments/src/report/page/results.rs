//! The table of results: every number leads to the runs behind it.

use super::text::escaped;
use crate::episode::Metric;
use crate::report::Collapsed;
use crate::report::study::Study;
use crate::report::table::{UNDEFINED, header_words, number};

/// The head of the column that says how many seeds collapsed.
const COLLAPSED: &str = "<th scope=\"col\" class=\"n\" data-metric=\"collapsed\">collapsed<small>seeds</small></th>";

impl Study {
    /// The table, one row per cell and world; each cell's rows are a body of their own.
    pub(super) fn results(&self) -> String {
        let metrics = self.report.metrics();
        let axis =
            |(k, axis): (usize, &String)| format!("<th scope=\"col\"{}>{}</th>", self.class_of_axis(k), escaped(axis));
        let axes: String = self.report.axes.iter().enumerate().map(axis).collect();
        let head: String = metrics.iter().map(|metric| column_head(*metric)).collect();
        let rows: Vec<usize> = (0..self.report.rows.len()).collect();
        let cells = rows.chunk_by(|row, next| self.places[*row].cell == self.places[*next].cell);
        let body = |rows: &[usize]| {
            let rows: String = rows.iter().map(|row| self.result(*row, &metrics)).collect();
            format!("<tbody>{rows}</tbody>")
        };
        let bodies: String = cells.map(body).collect();
        format!(
            "<table class=\"results sortable\"><thead><tr>{axes}<th scope=\"col\">world</th>\
             {seeds}{collapsed}{head}</tr></thead>{bodies}</table>",
            seeds = if self.has_own_seeds() { "<th scope=\"col\" class=\"n\">seeds</th>" } else { "" },
            collapsed = if self.is_trained() { COLLAPSED } else { "" },
        )
    }

    fn result(&self, row: usize, metrics: &[Metric]) -> String {
        let numbers = &self.report.rows[row];
        let levels = numbers.axes.iter().map(|level| level.level.as_str()).chain([numbers.world.as_str()]);
        let name = |(k, name)| format!("<th scope=\"row\"{}>{}</th>", self.class_of_axis(k), escaped(name));
        let names: String = levels.enumerate().map(name).collect();
        let cells: String = metrics.iter().map(|metric| self.cell(row, *metric)).collect();
        let collapsed = if self.is_trained() { self.collapsed(row) } else { String::new() };
        let n_seeds = format!("<td class=\"n\">{}</td>", numbers.n_seeds);
        let seeds = if self.has_own_seeds() { n_seeds } else { String::new() };
        format!("<tr>{names}{seeds}{collapsed}{cells}</tr>\n")
    }

    /// Whether the rows differ in their number of seeds, which is said above the table if they do not.
    fn has_own_seeds(&self) -> bool {
        self.report.common(|row| row.n_seeds).is_none()
    }

    /// Whether any run was trained, and so can have collapsed.
    fn is_trained(&self) -> bool {
        self.report.rows.iter().any(|row| row.collapsed.n_trained > 0)
    }

    /// How many of the trained seeds collapsed, which leads to their verdicts.
    fn collapsed(&self, row: usize) -> String {
        let Collapsed { n_trained, seeds } = &self.report.rows[row].collapsed;
        if *n_trained == 0 {
            return format!("<td class=\"n\" data-value=\"\">{UNDEFINED}</td>");
        }
        let (n, share) = (seeds.len(), seeds.len() as f64 / *n_trained as f64);
        let shown = if n > 0 { format!("<b>{n}/{n_trained}</b>") } else { format!("{n}/{n_trained}") };
        format!(
            "<td class=\"n\" data-value=\"{share}\"><a href=\"#runs-{row}\" data-metric=\"collapsed\">{shown}</a></td>"
        )
    }

    /// What tells a column that is the same in all rows, so that narrow windows can do without.
    fn class_of_axis(&self, axis: usize) -> &'static str {
        let mut levels = self.report.rows.iter().map(|row| row.axes.get(axis));
        let first = levels.next().flatten();
        if first.is_some() && levels.all(|level| level == first) { " class=\"same\"" } else { "" }
    }

    /// A number with its interval, which leads to its runs; the cell is sorted by the number as it is.
    fn cell(&self, row: usize, metric: Metric) -> String {
        let numbers = &self.report.rows[row];
        let estimate = numbers.estimate(metric);
        let text = |value| number(value, metric.quantity());
        let Some(mean) = estimate.mean else { return format!("<td class=\"n\" data-value=\"\">{UNDEFINED}</td>") };
        let few = if estimate.n < numbers.n_seeds { format!("<sup>{}</sup>", estimate.n) } else { String::new() };
        let interval = numbers.interval(metric);
        let interval = interval
            .map_or_else(String::new, |(low, high)| format!("<small>{}\u{2013}{}</small>", text(low), text(high)));
        let (name, shown) = (metric.name(), text(mean));
        format!(
            "<td class=\"n\" data-value=\"{mean}\"><a href=\"#runs-{row}\" data-metric=\"{name}\">{shown}{few}{interval}</a></td>"
        )
    }
}

/// The head of a metric's column, with its unit.
pub(super) fn column_head(metric: Metric) -> String {
    let (name, unit) = header_words(metric);
    let unit = if unit.is_empty() { String::new() } else { format!("<small>{unit}</small>") };
    format!("<th scope=\"col\" class=\"n\" data-metric=\"{}\">{name}{unit}</th>", metric.name())
}
