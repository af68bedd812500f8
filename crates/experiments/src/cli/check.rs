//! `experiments check`: what a spec stands for, without running it.

use std::fmt::Write as _;
use std::io::Write;
use std::num::NonZeroUsize;
use std::thread::available_parallelism;

use super::args::CheckArgs;
use super::left_out;
use super::print;
use super::speed::{self, Cost};
use crate::Error;
use crate::spec::{Cell, Grid, RunSpec};

/// Validates a spec and prints its cells, its seeds, how much there is to run, and how long that may take.
///
/// # Errors
/// Whatever is wrong with the spec.
pub fn execute(args: &CheckArgs, out: &mut dyn Write) -> Result<(), Error> {
    let grid = Grid::load(&args.spec, &args.set)?;
    print(out, &describe(&grid))?;
    let left_out = left_out::in_words(&grid);
    if !left_out.is_empty() {
        print(out, &format!("\n{left_out}"))?;
    }
    let n_cores = available_parallelism().map_or(1, NonZeroUsize::get);
    print(out, &cost(&speed::cost(&grid)?, grid.n_runs(), n_cores))
}

/// The grid in words: name, cells, seeds, amounts.
fn describe(grid: &Grid) -> String {
    let mut text = format!("{}: valid\n\n", grid.name);
    text.push_str(&cells(grid));
    for note in twins(&grid.cells) {
        let _ = writeln!(text, "note: {note}");
    }
    let last = grid.seeds.first + (grid.seeds.count - 1);
    let _ = writeln!(text, "\nseeds        {} to {last}", grid.seeds.first);
    let (n_cells, n_seeds) = (counted(grid.cells.len() as u64, "cell"), counted(grid.seeds.count, "seed"));
    let _ = writeln!(text, "runs         {} = {n_cells} x {n_seeds}", grid.n_runs());
    let _ = writeln!(text, "training     {} env steps", grouped(n_env_steps(grid)));
    let _ = writeln!(text, "evaluation   {} episodes", grouped(n_episodes(grid)));
    text
}

/// One line a cell, its levels in columns.
fn cells(grid: &Grid) -> String {
    if grid.axes.is_empty() {
        return "one cell, no axes\n".into();
    }
    let mut rows = vec![grid.axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>()];
    rows.extend(grid.cells.iter().map(|cell| cell.axes.iter().map(|(_, level)| level.as_str()).collect()));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..grid.axes.len()).map(width).collect();
    let mut text = String::new();
    for (number, row) in rows.iter().enumerate() {
        let label = if number == 0 { "cell".into() } else { number.to_string() };
        let mut line = format!("{label:>4}");
        for (word, &width) in row.iter().zip(&widths) {
            let _ = write!(line, "  {word:<width$}");
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// A note on each cell that is the same run as an earlier one.
fn twins(cells: &[Cell]) -> Vec<String> {
    let texts: Vec<_> = cells.iter().map(|cell| toml::to_string(&cell.spec).ok()).collect();
    let twin = |index: usize| (0..index).find(|&earlier| texts[earlier] == texts[index]);
    (0..cells.len())
        .filter_map(|index| twin(index).map(|earlier| (earlier, index)))
        .map(|(earlier, index)| {
            format!("cells {} and {} are the same run: their levels make no difference", earlier + 1, index + 1)
        })
        .collect()
}

fn n_env_steps(grid: &Grid) -> u64 {
    let learned = grid.runs().filter(|(cell, _)| cell.spec.policy.is_learned());
    learned.map(|(cell, _)| cell.spec.train.n_steps).sum()
}

fn n_episodes(grid: &Grid) -> u64 {
    let of = |spec: &RunSpec| spec.evaluate.n_episodes as u64 * spec.evaluate.worlds.len() as u64;
    grid.runs().map(|(cell, _)| of(&cell.spec)).sum()
}

/// How long the runs may take, on one core and on all.
fn cost(cost: &Cost, n_runs: u64, n_cores: usize) -> String {
    // The last round of runs may leave cores idle.
    let n_rounds = n_runs.div_ceil(n_cores as u64) as f64;
    let mut text = format!(
        "\nestimated from short trials of {} here, good to a factor of 2 where the machine is idle\n",
        counted(cost.n_cells as u64, "cell")
    );
    let all = format!("all {n_cores} cores");
    row(&mut text, "", "one core", &all, n_cores);
    for (what, each, once) in [
        ("training", cost.training, 0.0),
        ("evaluation", cost.driving, cost.scenarios),
        ("total", cost.training + cost.driving, cost.scenarios),
    ] {
        let on_one = duration(each * n_runs as f64 + once);
        row(&mut text, what, &on_one, &duration(each * n_rounds + once / n_cores as f64), n_cores);
    }
    let n_at_once = n_runs.min(n_cores as u64);
    row(&mut text, "memory", &bytes(cost.replay_bytes), &bytes(cost.replay_bytes * n_at_once), n_cores);
    text.push_str("memory is that of the replays; evaluation scenarios take some 3 kB each beside it\n");
    text
}

/// A line of the estimate; with a single core there is no second column.
fn row(text: &mut String, what: &str, on_one: &str, on_all: &str, n_cores: usize) {
    let on_all = if n_cores > 1 { on_all } else { "" };
    let _ = writeln!(text, "{}", format!("{what:13}{on_one:>10}{on_all:>14}").trim_end());
}

/// An amount of memory in megabytes, or gigabytes where it is many.
fn bytes(n: u64) -> String {
    let megabytes = n as f64 / 1e6;
    match megabytes {
        ..10.0 => format!("{megabytes:.1} MB"),
        ..1e4 => format!("{megabytes:.0} MB"),
        _ => format!("{:.0} GB", megabytes / 1e3),
    }
}

/// "1 seed", "2 seeds".
fn counted(number: u64, noun: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {noun}{plural}")
}

/// Seconds in words: two figures are enough for an estimate.
fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 90.0 => (s, "s"),
        s if s < 5400.0 => (s / 60.0, "min"),
        s if s < 172_800.0 => (s / 3600.0, "h"),
        s => (s / 86_400.0, "days"),
    };
    if value < 10.0 { format!("{value:.1} {unit}") } else { format!("{value:.0} {unit}") }
}

/// A whole number with its digits in groups of three.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cost_counts_rounds_and_makes_scenarios_once() {
        let replay_bytes = 19_200_000;
        let each = Cost { training: 10.0, driving: 20.0, scenarios: 4.0, replay_bytes, n_cells: 1 };
        let expected = "
estimated from short trials of 1 cell here, good to a factor of 2 where the machine is idle
               one core   all 4 cores
training           50 s          20 s
evaluation      1.7 min          41 s
total           2.6 min          61 s
memory            19 MB         77 MB
memory is that of the replays; evaluation scenarios take some 3 kB each beside it
";
        assert_eq!(cost(&each, 5, 4), expected);
        let on_one_core = cost(&each, 5, 1);
        assert!(
            on_one_core
                .contains("one core\ntraining           50 s\nevaluation      1.7 min\ntotal           2.6 min\n")
        );
        assert!(on_one_core.contains("memory            19 MB\n"));
    }

    #[test]
    fn numbers_are_readable() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1_234_567), "1 234 567");
        assert_eq!(duration(0.31), "0.3 s");
        assert_eq!(duration(89.0), "89 s");
        assert_eq!(duration(600.0), "10 min");
        assert_eq!(duration(7200.0), "2.0 h");
        assert_eq!(duration(3.0 * 86_400.0), "3.0 days");
    }
}
