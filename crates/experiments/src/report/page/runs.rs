//! The runs behind each row: every seed with its values, its folder, and what of it is shown.

use super::budget::Shown;
use super::results::column_head;
use super::text::escaped;
use crate::episode::Metric;
use crate::report::study::{Drive, Study};
use crate::report::table::{UNDEFINED, number};
use crate::report::{Policy, RunRow};

/// The head of the column that says how seeds collapsed.
const COLLAPSED: &str = "<th scope=\"col\" data-metric=\"collapsed\">collapsed</th>";

impl Study {
    /// A table per row of the report; `root` is the link to the results folder.
    pub(super) fn run_tables(&self, root: &str, shown: &Shown<'_>) -> String {
        let metrics = self.report.metrics();
        (0..self.report.rows.len()).map(|row| self.runs_of(row, root, shown, &metrics)).collect()
    }

    fn runs_of(&self, row: usize, root: &str, shown: &Shown<'_>, metrics: &[Metric]) -> String {
        let cell = &self.cells[self.places[row].cell];
        let head: String = metrics.iter().map(|metric| column_head(*metric)).collect();
        let runs = self.report.runs[cell.runs.clone()].iter();
        let is_trained = self.report.rows[row].collapsed.n_trained > 0;
        let line = |run| {
            let verdict = if is_trained { verdict(run, &self.report.rows[row].world) } else { String::new() };
            format!("<tr>{}{verdict}</tr>\n", self.run(row, run, root, shown, metrics))
        };
        let rows: String = runs.map(line).collect();
        format!(
            "<details id=\"runs-{row}\"><summary>{}</summary><div class=\"scroll\" tabindex=\"0\"><table class=\"sortable\"><thead><tr>\
             <th scope=\"col\" class=\"n\">seed</th><th scope=\"col\">run</th>{head}<th scope=\"col\">drives</th>{collapsed}</tr></thead>\
             <tbody>{rows}</tbody></table></div></details>\n",
            escaped(&self.row_label(row)),
            collapsed = if is_trained { COLLAPSED } else { "" },
        )
    }

    fn run(&self, row: usize, run: &RunRow, root: &str, shown: &Shown<'_>, metrics: &[Metric]) -> String {
        let place = &self.places[row];
        let summary = run.summaries[place.world].1;
        let value = |metric: &Metric| {
            let value = summary.as_ref().and_then(|summary| metric.of(summary));
            let text = value.map_or_else(|| UNDEFINED.to_owned(), |value| number(value, metric.quantity()));
            let key = value.map_or_else(String::new, |value| value.to_string());
            format!("<td class=\"n\" data-metric=\"{}\" data-value=\"{key}\">{text}</td>", metric.name())
        };
        let values: String = metrics.iter().map(value).collect();
        let folder = format!("{root}runs/{}/", run.train_id);
        let state = match &run.policy {
            Policy::At(_) | Policy::NotTrained if summary.is_some() => {
                let episodes = format!("{folder}evaluations/{}/episodes.csv", place.eval_id);
                format!(" <a href=\"{episodes}\">episodes</a>")
            }
            Policy::At(_) | Policy::NotTrained => " not evaluated".to_owned(),
            Policy::Damaged => " damaged".to_owned(),
            Policy::Unfinished => " unfinished".to_owned(),
        };
        let link = |(number, drive): (usize, &Drive)| {
            format!("<a href=\"#drive-{number}\">{}, scenario {}</a>", drive.why, drive.scenario)
        };
        let drives: Vec<String> = shown.of_run(row, run.seed).map(link).collect();
        format!(
            "<td class=\"n\">{}</td><td><a href=\"{folder}\"><code>{}</code></a>{state}</td>{values}<td class=\"links\">{}</td>",
            run.seed,
            run.train_id,
            drives.join("<br>")
        )
    }
}

/// How a run collapsed, by its training or in this world, if it did.
fn verdict(run: &RunRow, world: &str) -> String {
    let how: Vec<String> = run.collapse_in(world).map(|how| escaped(&how.describe())).collect();
    let how = if how.is_empty() { "no".to_owned() } else { how.join("<br>") };
    format!("<td class=\"verdict\" data-metric=\"collapsed\">{how}</td>")
}
