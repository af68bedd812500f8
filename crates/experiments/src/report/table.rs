//! The report for the terminal.

use headway_stats::{Estimate, MIN_UNITS};

use super::layout::{Align, Column, lines, width};
use super::{Interval, Report, Row, TABLE_WIDTH};
use crate::episode::{Metric, Quantity};

/// Number of header lines.
const N_HEADER: usize = 3;

/// The metrics that leave the table if it is too wide, first to last.
const DISPENSABLE: [Metric; 5] = [
    Metric::MeanJerk,
    Metric::DecelerationsPerM,
    Metric::Spl,
    Metric::NeedlessDecelerationsPerM,
    Metric::SpeedNearObstacles,
];

/// What stands where there is no number.
pub(super) const UNDEFINED: &str = "\u{2013}";

pub(super) const DEFINITIONS: &str = "mean speed: all distance / all time, failures included; near obstacles: clearance < 1 m; \
                           needless: the way was clear";

/// What stands below intervals over [few](are_few) seeds. The range of three independent draws misses their distribution's median in
/// 2 of 2^3 cases.
pub(super) const CAUTION: &str = "Intervals over 3 to 5 seeds are too narrow: over 3 each is the range of the seeds, which misses the mean 1 time in 4.";

/// Whether so many seeds have intervals by the bootstrap that hold the mean markedly less often than they should: over 3, 4, 5 draws
/// from a normal distribution in 75, 80 and 83 %, not 95 %.
pub(super) fn are_few(n_seeds: usize) -> bool {
    (MIN_UNITS..=5).contains(&n_seeds)
}

impl Report {
    /// The rows as a text table at most [`TABLE_WIDTH`] characters wide (long level names aside), with a line below that
    /// says what its numbers are, and then the [`notes`](Self::notes).
    ///
    /// Each row has its means on one line and their intervals, if it has any, on the next. Metrics for which there is no room are left
    /// out, and the lines below say so.
    pub fn table(&self) -> String {
        let labels = self.labels();
        let mut metrics = self.metrics();
        let mut columns = self.columns(&labels, &metrics);
        for metric in DISPENSABLE {
            if width(&columns.iter().collect::<Vec<_>>()) <= TABLE_WIDTH {
                break;
            }
            metrics.retain(|m| *m != metric);
            columns = self.columns(&labels, &metrics);
        }
        let mut text = lines(&columns.iter().collect::<Vec<_>>(), N_HEADER);
        text.extend(self.legend(&metrics));
        text.extend(self.collapsed());
        text.extend(self.notes());
        text.join("\n") + "\n"
    }

    /// The metrics that the rows have: those of a shield only if one of them has it.
    pub(super) fn metrics(&self) -> Vec<Metric> {
        let is_there =
            |metric: &Metric| !metric.is_of_shield() || self.rows.iter().any(|row| row.estimate(*metric).n > 0);
        Metric::ALL.into_iter().filter(is_there).collect()
    }

    fn labels(&self) -> Vec<Column> {
        let mut labels: Vec<Column> = self.axes.iter().enumerate().map(|(k, axis)| self.axis(k, axis)).collect();
        labels.push(self.label(Align::Left, "world", |row| row.world.clone()));
        if self.common(|row| row.n_seeds).is_none() {
            labels.push(self.label(Align::Right, "seeds", |row| row.n_seeds.to_string()));
        }
        labels
    }

    fn axis(&self, k: usize, axis: &str) -> Column {
        self.label(Align::Left, axis, |row| row.axes[k].level.clone())
    }

    fn label(&self, align: Align, name: &str, cell: impl Fn(&Row) -> String) -> Column {
        let header = ["", name, ""].map(str::to_owned).into_iter();
        Column {
            align,
            cells: header.chain(self.rows.iter().flat_map(|row| row.lines(cell(row), String::new()))).collect(),
        }
    }

    fn columns(&self, labels: &[Column], metrics: &[Metric]) -> Vec<Column> {
        let metrics = metrics.iter().map(|metric| self.metric(*metric));
        labels.iter().cloned().chain(metrics).collect()
    }

    fn metric(&self, metric: Metric) -> Column {
        let cells = self.rows.iter().flat_map(|row| row.lines(mean_cell(row, metric), interval_cell(row, metric)));
        Column { align: Align::Right, cells: header(metric).map(str::to_owned).into_iter().chain(cells).collect() }
    }

    fn has_intervals(&self) -> bool {
        self.rows.iter().any(Row::has_intervals)
    }

    fn legend(&self, metrics: &[Metric]) -> Vec<String> {
        let mut legend = vec![self.meaning()];
        legend.extend(self.caution(metrics).map(str::to_owned));
        legend.push(DEFINITIONS.to_owned());
        let partly = |estimate: Estimate, row: &Row| 0 < estimate.n && estimate.n < row.n_seeds;
        if self.rows.iter().any(|row| metrics.iter().any(|metric| partly(row.estimate(*metric), row))) {
            legend.push("*n: defined in n of the seeds only; the mean is over those".to_owned());
        }
        let left_out: Vec<_> = self.metrics().iter().filter(|m| !metrics.contains(m)).map(|m| m.name()).collect();
        if !left_out.is_empty() {
            legend.push(format!("left out for want of room (see --format json or csv): {}", left_out.join(", ")));
        }
        legend
    }

    /// What the numbers of a row are.
    pub(super) fn meaning(&self) -> String {
        let of_a_seed = |row: &Row| row.n_episodes.checked_div(row.n_seeds);
        let mut episodes = self.rows.iter().filter_map(of_a_seed);
        let first = episodes.next().filter(|n| episodes.all(|other| other == *n));
        let part = |per: &str| first.map_or_else(String::new, |n| format!(", {} {per}", count(n, "episode")));
        match (self.interval, self.common(|row| row.n_seeds)) {
            (Interval::Episodes, _) => {
                format!("One policy{}; below the rates: 95 % Wilson intervals over the episodes.", part("a world"))
            }
            (Interval::Seeds, n) => {
                let seeds = n.map_or_else(|| "the training seeds".to_owned(), |n| count(n, "training seed"));
                let are_some_too_few = self.rows.iter().any(|row| (1..MIN_UNITS).contains(&row.n_seeds));
                let intervals = match (self.has_intervals(), are_some_too_few) {
                    (false, _) => "no intervals below 3 seeds",
                    (true, false) => "below it: 95 % percentile bootstrap over the seeds",
                    (true, true) => "below it, from 3 seeds on: 95 % percentile bootstrap over the seeds",
                };
                format!("Mean over {seeds}{}; {intervals}.", part("each"))
            }
        }
    }

    /// What to think of intervals over few seeds; nothing where these metrics have none.
    pub(super) fn caution(&self, metrics: &[Metric]) -> Option<&'static str> {
        let few = |row: &Row| metrics.iter().any(|metric| are_few(row.estimate(*metric).n));
        self.rows.iter().any(few).then_some(CAUTION)
    }

    /// The value that all the rows share.
    pub(super) fn common(&self, value: impl Fn(&Row) -> usize) -> Option<usize> {
        let first = value(self.rows.first()?);
        self.rows.iter().all(|row| value(row) == first).then_some(first)
    }
}

impl Row {
    fn has_intervals(&self) -> bool {
        Metric::ALL.iter().any(|metric| self.interval(*metric).is_some())
    }

    /// The line of means and, if the row has any interval, the line of intervals.
    fn lines(&self, mean: String, interval: String) -> Vec<String> {
        if self.has_intervals() { vec![mean, interval] } else { vec![mean] }
    }
}

fn header(metric: Metric) -> [&'static str; N_HEADER] {
    match metric {
        Metric::Success => ["", "success", "%"],
        Metric::Collision => ["", "collision", "%"],
        Metric::Timeout => ["", "timeout", "%"],
        Metric::MeanSpeed => ["mean", "speed", "m/s"],
        Metric::SpeedInSuccesses => ["speed in", "successes", "m/s"],
        Metric::SpeedNearObstacles => ["speed near", "obstacles", "m/s"],
        Metric::DecelerationsPerM => ["decele-", "rations", "1/m"],
        Metric::NeedlessDecelerationsPerM => ["needless", "decel.", "1/m"],
        Metric::Spl => ["", "SPL", ""],
        Metric::MeanJerk => ["mean", "jerk", "m/s\u{b3}"],
        Metric::Vetoes => ["shield's", "vetoes", "%"],
        Metric::Stops => ["shield's", "stops", "%"],
    }
}

/// The name of a metric, and its unit, in a line.
pub(super) fn header_words(metric: Metric) -> (String, String) {
    let [above, below, unit] = header(metric);
    (format!("{above} {below}").replace("- ", "").trim().to_owned(), unit.to_owned())
}

fn mean_cell(row: &Row, metric: Metric) -> String {
    let Estimate { mean, n, .. } = row.estimate(metric);
    let mark = if n > 0 && n < row.n_seeds { format!(" *{n}") } else { String::new() };
    mean.map_or_else(|| UNDEFINED.to_owned(), |mean| number(mean, metric.quantity()) + &mark)
}

fn interval_cell(row: &Row, metric: Metric) -> String {
    let number = |value| number(value, metric.quantity());
    row.interval(metric).map_or_else(String::new, |(low, high)| format!("{}\u{2013}{}", number(low), number(high)))
}

/// A number of a kind, with as many decimals as all of its kind have.
pub(super) fn number(value: f64, quantity: Quantity) -> String {
    match quantity {
        Quantity::Rate => format!("{:.1}", 100.0 * value),
        Quantity::Speed | Quantity::PerMetre | Quantity::Jerk | Quantity::Score => format!("{value:.2}"),
    }
}

pub(super) fn count(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}
