//! The interval of a rate whose trials come in clusters.

use serde::Serialize;

use crate::Confidence;
use crate::seeds::MIN_UNITS;
use crate::wilson::wilson_of;

/// A 95 % interval of a rate, with the clusters of trials as the unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Clustered {
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
    /// Independent trials that would tell as much: from the number of clusters to that of trials.
    pub effective_n: f64,
}

/// The 95 % Wilson score interval of a share of successes in clusters of trials, each given as successes and trials: the
/// trials of a cluster may be alike, the clusters are independent. `None` for fewer than three clusters, or where one has no
/// trial.
///
/// The interval is that of as many independent trials as would give the share `p` the variance that the clusters show (Korn and
/// Graubard, 1998, Survey Methodology 24; Dean and Pagano, 2015, Journal of Survey Statistics and Methodology 3):
/// `n_eff = p (1 - p) / v`, with `v = k / (k - 1) * sum_i (x_i - p m_i)^2 / (sum_i m_i)^2` for `x_i` successes of `m_i` trials in
/// `k` clusters, and within `k` and the number of trials. Where all trials end alike they do not show how alike those of a cluster
/// are: then each cluster counts as one.
///
/// ```
/// use headway_stats::{Confidence, clustered, wilson};
/// let independent_trials = |successes, n| wilson(successes, n, Confidence::default()).map(headway_stats::Interval::ends);
/// // Ten trials each, of which all or none succeed, tell no more than one each.
/// let alike = clustered(&[(10, 10), (10, 10), (10, 10), (0, 10)]).unwrap();
/// assert_eq!(Ok((alike.low, alike.high)), independent_trials(3, 4));
/// // Where the clusters do not differ, all trials count.
/// let independent = clustered(&[(5, 10), (5, 10), (5, 10), (5, 10)]).unwrap();
/// assert_eq!(Ok((independent.low, independent.high)), independent_trials(20, 40));
/// ```
#[must_use]
pub fn clustered(clusters: &[(usize, usize)]) -> Option<Clustered> {
    let k = clusters.len();
    if k < MIN_UNITS || clusters.iter().any(|(_, trials)| *trials == 0) {
        return None;
    }
    let sum = |value: fn(&(usize, usize)) -> usize| clusters.iter().map(value).sum::<usize>() as f64;
    let (successes, n, k) = (sum(|cluster| cluster.0), sum(|cluster| cluster.1), k as f64);
    let p = successes / n;
    let squares: f64 = clusters.iter().map(|(x, m)| (*x as f64 - p * *m as f64).powi(2)).sum();
    let variance = k / (k - 1.0) * squares / (n * n);
    let is_mixed = successes > 0.0 && successes < n;
    let effective_n = if is_mixed { (p * (1.0 - p) / variance).clamp(k, n) } else { k };
    let (low, high) = wilson_of(p, effective_n, Confidence::default()).ends();
    Some(Clustered { low, high, effective_n })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn wilson(successes: usize, n: usize) -> (f64, f64) {
        crate::wilson(successes, n, Confidence::default()).unwrap().ends()
    }

    #[test]
    fn by_hand() {
        // p = 0.8; (2 - 4, 5 - 4, 5 - 4)^2 add up to 6; v = 3 / 2 * 6 / 225 = 0.04; n_eff = 0.16 / 0.04 = 4.
        let interval = clustered(&[(2, 5), (5, 5), (5, 5)]).unwrap();
        assert!((interval.effective_n - 4.0).abs() < 1e-12, "{interval:?}");
    }

    #[test]
    fn where_all_end_alike_clusters_count_as_one() {
        let all = clustered(&[(10, 10); 5]).unwrap();
        assert_eq!((all.low, all.high, all.effective_n), (wilson(5, 5).0, 1.0, 5.0));
        let none = clustered(&[(0, 10); 5]).unwrap();
        assert_eq!((none.low, none.high), wilson(0, 5));
    }

    #[test]
    fn too_few_clusters_have_none() {
        assert_eq!(clustered(&[(1, 2), (2, 2)]), None);
        assert_eq!(clustered(&[(1, 2), (2, 2), (0, 0)]), None);
    }

    proptest! {
        #[test]
        fn holds_the_rate_and_is_no_narrower_than_over_the_trials(
            clusters in prop::collection::vec((0_usize..=10, 10_usize..=12), 3..20),
        ) {
            let interval = clustered(&clusters).unwrap();
            let (successes, n) = clusters.iter().fold((0, 0), |(a, b), (x, m)| (a + x, b + m));
            let (low, high) = wilson(successes, n);
            let p = successes as f64 / n as f64;
            prop_assert!(interval.low <= p && p <= interval.high);
            prop_assert!(interval.low <= low + 1e-12 && high - 1e-12 <= interval.high);
            prop_assert!((clusters.len() as f64..=n as f64).contains(&interval.effective_n));
        }

        /// Copies of the trials of a cluster add nothing where they are all alike.
        #[test]
        fn copies_of_one_trial_a_cluster_count_as_one(ends in prop::collection::vec(any::<bool>(), 3..40), copies in 1_usize..20) {
            let clusters: Vec<_> = ends.iter().map(|end| (usize::from(*end) * copies, copies)).collect();
            let interval = clustered(&clusters).unwrap();
            let expected = wilson(ends.iter().filter(|end| **end).count(), ends.len());
            prop_assert!((interval.low - expected.0).abs() < 1e-12 && (interval.high - expected.1).abs() < 1e-12);
        }
    }
}
