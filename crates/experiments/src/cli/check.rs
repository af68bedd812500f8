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
use crate::plan::{Plan, Run};
use crate::spec::{Cell, Grid, Seeds};

/// Validates a spec and prints its cells, its seeds, how much there is to run, and how long that may take.
///
/// # Errors
/// Whatever is wrong with the spec.
pub fn execute(args: &CheckArgs, out: &mut dyn Write) -> Result<(), Error> {
    let grid = Grid::load(&args.spec, &args.set)?;
    let one_seed = one_seed(&grid);
    let plan = Plan::new(&one_seed)?;
    print(out, &describe(&grid, &Amounts::of(&plan, grid.seeds)))?;
    let left_out = left_out::in_words(&grid);
    if !left_out.is_empty() {
        print(out, &format!("\n{left_out}"))?;
    }
    let n_cores = available_parallelism().map_or(1, NonZeroUsize::get);
    let cost_of_run = speed::cost(&plan, |run| n_seeds(run, grid.seeds))?;
    print(out, &cost(&cost_of_run, Amounts::of(&plan, grid.seeds).n_runs, n_cores))
}

/// The grid with the first of its seeds alone: which runs cells share is the same for each.
fn one_seed(grid: &Grid) -> Grid {
    Grid { seeds: Seeds { count: 1, ..grid.seeds }, ..grid.clone() }
}

/// How many seeds a run of one seed stands for; where nothing is trained, they make no difference.
fn n_seeds(run: &Run<'_>, seeds: Seeds) -> u64 {
    if run.spec.policy.is_learned() { seeds.count } else { 1 }
}

/// How much there is to run, each run and each evaluation once.
#[derive(Debug, PartialEq, Eq)]
struct Amounts {
    n_runs: u64,
    n_env_steps: u64,
    n_episodes: u64,
}

impl Amounts {
    /// Those of a grid with these seeds, from its plan with one of them.
    fn of(plan: &Plan<'_>, seeds: Seeds) -> Self {
        let total = |of: fn(&Run<'_>) -> u64| {
            let each = plan.runs.iter().map(|run| n_seeds(run, seeds).saturating_mul(of(run)));
            each.fold(0, u64::saturating_add)
        };
        Self {
            n_runs: total(|_| 1),
            n_env_steps: total(|run| if run.spec.policy.is_learned() { run.spec.train.n_steps } else { 0 }),
            n_episodes: total(|run| run.evaluations.iter().map(|of| of.spec.evaluate.n_episodes as u64).sum()),
        }
    }
}

/// The grid in words: name, cells, seeds, amounts.
fn describe(grid: &Grid, amounts: &Amounts) -> String {
    let mut text = format!("{}: valid\n\n", grid.name);
    text.push_str(&cells(grid));
    for note in twins(&grid.cells) {
        let _ = writeln!(text, "note: {note}");
    }
    let last = grid.seeds.first + (grid.seeds.count - 1);
    let _ = writeln!(text, "\nseeds        {} to {last}", grid.seeds.first);
    let Amounts { n_runs, n_env_steps, n_episodes } = amounts;
    let _ = writeln!(text, "runs         {n_runs} = {}", factors(grid, *n_runs));
    let _ = writeln!(text, "training     {} env steps", grouped(*n_env_steps));
    let _ = writeln!(text, "evaluation   {} episodes", grouped(*n_episodes));
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

/// What the number of runs comes from: cells and seeds, less what is done for an earlier cell, or seed, already.
fn factors(grid: &Grid, n_runs: u64) -> String {
    let (n_cells, n_seeds) = (grid.cells.len() as u64, grid.seeds.count);
    let product = format!("{} x {}", counted(n_cells, "cell"), counted(n_seeds, "seed"));
    match n_cells * n_seeds - n_runs {
        0 => product,
        n_again => format!("{product}, less {n_again} that would be the same again"),
    }
}

/// How long the runs may take, on one core and on all.
fn cost(cost: &Cost, n_runs: u64, n_cores: usize) -> String {
    // The last round of runs may leave cores idle.
    let n_rounds = n_runs.div_ceil(n_cores as u64) as f64;
    let mut text = format!(
        "\nestimated from short trials of {} here, good to a factor of 2 where the machine is idle\n",
        counted(cost.n_tried as u64, "run")
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
        let each = Cost { training: 10.0, driving: 20.0, scenarios: 4.0, replay_bytes, n_tried: 1 };
        let expected = "
estimated from short trials of 1 run here, good to a factor of 2 where the machine is idle
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

    /// Cells that differ in their evaluation only are trained once, and evaluated once in a world that they have in common.
    #[test]
    fn what_cells_share_counts_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("grid.toml");
        let text = r#"
            seeds = { first = 3, count = 10 }
            train = { n_steps = 1_000 }
            evaluate = { n_episodes = 7 }
            [[axis]]
            name = "change"
            [axis.levels]
            none = {}
            gamma = { "agent.gamma" = 0.9 }
            "6 obstacles" = { "evaluate.worlds.0.world" = { type = "room", obstacles = { count = 6 } } }
            shield = { "evaluate.shield" = { margin = 0.3 } }
            VFH = { "policy.type" = "vfh" }
        "#;
        std::fs::write(&path, text).unwrap();
        let grid = Grid::load(&path, &[]).unwrap();
        let one_seed = one_seed(&grid);
        let amounts = Amounts::of(&Plan::new(&one_seed).unwrap(), grid.seeds);
        // Two trainings of ten seeds each and the driver's run; the first is evaluated in 2 worlds, in 1 more, and in 2 with a shield.
        let n_episodes = 7 * (10 * (5 + 2) + 2);
        assert_eq!(amounts, Amounts { n_runs: 21, n_env_steps: 20_000, n_episodes });
        let text = describe(&grid, &amounts);
        let runs = "\nruns         21 = 5 cells x 10 seeds, less 29 that would be the same again\n";
        assert!(text.contains(runs), "{text}");
        // As `run` has them.
        let plan = Plan::new(&grid).unwrap();
        assert_eq!(plan.runs.len(), 21);
        assert_eq!(plan.runs.iter().map(|run| 7 * run.evaluations.len() as u64).sum::<u64>(), n_episodes);
        assert_eq!(factors(&grid, 50), "5 cells x 10 seeds");
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
