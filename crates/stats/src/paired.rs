//! Differences between two arms that shared what they met, and units that hold several values.

use crate::bootstrap::mean;
use crate::{Bootstrap, Interval, Scores, StatsError, bootstrap};

/// What is redrawn as a whole: that which was drawn independently, and to whose kind the answer is to hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// The runs: would other training seeds say the same in these scenarios?
    Runs,
    /// The tasks: would other scenarios say the same of these runs? All runs of a scenario stay together, for they
    /// are correlated.
    Tasks,
}

/// The mean difference `1/(N M) sum (x_nm - y_nm)` of two arms with the same seeds in the same scenarios, with its
/// percentile bootstrap interval over the unit (Efron, 1979), in the units of the scores.
///
/// Each unit gives one difference, its mean over the other side, so what both arms met alike (a hard scenario, a lucky
/// start) cancels: the interval is far narrower than that of two separate means. Above 0, X is better beyond the luck
/// of the unit; it says nothing of the luck of the other side. Not for fewer than three units, and only for arms whose
/// rows and columns belong together: row k of both is seed k, column m scenario m.
///
/// # Errors
/// If the arms differ in the number of runs or tasks.
///
/// ```
/// use headway_stats::{Bootstrap, Scores, Unit, paired_differences};
///
/// // Seeds differ by far more than the arms do, and yet the arms can be told apart.
/// let x = Scores::from_rows(&[[0.32, 0.41], [0.63, 0.72], [0.92, 0.99]])?;
/// let y = Scores::from_rows(&[[0.30, 0.40], [0.60, 0.70], [0.90, 0.98]])?;
/// let gain = paired_differences(&x, &y, Unit::Runs, &Bootstrap::default())?;
/// assert!((gain.point - 0.11 / 6.0).abs() < 1e-12);
/// assert!((gain.low - 0.015).abs() < 1e-12 && (gain.high - 0.025).abs() < 1e-12);
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
pub fn paired_differences(x: &Scores, y: &Scores, unit: Unit, how: &Bootstrap) -> Result<Interval, StatsError> {
    let sides = [("runs", x.n_runs(), y.n_runs()), ("tasks", x.n_tasks(), y.n_tasks())];
    if let Some(&(what, first, second)) = sides.iter().find(|(_, first, second)| first != second) {
        return Err(StatsError::Mismatch { what, first, second });
    }
    let differences = x.values().iter().zip(y.values()).map(|(x, y)| x - y).collect();
    let differences = Scores::new(x.n_runs(), x.n_tasks(), differences)?;
    let units = match unit {
        Unit::Runs => differences.run_means(),
        Unit::Tasks => differences.task_means(),
    };
    bootstrap(&units, mean, how)
}

/// The mean of all values of all clusters with its cluster bootstrap interval: clusters are redrawn whole, so that the
/// correlation within them is kept (Davison & Hinkley, 1997, section 3.8): `sum of values / number of values` of each
/// resample.
///
/// A cluster is the values that share their luck: all episodes in one scenario, or of one seed. Clusters may differ in
/// size; empty ones, as where a time is undefined, are left out. For arms that share scenarios but not their number of
/// runs, or are not defined everywhere, a cluster holds a scenario's differences. Not for fewer than three clusters.
///
/// # Errors
/// If no cluster has a value, or a value is not finite.
///
/// ```
/// use headway_stats::{Bootstrap, Confidence, cluster_bootstrap, wilson};
///
/// // Ten runs in each of four worlds, which either all succeed or all fail: four facts, not forty.
/// let worlds = [[1.0; 10], [1.0; 10], [0.0; 10], [1.0; 10]];
/// let clusters = cluster_bootstrap(&worlds, &Bootstrap::default())?;
/// assert_eq!((clusters.point, clusters.low, clusters.high), (0.75, 0.25, 1.0));
/// assert!(wilson(30, 40, Confidence::default())?.low > 0.59);
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
pub fn cluster_bootstrap(clusters: &[impl AsRef<[f64]>], how: &Bootstrap) -> Result<Interval, StatsError> {
    for (cluster, values) in clusters.iter().map(AsRef::as_ref).enumerate() {
        if let Some(place) = values.iter().position(|value| !value.is_finite()) {
            return Err(StatsError::Value { cluster, place, value: values[place] });
        }
    }
    let filled = clusters.iter().map(AsRef::as_ref).filter(|values| !values.is_empty());
    let sums: Vec<(f64, usize)> = filled.map(|values| (values.iter().sum(), values.len())).collect();
    if sums.is_empty() {
        return Err(StatsError::Empty { what: "values" });
    }
    let pooled = |sums: &[(f64, usize)]| {
        sums.iter().map(|(sum, _)| sum).sum::<f64>() / sums.iter().map(|(_, n)| n).sum::<usize>() as f64
    };
    bootstrap(&sums, pooled, how)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_decides_the_width() {
        // Runs differ in their gain, scenarios do not.
        let x = Scores::from_rows(&[[1.0, 1.0, 1.0], [2.0, 2.0, 2.0], [6.0, 6.0, 6.0]]).unwrap();
        let y = Scores::from_rows(&[[0.0; 3]; 3]).unwrap();
        let of = |unit| paired_differences(&x, &y, unit, &Bootstrap::default()).unwrap();
        assert_eq!(of(Unit::Runs), Interval { point: 3.0, low: 1.0, high: 6.0 });
        assert_eq!(of(Unit::Tasks), Interval { point: 3.0, low: 3.0, high: 3.0 });
    }

    #[test]
    fn what_both_arms_share_cancels() {
        let hardness = [0.0, 50.0, -20.0, 7.0];
        let row = |seed: f64, gain: f64| hardness.map(|h| h + seed + gain);
        let x = Scores::from_rows(&[row(3.0, 1.0), row(-9.0, 1.0), row(0.5, 1.0)]).unwrap();
        let y = Scores::from_rows(&[row(3.0, 0.0), row(-9.0, 0.0), row(0.5, 0.0)]).unwrap();
        for unit in [Unit::Runs, Unit::Tasks] {
            let gain = paired_differences(&x, &y, unit, &Bootstrap::default()).unwrap();
            assert_eq!((gain.point, gain.low, gain.high), (1.0, 1.0, 1.0));
        }
    }

    #[test]
    fn clusters_count_by_their_values() {
        let how = Bootstrap::default();
        let interval = cluster_bootstrap(&[vec![1.0, 1.0, 1.0], vec![], vec![5.0], vec![2.0, 2.0]], &how).unwrap();
        assert_eq!(interval, Interval { point: 2.0, low: 1.0, high: 5.0 }); // 12 / 6; 1/27 > 2.5 % for each extreme
    }

    #[test]
    fn clusters_of_one_value_are_plain_units() {
        let values = [0.3, 0.1, 0.9, 0.4, 0.45];
        let how = Bootstrap::new(1_000, 5).unwrap();
        let clusters = cluster_bootstrap(&values.map(|value| [value]), &how).unwrap();
        assert_eq!(clusters, bootstrap(&values, mean, &how).unwrap());
    }

    #[test]
    fn refusals_name_what_does_not_fit() {
        let (one, two) = (Scores::from_rows(&[[0.0]]).unwrap(), Scores::from_rows(&[[0.0], [0.0]]).unwrap());
        let how = Bootstrap::default();
        let error = paired_differences(&one, &two, Unit::Runs, &how).unwrap_err();
        assert_eq!(error.to_string(), "runs of the second arm = 2: must be 1, as of the first");
        let error = cluster_bootstrap(&[vec![1.0], vec![0.0, f64::NAN]], &how).unwrap_err();
        assert_eq!(error.to_string(), "value 1 of cluster 1 = NaN: must be finite");
        let error = cluster_bootstrap(&[[0.0; 0]], &how).unwrap_err();
        assert_eq!(error.to_string(), "values: must be at least one");
    }
}
