//! The command line: plain data, checked by clap.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::episode::Metric;
use crate::report::{Choice, Pick};
use crate::spec::Assignment;
use crate::store::AxisLevel;

const EXAMPLES: &str = "\
Examples:
  experiments list                                   what a spec can choose from
  experiments check specs/quick.toml                 is it valid, how many runs, how long
  experiments audit specs/quick.toml                 does its reward pay for arriving
  experiments run specs/quick.toml                   train and evaluate every run not yet done
  experiments run specs/quick.toml --set seeds.count=1 --set train.n_steps=10000
  experiments watch results/quick                    how far each run is, and whether it learns
  experiments report results/quick                   success, collisions, speed, with intervals
  experiments compare results/quick --over reward    what a change of reward is worth, seed by seed
  experiments export results/quick                   the same data as Parquet files

Exit codes: 0 success; 2 bad input (nothing was written); 3 `audit` found a reward that pays best for not arriving;
1 any other failure.";

const SET_HELP: &str = "Replace one value of the spec; may be repeated";

const SET_LONG_HELP: &str = "\
Replace one value of the spec; may be repeated.

PATH is dotted and must exist once all defaults are filled in; numbers index
arrays. VALUE is TOML, or else a plain string. It is applied last, to every
cell. `name` and `seeds.*` can be set too.

  --set agent.gamma=0.9
  --set seeds.count=2
  --set reward.terms.1.weight=10
  --set 'reward={ type = \"r_couple\", desired_speed = 1.0 }'";

/// The parsed command line of `experiments`.
#[derive(Debug, Parser)]
#[command(
    name = "experiments",
    bin_name = "experiments",
    version,
    about = "Train, compare and deploy speed-planning policies: grids of runs from TOML specs.",
    after_help = EXAMPLES
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// One subcommand with its arguments.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Train and evaluate every run of a spec that is not yet done.
    Run(RunArgs),
    /// Validate a spec and print its cells, seeds, runs and estimated cost; write nothing.
    Check(CheckArgs),
    /// Say what the rewards of a spec really pay for, before anything is trained.
    Audit(AuditArgs),
    /// List the rewards, worlds and choices that a spec can name, with their keys and defaults.
    List(ListArgs),
    /// Summarise a folder of finished runs with intervals over the training seeds.
    Report(ReportArgs),
    /// Hold the levels of one axis against each other, the other axes alike: paired differences, and the probability of improvement.
    Compare(CompareArgs),
    /// Write a folder of finished runs as Parquet files: episodes, training metrics, control steps.
    Export(ExportArgs),
    /// Show how far the runs of a folder are: progress, return, collapse; on a terminal until all are done.
    Watch(WatchArgs),
    /// Drive a policy file, or a classical driver, through a spec's evaluation worlds or by a protocol.
    Evaluate(EvaluateArgs),
}

/// Arguments of `experiments run`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  experiments run specs/quick.toml
  experiments run specs/table1.toml --out results/table1 --jobs 8
  experiments run specs/quick.toml --set agent.target=dqn --set seeds.count=1
  experiments run specs/quick.toml --tensorboard     then: tensorboard --logdir results/quick/tensorboard

A run that is already in DIR is not repeated; a run that was interrupted starts afresh.")]
pub struct RunArgs {
    /// The spec file: one run, or a grid of them.
    #[arg(value_name = "SPEC")]
    pub spec: PathBuf,
    /// The folder that keeps the runs [default: results/NAME, after the spec's name].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How many runs train at once [default: the number of cores].
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Also write the training metrics as TensorBoard event files, to DIR/tensorboard; of runs that are there already, too.
    #[arg(long)]
    pub tensorboard: bool,
    #[arg(long = "set", value_name = "PATH=VALUE", help = SET_HELP, long_help = SET_LONG_HELP)]
    /// Values to replace in the spec, in order.
    pub set: Vec<Assignment>,
}

/// Arguments of `experiments check`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  experiments check specs/table1.toml
  experiments check specs/table1.toml --set train.n_steps=200000")]
pub struct CheckArgs {
    /// The spec file: one run, or a grid of them.
    #[arg(value_name = "SPEC")]
    pub spec: PathBuf,
    #[arg(long = "set", value_name = "PATH=VALUE", help = SET_HELP, long_help = SET_LONG_HELP)]
    /// Values to replace in the spec, in order.
    pub set: Vec<Assignment>,
}

/// Arguments of `experiments audit`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  experiments audit specs/table1.toml
  experiments audit specs/default.toml --set agent.gamma=0.99 --distance 10
  experiments audit specs/default.toml --set 'reward={ type = \"r_couple\" }' --format json

Exit codes: 0 if every reward pays best for arriving; 3 if one does not.")]
pub struct AuditArgs {
    /// The spec file: one run, or a grid of them.
    #[arg(value_name = "SPEC")]
    pub spec: PathBuf,
    /// Only the cells with these levels [default: all].
    #[arg(long, value_name = "AXIS=LEVEL[,AXIS=LEVEL]...", value_delimiter = ',', value_parser = axis_level)]
    pub cell: Vec<AxisLevel>,
    /// How far the goal is, metres [default: the least distance of goals in the training's worlds].
    #[arg(long, value_name = "METRES", value_parser = metres)]
    pub distance: Option<f64>,
    /// How to print.
    #[arg(long, value_enum, default_value_t = AuditFormat::Table)]
    pub format: AuditFormat,
    #[arg(long = "set", value_name = "PATH=VALUE", help = SET_HELP, long_help = SET_LONG_HELP)]
    /// Values to replace in the spec, in order.
    pub set: Vec<Assignment>,
}

/// Arguments of `experiments list`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  experiments list

A reward from a plugin crate is listed by binaries that link it: `use my_rewards as _;` in their main.rs.")]
pub struct ListArgs {}

/// Arguments of `experiments report`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  experiments report results/quick
  experiments report results/quick --runs
  experiments report results/quick --runs --format csv > runs.csv
  experiments report results/table1 --format csv > table1.csv
  experiments report results/table1 --format html
  experiments report results/table1 --format html --out table1.html --drives 3 --drive '*/10x15/0/17'
  experiments report results/table1 --format svg --out figures
  experiments report results/table1 --format png --scale 3

--format html writes one page that needs nothing beside it: tables, intervals, learning curves, and drives to play.
--format svg writes the same charts, and the drives, as files; --format png too. All three drive chosen episodes again: minutes for large grids.")]
pub struct ReportArgs {
    /// The folder that `experiments run --out DIR` filled.
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// How to print.
    #[arg(long, value_enum, default_value_t = ReportFormat::Table)]
    pub format: ReportFormat,
    /// One line per run instead: its cell, seed, id, success in each world, and the path of its policy; json and csv have all metrics.
    #[arg(long)]
    pub runs: bool,
    /// Where the page goes [default: DIR/report.html], or the folder of figures [default: DIR/figures].
    #[arg(long, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// Pixels of a PNG for each of the SVG's [default: 2].
    #[arg(long, value_name = "N", value_parser = scale)]
    pub scale: Option<f64>,
    /// How many drives of each outcome the page or the figures show of each cell and world [default: 1].
    #[arg(long, value_name = "N")]
    pub drives: Option<NonZeroUsize>,
    /// One more drive to show; may be repeated. CELL is its levels, joined by commas, or * for every cell.
    #[arg(long, value_name = "CELL/WORLD/SEED/SCENARIO")]
    pub drive: Vec<Pick>,
}

impl ReportArgs {
    /// The episodes that are asked for.
    #[must_use]
    pub fn choice(&self) -> Choice {
        choice(self.drives, &self.drive)
    }
}

fn choice(n_per_outcome: Option<NonZeroUsize>, asked: &[Pick]) -> Choice {
    Choice { n_per_outcome: n_per_outcome.unwrap_or(Choice::default().n_per_outcome), asked: asked.to_vec() }
}

/// Arguments of `experiments compare`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  experiments compare results/table1 --over reward
  experiments compare results/table1 --over reward --base R_couple --metric needless_decelerations_per_m,mean_jerk
  experiments compare results/table1 --over world            the same policies in one world and in the other
  experiments compare results/table1 --over agent --format csv > agents.csv

Runs are paired by their training seed; what the seed decides, the two have in common.")]
pub struct CompareArgs {
    /// The folder that `experiments run --out DIR` filled.
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// The axis of the grid whose levels are compared; or `world`: the worlds of the evaluations.
    #[arg(long, value_name = "AXIS")]
    pub over: String,
    /// The level that the others are held against [default: the axis's first].
    #[arg(long, value_name = "LEVEL")]
    pub base: Option<String>,
    /// The metrics of the table; json and csv have all.
    #[arg(long, value_name = "NAME[,NAME]...", value_delimiter = ',', value_parser = metric,
          default_value = "success,mean_speed")]
    pub metric: Vec<Metric>,
    /// How to print.
    #[arg(long, value_enum, default_value_t = CompareFormat::Table)]
    pub format: CompareFormat,
}

fn metric(name: &str) -> Result<Metric, String> {
    let names = || Metric::ALL.map(Metric::name).join(", ");
    Metric::ALL.into_iter().find(|metric| metric.name() == name).ok_or_else(|| format!("must be one of {}", names()))
}

/// Arguments of `experiments export`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  experiments export results/quick
  experiments export results/table1 --out tables --drives 3 --drive '*/10x15/0/17'
  python -c \"import polars; print(polars.read_parquet('tables/episodes.parquet'))\"

It writes episodes.parquet, training.parquet and steps.parquet; docs/data.md has their columns. The steps are those of the drives
that `report --format html` shows, which are driven again; --drives and --drive choose them in the same way.")]
pub struct ExportArgs {
    /// The folder that `experiments run --out DIR` filled.
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// The folder for the files, which is made if need be [default: DIR/tables].
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// How many drives of each outcome have their steps written of each cell and world [default: 1].
    #[arg(long, value_name = "N")]
    pub drives: Option<NonZeroUsize>,
    /// One more drive; may be repeated. CELL is its levels, joined by commas, or * for every cell.
    #[arg(long, value_name = "CELL/WORLD/SEED/SCENARIO")]
    pub drive: Vec<Pick>,
}

impl ExportArgs {
    /// The episodes that are asked for.
    #[must_use]
    pub fn choice(&self) -> Choice {
        choice(self.drives, &self.drive)
    }
}

/// Arguments of `experiments watch`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  experiments watch results/table1
  experiments watch results/table1 --once

It reads what runs leave in their folders, and disturbs nothing; Ctrl-C ends it.")]
pub struct WatchArgs {
    /// The folder that `experiments run --out DIR` fills.
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// Print once and exit; as it does where the output is no terminal.
    #[arg(long)]
    pub once: bool,
}

/// Arguments of `experiments evaluate`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  experiments evaluate policy.safetensors --spec specs/quick.toml
  experiments evaluate policy.safetensors --spec specs/quick.toml --world 10x15 --plot drive.svg
  experiments evaluate policy.safetensors --spec specs/quick.toml --episodes 20 --seed 7 --plot drives.svg --plot-episodes 0,1,2
  experiments evaluate dwa --spec specs/quick.toml --set policy.max_speed=1.0
  experiments evaluate dwa --protocol barn --worlds barn/worlds
  experiments evaluate policy.safetensors --protocol barn --worlds barn/worlds --world world_3 --plot drive.svg

--format json prints a list of objects, one per world; with --protocol, one object:
  worlds         the table's rows: rates and scores as shares in [0, 1], times in seconds; with a shield, its vetoes and stops
  overall        the same of all runs, and 95 % Wilson intervals as if they were independent
  over_worlds    95 % intervals with the world as the unit; null for fewer than three worlds
  references     of each world: reference_length (m), optimal_time (s), source (file or planned), file
  conditions     driver, shield, vehicle, lidar, odometry, randomize, route, runs, seed
  deterministic  whether nothing was random, so that one run of a world stands for all")]
pub struct EvaluateArgs {
    /// The policy file that a run wrote; or a classical driver: dwa, pure_pursuit, plain_pursuit, vfh.
    #[arg(value_name = "POLICY")]
    pub policy: PathBuf,
    /// The spec whose table `evaluate` names the worlds; with --protocol, only who drives in what, and it may be left out.
    #[arg(long, value_name = "SPEC", required_unless_present = "protocol")]
    pub spec: Option<PathBuf>,
    /// Measure as a benchmark does, in worlds from files.
    #[arg(long, value_enum, requires = "worlds", conflicts_with = "episodes")]
    pub protocol: Option<Protocol>,
    /// The folder of the benchmark's world files; with reference paths in DIR/../paths or DIR/paths.
    #[arg(long, value_name = "DIR", requires = "protocol")]
    pub worlds: Option<PathBuf>,
    /// Runs in each of these worlds [default: 10]; one where nothing is random.
    #[arg(long, value_name = "N", requires = "protocol")]
    pub runs: Option<NonZeroUsize>,
    /// How many of these runs are made at once [default: the number of cores].
    #[arg(long, value_name = "N", requires = "protocol")]
    pub jobs: Option<NonZeroUsize>,
    /// Put a braking shield around whoever drives; `--set evaluate.shield.margin=0.1` changes it.
    #[arg(long)]
    pub shield: bool,
    /// The cell of the spec that says how to evaluate [default: the one whose run made the policy, or else all that fit
    /// its robot, if they agree].
    #[arg(long, value_name = "AXIS=LEVEL[,AXIS=LEVEL]...", value_delimiter = ',', value_parser = axis_level)]
    pub cell: Vec<AxisLevel>,
    /// Episodes in each world, instead of the spec's.
    #[arg(long, value_name = "N")]
    pub episodes: Option<NonZeroUsize>,
    /// The seed of the scenarios, instead of the spec's.
    #[arg(long, value_name = "S")]
    pub seed: Option<u64>,
    /// How to print.
    #[arg(long, value_enum, default_value_t = EvaluateFormat::Table)]
    pub format: EvaluateFormat,
    /// The evaluation world to drive in, by its name [default: all of them].
    #[arg(long, value_name = "NAME")]
    pub world: Option<String>,
    /// Also draw episodes of the first of these worlds: the path coloured by speed, what moves in orange, and
    /// the speed over time.
    #[arg(long, value_name = "OUT.svg")]
    pub plot: Option<PathBuf>,
    /// Which episodes, or runs, to draw, counted from 0; several are drawn side by side, without speed over time.
    #[arg(long, value_name = "K[,K]...", value_delimiter = ',', default_value = "0", requires = "plot")]
    pub plot_episodes: Vec<usize>,
    #[arg(long = "set", value_name = "PATH=VALUE", help = SET_HELP, long_help = SET_LONG_HELP)]
    /// Values to replace in the spec, in order.
    pub set: Vec<Assignment>,
}

fn axis_level(text: &str) -> Result<AxisLevel, String> {
    let (axis, level) = text.split_once('=').ok_or("write AXIS=LEVEL, for example agent=DQN")?;
    Ok(AxisLevel { axis: axis.trim().to_owned(), level: level.trim().to_owned() })
}

fn metres(text: &str) -> Result<f64, String> {
    let metres = text.parse().ok().filter(|metres| *metres > 0.0 && *metres <= 1000.0);
    metres.ok_or_else(|| "must be a number above 0, at most 1000".to_owned())
}

fn scale(text: &str) -> Result<f64, String> {
    let scale = text.parse().ok().filter(|scale| (0.5..=10.0).contains(scale));
    scale.ok_or_else(|| "must be a number from 0.5 to 10".to_owned())
}

/// How `experiments audit` prints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum AuditFormat {
    /// Text for people.
    Table,
    /// JSON, a list of objects: one per case.
    Json,
}

/// How `experiments report` prints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ReportFormat {
    /// A table for people.
    Table,
    /// JSON, a list of objects: one per cell and world; with --runs one per run.
    Json,
    /// CSV, one line per cell and world; with --runs one per run and world.
    Csv,
    /// A page for browsers, in a file.
    Html,
    /// Figures for papers, in a folder.
    Svg,
    /// The same for slides, and for what takes no SVG.
    Png,
}

/// How `experiments compare` prints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum CompareFormat {
    /// A table for people.
    Table,
    /// JSON, an object with a list of differences, in every metric.
    Json,
    /// CSV, one line per difference and metric.
    Csv,
}

/// A published way to measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Protocol {
    /// The BARN challenge: start, goal, time limit and scores as published; in this simulator, not in Gazebo.
    Barn,
}

/// How `experiments evaluate` prints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EvaluateFormat {
    /// A table for people.
    Table,
    /// JSON; see below.
    Json,
}
