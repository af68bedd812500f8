//! What came of all runs.

use std::path::PathBuf;

use headway_planning::Interventions;
use serde::Serialize;

use super::{Clip, Conditions, Course, OverWorlds, Run, Source};
use crate::episode::Outcome;
use headway_stats::{Confidence, Interval, wilson};

/// The runs of a world, or of all, in figures; rates are shares in [0, 1], times are in seconds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The world's name, or "all".
    pub world: String,
    /// How many runs there were.
    pub runs: usize,
    /// The share of successes.
    pub success: f64,
    /// The share of collisions.
    pub collision: f64,
    /// The share of timeouts.
    pub timeout: f64,
    /// Mean time of the successes, if there is one.
    pub mean_time: Option<f64>,
    /// Mean score of the first edition: [`Clip::From4To8`].
    pub score_2022: f64,
    /// Mean score of the later ones: [`Clip::From2To8`].
    pub score_2023: f64,
    /// The share of all commands that the shield did not pass on as they were, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vetoes: Option<f64>,
    /// The share of all commands in whose place it braked, likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stops: Option<f64>,
    /// Of all worlds together: intervals of the rates.
    #[serde(flatten)]
    pub intervals: Option<Intervals>,
}

/// 95 % Wilson score intervals over the runs of all worlds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Intervals {
    pub success_low: f64,
    pub success_high: f64,
    pub collision_low: f64,
    pub collision_high: f64,
    pub timeout_low: f64,
    pub timeout_high: f64,
}

/// What the runs of a world are measured by.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measure {
    /// The world's name.
    pub world: String,
    /// The length of the reference path, metres.
    pub reference_length: f64,
    /// `OT` of the scores, seconds.
    pub optimal_time: f64,
    /// Where the path came from.
    pub source: Source,
    /// Its file, where it came from one.
    pub file: Option<PathBuf>,
}

/// The figures of every world and of all of them, and what they rest on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// World by world.
    pub worlds: Vec<Row>,
    /// All together, every run counting the same.
    pub overall: Row,
    /// How sure the overall figures are for other worlds like these; none for fewer than three worlds.
    pub over_worlds: Option<OverWorlds>,
    /// What the runs of each world are measured by.
    pub references: Vec<Measure>,
    /// What all was driven under.
    pub conditions: Conditions,
    /// Whether nothing was random: then one run of a world stands for all.
    pub deterministic: bool,
}

/// A run with the optimal time of its world, seconds.
type Measured = (f64, Run);

impl Report {
    /// The figures of the runs of each course.
    #[must_use]
    pub fn new(courses: &[Course], runs: &[Vec<Run>], conditions: Conditions) -> Self {
        let measured = |(course, runs): (&Course, &Vec<Run>)| -> Vec<Measured> {
            runs.iter().map(|run| (course.reference.optimal_time(), *run)).collect()
        };
        let by_world: Vec<_> = courses.iter().zip(runs).map(measured).collect();
        let all = by_world.concat();
        let rows = courses.iter().zip(&by_world).map(|(course, runs)| Row::of(&course.world.name, runs));
        let references: Vec<_> = courses.iter().zip(runs).map(|(course, runs)| (course.reference, &runs[..])).collect();
        Self {
            worlds: rows.collect(),
            overall: Row { intervals: Intervals::of(&all), ..Row::of("all", &all) },
            over_worlds: OverWorlds::of(&references),
            references: courses.iter().map(Measure::of).collect(),
            deterministic: conditions.deterministic,
            conditions,
        }
    }

    /// As a JSON object of its fields. Null stands for the mean time where nothing succeeded.
    #[must_use]
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).expect("numbers and names have a JSON form") + "\n"
    }
}

impl Measure {
    fn of(Course { world, reference, .. }: &Course) -> Self {
        Self {
            world: world.name.clone(),
            reference_length: reference.length,
            optimal_time: reference.optimal_time(),
            source: reference.source,
            file: world.reference.clone(),
        }
    }
}

impl Row {
    fn of(world: &str, runs: &[Measured]) -> Self {
        let n = runs.len().max(1) as f64;
        let share = |outcome: Outcome| runs.iter().filter(|(_, run)| run.outcome == outcome).count() as f64 / n;
        let mean_score = |clip: Clip| runs.iter().map(|(optimal, run)| clip.score(*optimal, run)).sum::<f64>() / n;
        let times: Vec<f64> =
            runs.iter().filter(|(_, run)| run.outcome == Outcome::Success).map(|(_, run)| run.time).collect();
        let count = |of: fn(&Interventions) -> u64| runs.iter().map(|(_, run)| of(&run.interventions)).sum::<u64>();
        let n_commands = count(|i| i.n_commands);
        let of_commands = |n: u64| (n_commands > 0).then(|| n as f64 / n_commands as f64);
        Self {
            world: world.to_owned(),
            runs: runs.len(),
            success: share(Outcome::Success),
            collision: share(Outcome::Collision),
            timeout: share(Outcome::Timeout),
            mean_time: (!times.is_empty()).then(|| times.iter().sum::<f64>() / times.len() as f64),
            score_2022: mean_score(Clip::From4To8),
            score_2023: mean_score(Clip::From2To8),
            vetoes: of_commands(count(|i| i.n_vetoes)),
            stops: of_commands(count(|i| i.n_stops)),
            intervals: None,
        }
    }
}

impl Intervals {
    fn of(runs: &[Measured]) -> Option<Self> {
        let of = |outcome: Outcome| {
            let n = runs.iter().filter(|(_, run)| run.outcome == outcome).count();
            wilson(n, runs.len(), Confidence::default()).ok().map(Interval::ends)
        };
        let (success_low, success_high) = of(Outcome::Success)?;
        let (collision_low, collision_high) = of(Outcome::Collision)?;
        let (timeout_low, timeout_high) = of(Outcome::Timeout)?;
        Some(Self { success_low, success_high, collision_low, collision_high, timeout_low, timeout_high })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_by_hand() {
        let run = |outcome, time| (5.0, Run { outcome, time, interventions: Interventions::default() });
        let runs = [
            run(Outcome::Success, 10.0),
            run(Outcome::Success, 25.0),
            run(Outcome::Collision, 5.0),
            run(Outcome::Timeout, 100.0),
        ];
        let row = Row::of("w", &runs);
        assert_eq!((row.runs, row.success, row.collision, row.timeout), (4, 0.5, 0.25, 0.25));
        assert_eq!(row.mean_time, Some(17.5));
        assert_eq!((row.score_2022, row.score_2023), ((0.25 + 0.2) / 4.0, (0.5 + 0.2) / 4.0));
        assert_eq!((Row::of("w", &runs[2..]).mean_time, row.vetoes, row.stops), (None, None, None));
    }

    #[test]
    fn interventions_are_shares_of_all_commands() {
        let run = |n_commands, n_vetoes, n_stops| {
            let interventions = Interventions { n_commands, n_vetoes, n_stops };
            (5.0, Run { outcome: Outcome::Success, time: 10.0, interventions })
        };
        let row = Row::of("w", &[run(10, 4, 1), run(30, 6, 0)]);
        assert_eq!((row.vetoes, row.stops), (Some(0.25), Some(0.025)));
    }
}
