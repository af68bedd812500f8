//! What came of all runs.

use std::fmt::Write;

use serde::Serialize;

use super::{Clip, Origin, Run, World};
use crate::Error;
use crate::episode::Outcome;
use headway_sim::Footprint;
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

/// The figures of every world and of all of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// World by world.
    pub worlds: Vec<Row>,
    /// All together, every run counting the same.
    pub overall: Row,
    /// Worlds whose reference was planned for want of a path file.
    #[serde(skip)]
    pub planned: Vec<String>,
}

/// A run with the length of its reference, metres.
type Measured = (f64, Run);

impl Report {
    /// The figures of the runs of each world; `footprint` is that of the vehicle that drove.
    ///
    /// # Errors
    /// If a reference is missing and cannot be planned.
    pub fn new(worlds: &[World], runs: &[Vec<Run>], footprint: &Footprint) -> Result<Self, Error> {
        let (mut rows, mut all, mut planned) = (Vec::new(), Vec::new(), Vec::new());
        for (world, runs) in worlds.iter().zip(runs) {
            let (length, origin) = world.reference.length(&world.path, footprint)?;
            if origin == Origin::Planned {
                planned.push(world.name.clone());
            }
            let measured: Vec<Measured> = runs.iter().map(|run| (length, *run)).collect();
            rows.push(Row::of(&world.name, &measured));
            all.extend(measured);
        }
        let overall = Row { intervals: Intervals::of(&all), ..Row::of("all", &all) };
        Ok(Self { worlds: rows, overall, planned })
    }

    /// As JSON: `worlds`, a list of objects, and `overall`, one more. Null stands for the mean time where nothing succeeded.
    #[must_use]
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).expect("numbers and names have a JSON form") + "\n"
    }

    /// As a text table.
    #[must_use]
    pub fn table(&self) -> String {
        let width = self.worlds.iter().map(|row| row.world.chars().count()).max().unwrap_or(0).max("world".len());
        let mut text = format!(
            "{:width$}  runs    success  collision    timeout  mean time   score   score\n{:width$}                %          %          %          s    2022    2023\n",
            "world", ""
        );
        let rule = "\u{2500}".repeat(text.lines().map(|line| line.chars().count()).max().unwrap_or(0));
        let _ = writeln!(text, "{rule}");
        for row in &self.worlds {
            row.write(&mut text, width);
        }
        let _ = writeln!(text, "{rule}");
        self.overall.write(&mut text, width);
        if let Some(i) = &self.overall.intervals {
            let range = |low: f64, high: f64| format!("{:.1}\u{2013}{:.1}", 100.0 * low, 100.0 * high);
            let _ = writeln!(
                text,
                "{:width$}      {:>11}{:>11}{:>11}",
                "",
                range(i.success_low, i.success_high),
                range(i.collision_low, i.collision_high),
                range(i.timeout_low, i.timeout_high)
            );
        }
        text + &self.legend()
    }

    fn legend(&self) -> String {
        let mut text = "mean time: of the successes; scores: OT / clip(AT, 4 OT, 8 OT) for 2022, (2 OT, 8 OT) for 2023, 0 for a failure; \
                        below all: 95 % Wilson intervals over the runs\n\
                        The simulator is Headway's, not Gazebo.\n"
            .to_owned();
        if !self.planned.is_empty() {
            let names =
                if self.planned.len() == self.worlds.len() { "any world".to_owned() } else { self.planned.join(", ") };
            let _ = writeln!(
                text,
                "No path file for {names}: the optimal time is that of our own shortest path, for the largest disc within the footprint."
            );
        }
        text
    }
}

impl Row {
    fn of(world: &str, runs: &[Measured]) -> Self {
        let n = runs.len().max(1) as f64;
        let share = |outcome: Outcome| runs.iter().filter(|(_, run)| run.outcome == outcome).count() as f64 / n;
        let mean_score = |clip: Clip| runs.iter().map(|(length, run)| clip.score(*length, run)).sum::<f64>() / n;
        let times: Vec<f64> =
            runs.iter().filter(|(_, run)| run.outcome == Outcome::Success).map(|(_, run)| run.time).collect();
        Self {
            world: world.to_owned(),
            runs: runs.len(),
            success: share(Outcome::Success),
            collision: share(Outcome::Collision),
            timeout: share(Outcome::Timeout),
            mean_time: (!times.is_empty()).then(|| times.iter().sum::<f64>() / times.len() as f64),
            score_2022: mean_score(Clip::From4To8),
            score_2023: mean_score(Clip::From2To8),
            intervals: None,
        }
    }

    fn write(&self, text: &mut String, width: usize) {
        let percent = |share: f64| format!("{:.1}", 100.0 * share);
        let time = self.mean_time.map_or_else(|| "-".to_owned(), |time| format!("{time:.2}"));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:width$}  {:>4}{:>11}{:>11}{:>11}{time:>11}  {:.4}  {:.4}",
            self.world,
            self.runs,
            percent(self.success),
            percent(self.collision),
            percent(self.timeout),
            self.score_2022,
            self.score_2023
        );
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
        let run = |outcome, time| (10.0, Run { outcome, time });
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
        assert_eq!(Row::of("w", &runs[2..]).mean_time, None);
    }
}
