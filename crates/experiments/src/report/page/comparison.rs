//! What a change of one axis is worth, and which cell is likely to have more than which.

use headway_stats::Interval;

use super::text::escaped;
use crate::episode::Metric;
use crate::report::contrast::{Contrast, Contrasts, Difference, difference_text, probability_text, seeds_text};
use crate::report::study::{MIN_SEEDS_TOLD, Ranking, Study};
use crate::report::table::header_words;

/// The metrics of contrasts.
const SHOWN: [Metric; 4] = [Metric::Success, Metric::MeanSpeed, Metric::NeedlessDecelerationsPerM, Metric::MeanJerk];

/// Most cells in one matrix, which would be too wide with more.
const MAX_CELLS: usize = 12;

impl Study {
    /// One axis at a time: a table for each, all closed but the first.
    pub(super) fn contrast_tables(&self) -> String {
        if self.contrasts.is_empty() {
            return String::new();
        }
        let tables: String =
            self.contrasts.iter().enumerate().map(|(k, contrasts)| contrast_table(contrasts, k == 0)).collect();
        format!(
            "<p>Each level less the first of its axis, the other axes alike: the mean difference over the \
             training seeds that both have, paired seed by seed, its 95 % bootstrap interval, and p of the sign-flip test; bold where \
             p is at most 0.05: of differences that are all luck, one in twenty at most. What else than the axis differs stands under Cells. \
             <i>P(more)</i>: how likely a run is to have more than one of the other\u{2019}s, with its interval, and in how many of \
             the pairs of seeds it has more.</p>{tables}"
        )
    }

    /// How likely a cell is to have more than another, a table per metric; nothing where no two cells can be compared.
    pub(super) fn ranking_tables(&self) -> String {
        self.rankings.iter().map(|ranking| self.matrix(ranking)).collect()
    }

    /// The matrix of a metric; of many cells, one for each level of the first axis.
    fn matrix(&self, ranking: &Ranking) -> String {
        let matrix = |(title, cells): (String, Vec<(usize, String)>)| {
            let title = if title.is_empty() { title } else { format!("<h4>{}</h4>", escaped(&title)) };
            format!("<div>{title}{}</div>", table_of(ranking, &cells))
        };
        let matrices: String = self.frames(MAX_CELLS).into_iter().map(matrix).collect();
        format!(
            "<h3>Probability of more: {}</h3><p>How likely a run of the row's cell is to have more than a run of the \
             column's, in %, averaged over the worlds; ties count by half. {}</p><div class=\"matrices\">{matrices}</div>\n",
            header_words(ranking.metric).0,
            rule_of_bold(ranking),
        )
    }
}

/// What is bold in a matrix, or why nothing is.
fn rule_of_bold(ranking: &Ranking) -> String {
    let n_cells = ranking.more.len();
    let mut compared =
        (0..n_cells).flat_map(|x| (0..x).map(move |y| (x, y))).filter(|(x, y)| ranking.more[*x][*y].is_some());
    match compared.any(|(x, y)| ranking.has_enough(x, y)) {
        true => format!(
            "Bold where the 95 % bootstrap interval over the seeds leaves out 50 % and both cells have {MIN_SEEDS_TOLD} training \
             seeds or more, as many as a sign-flip test of pairs takes to reach p = 0.05."
        ),
        false => format!(
            "None is bold: that takes {MIN_SEEDS_TOLD} training seeds of both cells, as many as a sign-flip test of pairs takes to \
             reach p = 0.05."
        ),
    }
}

/// Pairs of the cells, which are given with what they are called.
fn table_of(ranking: &Ranking, cells: &[(usize, String)]) -> String {
    let head: String =
        cells.iter().map(|(_, label)| format!("<th scope=\"col\"><span>{}</span></th>", escaped(label))).collect();
    let row = |(x, label): &(usize, String)| {
        let pairs: String = cells.iter().map(|(y, _)| cell(ranking, *x, *y)).collect();
        format!("<tr><th scope=\"row\">{}</th>{pairs}</tr>\n", escaped(label))
    };
    let rows: String = cells.iter().map(row).collect();
    format!(
        "<div class=\"scroll\" tabindex=\"0\"><table class=\"matrix\"><thead><tr><td></td>{head}</tr>\
         </thead><tbody>{rows}</tbody></table></div>"
    )
}

fn contrast_table(contrasts: &Contrasts, is_open: bool) -> String {
    let Contrasts { over, base, contrasts, .. } = contrasts;
    let open = if is_open { " open" } else { "" };
    let metric = |metric: Metric| {
        let (name, unit) = header_words(metric);
        let unit = if unit == "%" { "points" } else { &unit };
        format!(
            "<th scope=\"col\" class=\"n\">{name}<small>{unit}</small></th>\
             <th scope=\"col\" class=\"n\">P(more)<small>seeds</small></th>"
        )
    };
    let first = contrasts.first();
    let others = first.iter().flat_map(|c| {
        c.axes.iter().map(|level| level.axis.as_str()).chain(c.world.is_some().then_some(crate::report::WORLD))
    });
    let head: String =
        others.chain([&**over]).map(|name| format!("<th scope=\"col\">{}</th>", escaped(name))).collect();
    let metrics: String = SHOWN.map(metric).concat();
    let rows: String = contrasts.iter().map(contrast_row).collect();
    let (over, base) = (escaped(over), escaped(base));
    format!(
        "<details{open}><summary>{over}: each level less {base}</summary><div class=\"scroll\" tabindex=\"0\"><table class=\"contrast\">\
         <thead><tr>{head}{metrics}</tr></thead><tbody>{rows}</tbody></table></div></details>\n"
    )
}

fn contrast_row(contrast: &Contrast) -> String {
    let names = contrast.axes.iter().map(|level| &level.level).chain(&contrast.world).chain([&contrast.level]);
    let names: String = names.map(|name| format!("<th scope=\"row\">{}</th>", escaped(name))).collect();
    let cells: String = SHOWN.map(|metric| contrast_cells(contrast.difference(metric), metric)).concat();
    format!("<tr>{names}{cells}</tr>\n")
}

fn contrast_cells(difference: &Difference, metric: Metric) -> String {
    let [mean, ends] = difference_text(difference, metric.quantity());
    let [more, range] = probability_text(difference);
    let mean = if difference.is_told_from_luck() { format!("<b>{mean}</b>") } else { mean };
    let [seeds, p] = seeds_text(difference).map(|text| escaped(&text));
    let below = if range.is_empty() { seeds } else { format!("{range}, {seeds}") };
    let ends = if ends.is_empty() { p } else { format!("{ends}, {p}") };
    format!("<td class=\"n\">{mean}<small>{ends}</small></td><td class=\"n\">{more}<small>{below}</small></td>")
}

fn cell(ranking: &Ranking, x: usize, y: usize) -> String {
    let Some(Interval { point, low, high }) = ranking.more[x][y] else {
        return format!("<td class=\"n\">{}</td>", if x == y { "" } else { "\u{2013}" });
    };
    let colour = if point >= 0.5 { "0 114 178" } else { "213 94 0" };
    let ground = format!("rgb({colour} / {:.2})", 0.9 * (point - 0.5).abs());
    let text = format!("{:.0}", 100.0 * point);
    let text = if ranking.is_told(x, y) { format!("<b>{text}</b>") } else { text };
    format!(
        "<td class=\"n\" style=\"background:{ground}\">{text}<small>{:.0}\u{2013}{:.0}</small></td>",
        100.0 * low,
        100.0 * high
    )
}
