//! Learning curves: the training metrics of a cell's runs over their env steps.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

use super::bands::{Point, mean_with_band};
use crate::Error;

/// Most points of a run's curve; of more rows, neighbours are averaged.
const MAX_POINTS: usize = 100;

/// What is drawn of the training metrics.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    Reached,
    Collided,
    Reward,
    Loss,
    MeanQ,
}

impl Quantity {
    pub(crate) const ALL: [Self; 5] = [Self::Reached, Self::Collided, Self::Reward, Self::Loss, Self::MeanQ];

    /// Its name in file names.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::Collided => "collided",
            Self::Reward => "reward",
            Self::Loss => "loss",
            Self::MeanQ => "mean-q",
        }
    }

    /// What the axis says.
    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::Reached => "goals reached (share of attempts)",
            Self::Collided => "collisions (share of attempts)",
            Self::Reward => "mean reward of a step",
            Self::Loss => "loss (scaled rewards squared)",
            Self::MeanQ => "mean value (scaled rewards)",
        }
    }

    /// The ends of its axis, where they are known beforehand.
    pub(crate) fn range(self) -> Option<[f64; 2]> {
        matches!(self, Self::Reached | Self::Collided).then_some([0.0, 1.0])
    }

    /// Its value in a row of metrics.
    fn of(self, row: &Row) -> Option<f64> {
        let get = |column: &str| row.get(column).copied();
        let n_ends = || Some(get("n_reached")? + get("n_collisions")? + get("n_timeouts")?).filter(|n| *n > 0.0);
        match self {
            Self::Reached => Some(get("n_reached")? / n_ends()?),
            Self::Collided => Some(get("n_collisions")? / n_ends()?),
            Self::Reward => get("reward_mean"),
            Self::Loss => get("loss"),
            Self::MeanQ => get("mean_q"),
        }
    }
}

/// A row of metrics: its numbers by their columns.
type Row = BTreeMap<String, f64>;

/// The training metrics of one run; columns that hold no numbers are left out.
///
/// # Errors
/// If the file cannot be read or is no table.
pub(super) fn read(path: &Path) -> Result<Vec<Row>, Error> {
    let file = File::open(path).map_err(|error| Error::io("read", path, error))?;
    let mut reader = csv::Reader::from_reader(file);
    let header = reader.headers().map_err(Error::failure)?.clone();
    let row = |record: csv::StringRecord| {
        let fields = header.iter().zip(&record);
        fields.filter_map(|(column, field)| Some((column.to_owned(), field.parse().ok()?))).collect()
    };
    reader.records().map(|record| Ok(row(record.map_err(Error::failure)?))).collect()
}

/// The curve of a quantity over the runs of a cell, each given by its rows.
pub(super) fn curve(quantity: Quantity, runs: &[Vec<Row>]) -> Vec<Point> {
    let mut at: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    for rows in runs {
        for part in rows.chunks(rows.len().div_ceil(MAX_POINTS).max(1)) {
            let Some(steps) = part.last().and_then(|row| row.get("env_steps")) else { continue };
            let values: Vec<f64> = part.iter().filter_map(|row| quantity.of(row)).collect();
            if !values.is_empty() {
                at.entry(*steps as u64).or_default().push(values.iter().sum::<f64>() / values.len() as f64);
            }
        }
    }
    at.into_iter().filter_map(|(steps, values)| mean_with_band(steps as f64, &values)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(numbers: &[(&str, f64)]) -> Row {
        numbers.iter().map(|(column, number)| ((*column).to_owned(), *number)).collect()
    }

    #[test]
    fn shares_are_of_all_ends() {
        let ends = [("n_reached", 3.0), ("n_collisions", 1.0), ("n_timeouts", 0.0)];
        assert_eq!(Quantity::Reached.of(&row(&ends)), Some(0.75));
        assert_eq!(Quantity::Collided.of(&row(&ends)), Some(0.25));
        assert_eq!(Quantity::Reached.of(&row(&[("n_reached", 0.0), ("n_collisions", 0.0), ("n_timeouts", 0.0)])), None);
        assert_eq!(Quantity::Loss.of(&row(&[])), None);
    }

    #[test]
    fn runs_meet_at_equal_steps() {
        let run = |reward: f64| {
            (1..=2).map(|k| row(&[("env_steps", 10.0 * f64::from(k)), ("reward_mean", reward)])).collect()
        };
        let curve = curve(Quantity::Reward, &[run(1.0), run(2.0), run(6.0)]);
        assert_eq!(
            curve.iter().map(|point| (point.x, point.y, point.n)).collect::<Vec<_>>(),
            [(10.0, 3.0, 3), (20.0, 3.0, 3)]
        );
        assert!(curve[0].band.is_some_and(|(low, high)| low < 3.0 && high > 3.0));
    }

    #[test]
    fn long_runs_are_averaged() {
        let run: Vec<Row> =
            (1..=250).map(|k| row(&[("env_steps", f64::from(k)), ("reward_mean", f64::from(k))])).collect();
        let curve = curve(Quantity::Reward, &[run]);
        assert_eq!((curve.len(), curve[0].x, curve[0].y, curve[0].band), (84, 3.0, 2.0, None));
    }
}
