//! Which cell is likely to beat which.

use headway_stats::Interval;

use super::text::escaped;
use crate::report::study::{Comparison, Study};
use crate::report::table::header_words;

impl Study {
    /// The probabilities of improvement, a table per metric; nothing where no two cells can be compared.
    pub(super) fn improvement(&self) -> String {
        let known = |comparison: &&Comparison| comparison.improvement.iter().flatten().any(Option::is_some);
        self.comparisons.iter().filter(known).map(|comparison| self.matrix(comparison)).collect()
    }

    fn matrix(&self, comparison: &Comparison) -> String {
        let labels: Vec<String> = (0..self.cells.len()).map(|cell| escaped(&self.label(cell))).collect();
        let head: String = labels.iter().map(|label| format!("<th scope=\"col\"><span>{label}</span></th>")).collect();
        let row = |(x, over): (usize, &Vec<Option<Interval>>)| {
            let cells: String = over.iter().enumerate().map(|(y, over)| cell(x == y, over.as_ref())).collect();
            format!("<tr><th scope=\"row\">{}</th>{cells}</tr>\n", labels[x])
        };
        let rows: String = comparison.improvement.iter().enumerate().map(row).collect();
        format!(
            "<h3>Probability of improvement: {}</h3><p>How likely a run of the row's cell is to score more than a run of the \
             column's, averaged over the worlds; ties count by half. Bold where the 95 % bootstrap interval over the seeds \
             leaves out 50 %.</p><div class=\"scroll\" tabindex=\"0\"><table class=\"matrix\"><thead><tr><td></td>{head}</tr>\
             </thead><tbody>{rows}</tbody></table></div>\n",
            header_words(comparison.metric).0
        )
    }
}

fn cell(is_same: bool, over: Option<&Interval>) -> String {
    let Some(Interval { point, low, high }) = over else {
        return format!("<td class=\"n\">{}</td>", if is_same { "" } else { "\u{2013}" });
    };
    let colour = if *point >= 0.5 { "0 114 178" } else { "213 94 0" };
    let ground = format!("rgb({colour} / {:.2})", 0.9 * (point - 0.5).abs());
    let text = format!("{:.0}", 100.0 * point);
    let text = if *low > 0.5 || *high < 0.5 { format!("<b>{text}</b>") } else { text };
    format!(
        "<td class=\"n\" style=\"background:{ground}\">{text}<small>{:.0}\u{2013}{:.0}</small></td>",
        100.0 * low,
        100.0 * high
    )
}
