//! How many runs score how much.

use crate::scores::task_means;
use crate::{Bootstrap, Interval, Scores, StatsError};

/// What a performance profile counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// The share of all N M scores above tau: the run-score distribution, unbiased for any number of runs.
    Runs,
    /// The share of the M tasks whose mean over the runs lies above tau: the average-score distribution, biased for few
    /// runs.
    TaskMeans,
}

/// A performance profile: at each tau the share of scores above it, `F(tau) = 1/(N M) sum 1[x_nm > tau]`, with its
/// pointwise bootstrap interval (Agarwal et al., 2021, section 4.2; after Dolan & Moré, 2002). In the order of `taus`.
///
/// Resamples redraw the runs within each task, or whole, as `how` says ([`Bootstrap::redrawing`]).
///
/// Where the profile of X lies above that of Y at every tau, X is better by every monotone measure. The bands are
/// pointwise: at 95 %, a curve of many taus leaves its band somewhere more often than once in twenty. Not for fewer
/// than three runs.
///
/// # Errors
/// If a tau is not a number.
///
/// ```
/// use headway_stats::{Bootstrap, Profile, Scores, performance_profile};
///
/// let scores = Scores::from_rows(&[[0.2, 0.9], [0.6, 0.7], [0.4, 0.8]])?;
/// let profile = performance_profile(&scores, &[0.0, 0.4, 0.8, 1.0], Profile::Runs, &Bootstrap::default())?;
/// let shares: Vec<_> = profile.iter().map(|at| at.point).collect();
/// assert_eq!(shares, [1.0, 4.0 / 6.0, 1.0 / 6.0, 0.0]);
/// assert!(profile[1].low < 0.6 && profile[1].high > 0.7);
/// # Ok::<(), headway_stats::StatsError>(())
/// ```
pub fn performance_profile(
    scores: &Scores,
    taus: &[f64],
    profile: Profile,
    how: &Bootstrap,
) -> Result<Vec<Interval>, StatsError> {
    if let Some(tau) = taus.iter().find(|tau| tau.is_nan()) {
        return Err(StatsError::Number { what: "tau", value: *tau, allowed: "a number" });
    }
    let (n_tasks, mut counted, mut points) = (scores.n_tasks(), Vec::new(), vec![0.0; taus.len()]);
    profile.shares(scores.values(), n_tasks, &mut counted, taus, &mut points);
    let mut resample = scores.values().to_vec();
    Ok(how.intervals(&points, |rng, shares| {
        how.redraw(rng, scores.values(), n_tasks, &mut resample);
        profile.shares(&resample, n_tasks, &mut counted, taus, shares);
    }))
}

impl Profile {
    /// Writes the share above each tau, with room for what is counted.
    fn shares(self, values: &[f64], n_tasks: usize, counted: &mut Vec<f64>, taus: &[f64], shares: &mut [f64]) {
        match self {
            Self::Runs => {
                counted.clear();
                counted.extend_from_slice(values);
            }
            Self::TaskMeans => task_means(values, n_tasks, counted),
        }
        counted.sort_unstable_by(f64::total_cmp);
        for (share, tau) in shares.iter_mut().zip(taus) {
            let n_above = counted.len() - counted.partition_point(|value| value <= tau);
            *share = n_above as f64 / counted.len() as f64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(rows: &[[f64; 2]], taus: &[f64], profile: Profile) -> Vec<f64> {
        let scores = Scores::from_rows(rows).unwrap();
        let bands = performance_profile(&scores, taus, profile, &Bootstrap::new(10, 0).unwrap()).unwrap();
        bands.iter().map(|at| at.point).collect()
    }

    #[test]
    fn counts_runs_or_means_strictly_above() {
        let rows = [[0.0, 1.0], [2.0, 5.0]];
        assert_eq!(points(&rows, &[1.0, 2.0, -1.0], Profile::Runs), [0.5, 0.25, 1.0]);
        assert_eq!(points(&rows, &[1.0, 2.0, -1.0], Profile::TaskMeans), [0.5, 0.5, 1.0]);
        assert_eq!(points(&[[-0.0, 0.0]], &[0.0, -0.0], Profile::Runs), [0.0, 0.0]);
    }

    #[test]
    fn taus_must_be_numbers() {
        let scores = Scores::from_rows(&[[0.0]]).unwrap();
        let of = |taus: &[f64]| performance_profile(&scores, taus, Profile::Runs, &Bootstrap::default());
        assert_eq!(of(&[0.0, f64::NAN]).unwrap_err().to_string(), "tau = NaN: must be a number");
        assert_eq!(of(&[]).unwrap(), []);
        assert_eq!(of(&[f64::NEG_INFINITY]).unwrap()[0].point, 1.0);
    }
}
