//! Contrasts for the terminal.

use headway_stats::MIN_UNITS;

use super::{Contrast, Contrasts, Difference};
use crate::episode::{Metric, Quantity};
use crate::report::TABLE_WIDTH;
use crate::report::layout::{Align, Column, lines, width, wrapped};
use crate::report::table::{CAUTION, UNDEFINED, are_few, count, header_words};

/// Number of header lines.
const N_HEADER: usize = 3;

impl Contrasts {
    /// The contrasts in some metrics as a text table at most [`TABLE_WIDTH`] characters wide (long level names aside), with lines
    /// below that say what its numbers are, which levels collapsed, and what else differs in the training of levels. The last metrics are
    /// left out if there is no room, and a line says so.
    pub fn table(&self, metrics: &[Metric]) -> String {
        let labels = self.labels();
        let wide = |shown: &[Metric]| width(&self.columns(&labels, shown).iter().collect::<Vec<_>>());
        let n_shown = (1..=metrics.len()).rev().find(|n| wide(&metrics[..*n]) <= TABLE_WIDTH).unwrap_or(1);
        let (shown, left_out) = metrics.split_at(n_shown.min(metrics.len()));
        let mut text = lines(&self.columns(&labels, shown).iter().collect::<Vec<_>>(), N_HEADER);
        text.extend(self.legend(shown, left_out));
        text.extend(self.collapsed());
        text.extend(self.settings_in_words());
        text.join("\n") + "\n"
    }

    fn labels(&self) -> Vec<Column> {
        let first = self.contrasts.first();
        let names: Vec<&str> = first.iter().flat_map(|c| c.axes.iter().map(|level| level.axis.as_str())).collect();
        let axis = |(k, name): (usize, &&str)| self.label(["", name, ""], |c| c.axes[k].level.clone());
        let mut labels: Vec<Column> = names.iter().enumerate().map(axis).collect();
        if first.is_some_and(|contrast| contrast.world.is_some()) {
            labels.push(self.label(["", super::WORLD, ""], |c| c.world.clone().unwrap_or_default()));
        }
        labels.push(self.label(["", &self.over, &format!("less {}", self.base)], |c| c.level.clone()));
        labels
    }

    fn label(&self, header: [&str; N_HEADER], cell: impl Fn(&Contrast) -> String) -> Column {
        self.column(Align::Left, header, |contrast| [cell(contrast), String::new()])
    }

    /// Two lines for each contrast, of which the second has the intervals; one where there is none.
    fn column(&self, align: Align, header: [&str; N_HEADER], cells: impl Fn(&Contrast) -> [String; 2]) -> Column {
        let n_lines = if self.has_intervals() { 2 } else { 1 };
        let cells = self.contrasts.iter().flat_map(|contrast| cells(contrast).into_iter().take(n_lines));
        Column { align, cells: header.map(str::to_owned).into_iter().chain(cells).collect() }
    }

    fn has_intervals(&self) -> bool {
        self.contrasts.iter().flat_map(|contrast| &contrast.differences).any(|of| of.paired.low.is_some())
    }

    fn columns(&self, labels: &[Column], metrics: &[Metric]) -> Vec<Column> {
        labels.iter().cloned().chain(metrics.iter().flat_map(|metric| self.of_metric(*metric))).collect()
    }

    /// The difference, the probability of more, and the count of seeds with more.
    fn of_metric(&self, metric: Metric) -> [Column; 3] {
        let (name, unit) = header_words(metric);
        let quantity = metric.quantity();
        let unit = if quantity == Quantity::Rate { "points".to_owned() } else { unit };
        let column = |header, cells: &dyn Fn(&Difference) -> [String; 2]| {
            self.column(Align::Right, header, |contrast| cells(contrast.difference(metric)))
        };
        [
            column([&name, "difference", &unit], &|of| difference_text(of, quantity)),
            column(["", "P(more)", ""], &probability_text),
            column(["", "seeds", "more"], &seeds_text),
        ]
    }

    fn legend(&self, shown: &[Metric], left_out: &[Metric]) -> Vec<String> {
        let Self { over, base, contrasts, .. } = self;
        let seeds = || contrasts.iter().map(|contrast| contrast.n_seeds);
        let (least, most) = (seeds().min().unwrap_or(0), seeds().max().unwrap_or(0));
        let seeds = if least == most { count(most, "seed") } else { format!("{least} to {most} seeds") };
        let interval = match (self.has_intervals(), least < MIN_UNITS) {
            (false, _) => "no intervals below 3",
            (true, false) => "below it its 95 % bootstrap interval over them",
            (true, true) => "below it, from 3 on, its 95 % bootstrap interval over them",
        };
        let mut legend = vec![
            wrapped(
                &format!("Each `{over}` less `{base}`, the other axes alike, paired over {seeds}; {interval}."),
                TABLE_WIDTH,
            ),
            "P(more): how likely a run is to have more than one of the other's, ties by half; seeds more: in how many of the pairs."
                .to_owned(),
        ];
        let few = |contrast: &Contrast| shown.iter().any(|metric| are_few(contrast.difference(*metric).paired.n));
        if contrasts.iter().any(few) {
            legend.insert(1, CAUTION.to_owned());
        }
        if self.has_intervals() {
            legend.extend(self.legend_of_p(shown));
        }
        if self.n_alone > 0 {
            let n = count(self.n_alone, "row");
            legend.push(format!("left out: {n} with no `{base}` that has the same world and the same other axes"));
        }
        if let [first, rest @ ..] = left_out {
            let rest = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
            let first = first.name();
            legend.push(format!("left out for want of room: {first}{rest} (see --metric, or --format json or csv)"));
        }
        legend
    }
}

impl Contrasts {
    fn legend_of_p(&self, shown: &[Metric]) -> Vec<String> {
        let p = "p: how likely differences as large as these are if the two are drawn alike (sign-flip test; 0.05 takes 6 seeds).";
        let differences = self.contrasts.iter().flat_map(|c| shown.iter().map(|metric| c.difference(*metric)));
        let n_tested = differences.filter(|of| !of.is_none_at_all()).count();
        let by_chance = n_tested as f64 / 20.0;
        let all = format!(
            "Of {n_tested} differences that are all luck, {by_chance:.1} at most have p of 0.05 or less, on average."
        );
        if n_tested > 1 { vec![p.to_owned(), all] } else { vec![p.to_owned()] }
    }
}

/// A difference, and its interval.
pub(in crate::report) fn difference_text(of: &Difference, quantity: Quantity) -> [String; 2] {
    let mean = of.paired.mean.map_or_else(|| UNDEFINED.to_owned(), |mean| signed(mean, quantity));
    let ends = of.paired.low.zip(of.paired.high);
    let ends = ends.map(|(low, high)| format!("{} to {}", signed(low, quantity), signed(high, quantity)));
    [mean, ends.unwrap_or_default()]
}

/// A probability of more, and its interval.
pub(in crate::report) fn probability_text(of: &Difference) -> [String; 2] {
    let Some(more) = of.more else { return [UNDEFINED.to_owned(), String::new()] };
    [format!("{:.2}", more.point), format!("{:.2}\u{2013}{:.2}", more.low, more.high)]
}

/// In how many seeds there is more, and the p of that.
pub(in crate::report) fn seeds_text(of: &Difference) -> [String; 2] {
    let p = of.p.map_or_else(String::new, |p| if p < 0.001 { "p <0.001".to_owned() } else { format!("p {p:.3}") });
    [format!("{}/{}", of.n_more, of.paired.n), p]
}

/// A difference of a kind with its sign; none where all of its decimals are 0. It has a decimal more than what it is the
/// difference of.
fn signed(value: f64, quantity: Quantity) -> String {
    let size = match quantity {
        Quantity::Rate => format!("{:.2}", 100.0 * value.abs()),
        Quantity::Speed | Quantity::PerMetre | Quantity::Jerk | Quantity::Score => format!("{:.3}", value.abs()),
    };
    let is_zero = size.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    let sign = if is_zero {
        ""
    } else if value < 0.0 {
        "-"
    } else {
        "+"
    };
    format!("{sign}{size}")
}
