//! The table that is shown.

use super::{RunProgress, Stage, sparkline};
use crate::collapse;
use crate::report::layout::{Align, Column, lines, width, wrapped};
use crate::store::{Cell, Index};
use crate::train::MetricsRow;

/// Columns that the bar of a training and the curve of its return take.
const BAR: usize = 10;
const CURVE: usize = 16;
/// Columns that are kept for the last one, and lines for what is no run: title, header, foot, and where the cursor stands.
const LAST: usize = 18;
const N_OTHER_LINES: usize = 7;
/// What is damaged that a terminal names at most.
const N_DAMAGES: usize = 3;
/// What stands where there is no number.
const UNDEFINED: &str = "–";

/// The look of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// As text is.
    Plain,
    /// What is going on.
    Active,
    /// What needs no attention.
    Faint,
    /// What has gone wrong.
    Alarm,
}

/// A grid as a table, a line for each run.
#[derive(Debug)]
pub struct View {
    /// Which grid, and how far it is.
    pub title: String,
    /// The table's lines, header and rule first, each with its look.
    pub lines: Vec<(String, Tone)>,
}

impl View {
    /// The view of a grid's runs, in a terminal of so many columns and lines. Where there is no room for all columns, the least
    /// important ones leave; where there is none for all runs, those that are done or waiting do, and a line says how many. What is
    /// damaged is told below.
    pub fn new(index: &Index, runs: &[RunProgress], n_columns: usize, n_lines: usize) -> Self {
        let damages = damages(runs, if n_lines == usize::MAX { n_lines } else { N_DAMAGES });
        let wrap = |line: &String| wrapped(line, n_columns).lines().map(str::to_owned).collect::<Vec<_>>();
        let damages: Vec<String> = damages.iter().flat_map(wrap).collect();
        let shown = shown(runs, n_lines.saturating_sub(N_OTHER_LINES + damages.len()).max(1));
        let mut columns = columns(index, &shown);
        while fixed_width(&columns) + LAST > n_columns {
            let Some(least) = columns.iter().map(|(rank, _)| *rank).max().filter(|rank| *rank > 0) else { break };
            columns.retain(|(rank, _)| *rank != least);
        }
        let table = lines(&columns.iter().map(|(_, column)| column).collect::<Vec<_>>(), 1);
        let tones = [Tone::Plain, Tone::Faint].into_iter().chain(shown.iter().map(|run| tone(run)));
        let mut lines: Vec<_> = table.into_iter().zip(tones).collect();
        if shown.len() < runs.len() {
            lines.push((format!("and {} more runs, done or waiting", runs.len() - shown.len()), Tone::Faint));
        }
        lines.extend(worlds(index).map(|worlds| (worlds, Tone::Faint)));
        lines.extend(damages.into_iter().map(|damage| (damage, Tone::Alarm)));
        Self { title: title(index, runs), lines }
    }
}

/// The width of all columns but the last, whose text may be cut off at the right.
fn fixed_width(columns: &[(u8, Column)]) -> usize {
    let but_last = &columns[..columns.len() - 1];
    width(&but_last.iter().map(|(_, column)| column).collect::<Vec<_>>())
}

/// Which numbers of success stand beside each other, if they are of the same worlds in every line.
fn worlds(index: &Index) -> Option<String> {
    let of_cell = |cell: &Cell| cell.evaluations.iter().map(|e| e.world.clone()).collect::<Vec<_>>();
    let first = index.cells.first().map(of_cell).filter(|worlds| !worlds.is_empty())?;
    let is_common = index.cells.iter().all(|cell| of_cell(cell) == first);
    is_common.then(|| format!("success in {}", first.join(" / ")))
}

/// What is damaged, each once; of more than `n_most` the first, and how many more.
fn damages(runs: &[RunProgress], n_most: usize) -> Vec<String> {
    let mut damages: Vec<String> = Vec::new();
    for damage in runs.iter().filter_map(|run| run.damage.as_ref()) {
        let line = format!("warning: {damage}");
        if !damages.contains(&line) {
            damages.push(line); // cells may share a run
        }
    }
    if damages.len() > n_most {
        let n_more = damages.len() - (n_most - 1);
        damages.truncate(n_most - 1);
        damages.push(format!("and {n_more} more are damaged"));
    }
    damages
}

/// How far the grid is: `table1: 3 of 40 runs done, 2 training, 35 waiting; 1 of 4 collapsed`.
fn title(index: &Index, runs: &[RunProgress]) -> String {
    let count = |stage| runs.iter().filter(|run| run.stage == stage).count();
    let mut title = format!("{}: {} of {} runs done", index.name, count(Stage::Done), runs.len());
    for (stage, name) in [
        (Stage::Training, "training"),
        (Stage::Evaluating, "evaluating"),
        (Stage::Stalled, "stalled"),
        (Stage::Damaged, "damaged"),
        (Stage::Waiting, "waiting"),
    ] {
        if count(stage) > 0 {
            title += &format!(", {} {name}", count(stage));
        }
    }
    let n_collapsed = runs.iter().filter(|run| !run.collapse.is_empty()).count();
    if n_collapsed > 0 {
        let n_begun = runs.iter().filter(|run| run.stage != Stage::Waiting).count();
        title += &format!("; {n_collapsed} of {n_begun} collapsed");
    }
    title
}

/// The runs for which there is room, in their order: those that need attention first, then those done, then those to come.
fn shown(runs: &[RunProgress], n_max: usize) -> Vec<&RunProgress> {
    let rank = |run: &RunProgress| match run.stage {
        Stage::Training | Stage::Evaluating | Stage::Stalled | Stage::Damaged => 0,
        Stage::Done => 1,
        Stage::Waiting => 2,
    };
    let mut numbered: Vec<(usize, &RunProgress)> = runs.iter().enumerate().collect();
    numbered.sort_by_key(|(number, run)| (rank(run), *number));
    numbered.truncate(n_max);
    numbered.sort_by_key(|(number, _)| *number);
    numbered.into_iter().map(|(_, run)| run).collect()
}

fn tone(run: &RunProgress) -> Tone {
    match run.stage {
        _ if !run.collapse.is_empty() => Tone::Alarm,
        Stage::Stalled | Stage::Damaged => Tone::Alarm,
        Stage::Training | Stage::Evaluating => Tone::Active,
        Stage::Waiting => Tone::Faint,
        Stage::Done => Tone::Plain,
    }
}

/// The columns with their ranks: those of rank 0 stay, of the others the highest leaves first.
fn columns(index: &Index, runs: &[&RunProgress]) -> Vec<(u8, Column)> {
    let column = |align, name: &str, cell: &dyn Fn(&RunProgress) -> String| {
        let cells = std::iter::once(name.to_owned()).chain(runs.iter().map(|run| cell(run)));
        Column { align, cells: cells.collect() }
    };
    let axes = index.axes.iter().enumerate();
    let axes = axes.map(|(k, axis)| (0, column(Align::Left, &axis.name, &|run| run.axes[k].level.clone())));
    let last = |figure: fn(&MetricsRow) -> Option<f64>| move |run: &RunProgress| figure(run.rows.last()?);
    let percent = |value: f64| format!("{:.1}", 100.0 * value);
    let others = [
        (0, column(Align::Right, "seed", &|run| run.seed.to_string())),
        (0, column(Align::Left, "", &|run| stage_name(run.stage).to_owned())),
        (1, column(Align::Left, "progress", &bar)),
        (4, column(Align::Right, "env steps", &|run| cell(run.rows.last(), |row| grouped(row.env_steps)))),
        (5, column(Align::Right, "steps/s", &|run| cell(run.steps_per_second, |rate| grouped(rate as u64)))),
        (6, column(Align::Right, "left", &|run| cell(run.seconds_left(), time))),
        (2, column(Align::Left, "return", &|run| sparkline(&returns(run), CURVE))),
        (3, column(Align::Right, "last", &|run| cell(returns(run).last(), |value| short(*value)))),
        (7, column(Align::Right, "arrived %", &|run| cell(last(|row| row.arrived)(run), percent))),
        (8, column(Align::Right, "loss", &|run| cell(last(|row| row.loss)(run), short))),
        (0, column(Align::Right, "success %", &success)),
        (0, column(Align::Left, "collapsed", &collapsed)),
    ];
    axes.chain(others).collect()
}

fn stage_name(stage: Stage) -> &'static str {
    match stage {
        Stage::Waiting => "waiting",
        Stage::Training => "training",
        Stage::Stalled => "stalled",
        Stage::Evaluating => "evaluating",
        Stage::Done => "done",
        Stage::Damaged => "damaged",
    }
}

fn cell<T>(value: Option<T>, text: impl Fn(T) -> String) -> String {
    value.map_or_else(|| UNDEFINED.to_owned(), text)
}

fn bar(run: &RunProgress) -> String {
    cell(run.share(), |share| {
        let full = (share * BAR as f64).round() as usize;
        format!("{}{} {:3.0} %", "█".repeat(full), "░".repeat(BAR - full), (100.0 * share).floor())
    })
}

/// The mean return of the episodes of each row that has one.
fn returns(run: &RunProgress) -> Vec<f64> {
    run.rows.iter().filter_map(|row| row.return_mean).collect()
}

fn success(run: &RunProgress) -> String {
    let worlds = run.success.iter().map(|success| cell(*success, |share| format!("{:.1}", 100.0 * share)));
    worlds.collect::<Vec<_>>().join(" / ")
}

fn collapsed(run: &RunProgress) -> String {
    collapse::kinds(&run.collapse).join(", ")
}

/// Digits in groups of three: `12 500`.
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// Three digits or so.
fn short(value: f64) -> String {
    match value.abs() {
        1000.0.. => format!("{value:.0}"),
        10.0.. => format!("{value:.1}"),
        0.1.. => format!("{value:.2}"),
        0.0 => "0".to_owned(),
        _ => format!("{value:.1e}"),
    }
}

/// Minutes and seconds, or hours and minutes: `2:05`, `3 h 20`.
fn time(seconds: f64) -> String {
    let seconds = seconds.round() as u64;
    match seconds {
        ..3600 => format!("{}:{:02}", seconds / 60, seconds % 60),
        _ => format!("{} h {:02}", seconds / 3600, seconds / 60 % 60),
    }
}
