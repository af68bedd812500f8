//! The three tables: which columns they have, and what is in them.

use super::column::Column;
use crate::episode::EpisodeRecord;
use crate::report::{DriveSteps, Report, RunRow};
use crate::train::MetricsRow;

/// An evaluation episode, and whose it is.
#[derive(Debug)]
pub(super) struct Episode<'a> {
    pub(super) run: &'a RunRow,
    pub(super) world: &'a str,
    pub(super) record: EpisodeRecord,
}

/// A row of training metrics, and whose it is.
#[derive(Debug)]
pub(super) struct Interval<'a> {
    pub(super) run: &'a RunRow,
    pub(super) row: MetricsRow,
}

/// The columns that say which run of `axes` a row is about.
fn of_runs<'a>(axes: &[String], runs: impl Iterator<Item = &'a RunRow> + Clone) -> Vec<Column> {
    let axis = |(k, axis): (usize, &String)| {
        Column::texts(&format!("axis_{axis}"), runs.clone().map(move |run| &run.axes[k].level))
    };
    let mut columns: Vec<Column> = axes.iter().enumerate().map(axis).collect();
    let cell = |run: &RunRow| run.axes.iter().map(|level| &level.level[..]).collect::<Vec<_>>().join(",");
    columns.push(Column::texts("cell", runs.clone().map(cell)));
    columns.push(Column::counts("seed", runs.clone().map(|run| run.seed)));
    columns.push(Column::texts("run", runs.map(|run| run.train_id.as_str())));
    columns
}

/// The columns of `episodes.parquet`.
pub(super) fn episodes(axes: &[String], episodes: &[Episode<'_>]) -> Vec<Column> {
    let records = || episodes.iter().map(|episode| &episode.record);
    let mut columns = of_runs(axes, episodes.iter().map(|episode| episode.run));
    columns.extend([
        Column::texts("world", episodes.iter().map(|episode| episode.world)),
        Column::counts("scenario", records().map(|record| record.scenario)),
        Column::texts("outcome", records().map(|record| record.outcome.name())),
        Column::numbers("duration", records().map(|record| record.duration)),
        Column::numbers("distance", records().map(|record| record.distance)),
        Column::numbers("geodesic", records().map(|record| record.geodesic)),
        Column::numbers("spl", records().map(|record| record.spl)),
        Column::numbers("near_time", records().map(|record| record.near_time)),
        Column::numbers("near_distance", records().map(|record| record.near_distance)),
        Column::counts("n_decelerations", records().map(|record| record.n_decelerations.into())),
        Column::counts("n_needless_decelerations", records().map(|record| record.n_needless_decelerations.into())),
        Column::optional_numbers("mean_jerk", records().map(|record| record.mean_jerk)),
        Column::texts("drawn", records().map(|record| &record.drawn)),
        Column::counts("n_shielded", records().map(|record| record.n_shielded)),
        Column::counts("n_vetoes", records().map(|record| record.n_vetoes)),
        Column::counts("n_stops", records().map(|record| record.n_stops)),
    ]);
    columns
}

/// The columns of `training.parquet`.
pub(super) fn training(axes: &[String], intervals: &[Interval<'_>]) -> Vec<Column> {
    let rows = || intervals.iter().map(|interval| &interval.row);
    let mut columns = of_runs(axes, intervals.iter().map(|interval| interval.run));
    columns.extend([
        Column::counts("env_steps", rows().map(|row| row.env_steps)),
        Column::counts("gradient_steps", rows().map(|row| row.gradient_steps)),
        Column::numbers("reward_mean", rows().map(|row| row.reward_mean)),
        Column::counts("n_reached", rows().map(|row| row.n_reached)),
        Column::counts("n_collisions", rows().map(|row| row.n_collisions)),
        Column::counts("n_timeouts", rows().map(|row| row.n_timeouts)),
        Column::optional_numbers("loss", rows().map(|row| row.loss)),
        Column::optional_numbers("mean_q", rows().map(|row| row.mean_q)),
        Column::optional_numbers("grad_norm", rows().map(|row| row.grad_norm)),
        Column::numbers("epsilon", rows().map(|row| row.epsilon)),
        Column::numbers("learning_rate", rows().map(|row| row.learning_rate)),
        Column::optional_numbers("return_mean", rows().map(|row| row.return_mean)),
        Column::optional_numbers("arrived", rows().map(|row| row.arrived)),
        Column::optional_numbers("timed_out", rows().map(|row| row.timed_out)),
        Column::optional_numbers("progress", rows().map(|row| row.progress)),
        Column::optional_numbers("abs_progress", rows().map(|row| row.abs_progress)),
        Column::optional_numbers("spinning", rows().map(|row| row.spinning)),
        Column::optional_numbers("action_entropy", rows().map(|row| row.action_entropy)),
        Column::optional_lists("dead_units", rows().map(|row| &row.dead_units[..])),
        Column::optional_numbers("max_abs_q", rows().map(|row| row.max_abs_q)),
        Column::optional_numbers("q_bound", rows().map(|row| row.q_bound)),
    ]);
    columns
}

/// The columns of `steps.parquet`: every step of each drive, and the run in `report` that it is of.
pub(super) fn steps(report: &Report, drives: &[DriveSteps]) -> Vec<Column> {
    let run = |drive: &DriveSteps| {
        let axes = &report.rows[drive.row].axes;
        let run = report.runs.iter().find(|run| run.seed == drive.seed && run.axes == *axes);
        run.expect("drives are of runs in the report")
    };
    let runs: Vec<&RunRow> = drives.iter().map(run).collect();
    let of_steps = || {
        let with_run = drives.iter().zip(&runs);
        with_run.flat_map(|(drive, run)| (0..).zip(&drive.steps).map(move |(k, step)| (*run, drive, k, step)))
    };
    let states = || of_steps().map(|(.., step)| step);
    let commands = || states().map(|step| step.command);
    let mut columns = of_runs(&report.axes, of_steps().map(|(run, ..)| run));
    columns.extend([
        Column::texts("world", of_steps().map(|(_, drive, ..)| &report.rows[drive.row].world)),
        Column::counts("scenario", of_steps().map(|(_, drive, ..)| drive.scenario)),
        Column::texts("why", of_steps().map(|(_, drive, ..)| drive.why)),
        Column::flags("is_as_recorded", of_steps().map(|(_, drive, ..)| drive.is_as_recorded)),
        Column::counts("step", of_steps().map(|(_, _, k, _)| k)),
        Column::numbers("t", states().map(|step| step.t)),
        Column::numbers("x", states().map(|step| step.x)),
        Column::numbers("y", states().map(|step| step.y)),
        Column::numbers("yaw", states().map(|step| step.yaw)),
        Column::numbers("speed", states().map(|step| step.speed)),
        Column::numbers("lateral_speed", states().map(|step| step.lateral_speed)),
        Column::numbers("yaw_rate", states().map(|step| step.yaw_rate)),
        Column::numbers("clearance", states().map(|step| step.clearance)),
        Column::optional_numbers("commanded_speed", commands().map(|command| Some(command?.speed))),
        Column::optional_numbers("commanded_lateral_speed", commands().map(|command| Some(command?.lateral_speed))),
        Column::optional_numbers("commanded_yaw_rate", commands().map(|command| Some(command?.yaw_rate))),
        Column::optional_counts("action", states().map(|step| step.action.map(u64::from))),
    ]);
    columns
}
