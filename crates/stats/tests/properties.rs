//! What holds for any scores.

use headway_stats::{
    Bootstrap, Confidence, Estimator, Interval, Profile, Scores, Unit, improvement_bootstrap, paired_differences,
    performance_profile, probability_of_improvement, stratified_bootstrap, wilson,
};
use proptest::prelude::*;

const ESTIMATORS: [Estimator; 4] =
    [Estimator::Mean, Estimator::Median, Estimator::Iqm, Estimator::OptimalityGap { target: 1.0 }];

/// Scores with ties, for they are whole tenths.
fn scores(n_runs: impl Strategy<Value = usize>, n_tasks: usize) -> impl Strategy<Value = Scores> {
    n_runs.prop_flat_map(move |n_runs| {
        prop::collection::vec((-20..30_i32).prop_map(|tenths| f64::from(tenths) / 10.0), n_runs * n_tasks)
            .prop_map(move |values| Scores::new(n_runs, n_tasks, values).unwrap())
    })
}

/// Two arms in the same tasks.
fn arms() -> impl Strategy<Value = (Scores, Scores)> {
    (1..5_usize).prop_flat_map(|n_tasks| (scores(1..8_usize, n_tasks), scores(1..8_usize, n_tasks)))
}

fn any_scores() -> impl Strategy<Value = Scores> {
    arms().prop_map(|(x, _)| x)
}

fn map(scores: &Scores, f: impl Fn(f64) -> f64) -> Scores {
    Scores::new(scores.n_runs(), scores.n_tasks(), scores.values().iter().map(|value| f(*value)).collect()).unwrap()
}

/// The same with runs and tasks in reverse order.
fn reversed(scores: &Scores) -> Scores {
    Scores::new(scores.n_runs(), scores.n_tasks(), scores.values().iter().rev().copied().collect()).unwrap()
}

fn few() -> Bootstrap {
    Bootstrap::new(300, 1).unwrap()
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// The interquartile mean by a whole sort.
fn iqm_by_sorting(scores: &Scores) -> f64 {
    let mut sorted = scores.values().to_vec();
    sorted.sort_by(f64::total_cmp);
    let cut = sorted.len() / 4;
    let middle = &sorted[cut..sorted.len() - cut];
    middle.iter().sum::<f64>() / middle.len() as f64
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_order_of_runs_and_tasks_changes_no_estimate(x in any_scores()) {
        for estimator in ESTIMATORS {
            prop_assert!(near(estimator.of(&x), estimator.of(&reversed(&x))), "{estimator:?}");
        }
        prop_assert!(near(Estimator::Iqm.of(&x), iqm_by_sorting(&x)));
    }

    #[test]
    fn estimates_and_intervals_move_and_grow_with_the_scores(
        x in any_scores(), shift in -5.0..5.0_f64, scale in 0.1..10.0_f64,
    ) {
        let other = map(&x, |value| scale * value + shift);
        for estimator in [Estimator::Mean, Estimator::Median, Estimator::Iqm] {
            let (from, to) = [&x, &other].map(|scores| stratified_bootstrap(scores, estimator, &few())).into();
            for (from, to) in [(from.point, to.point), (from.low, to.low), (from.high, to.high)] {
                prop_assert!(near(scale * from + shift, to), "{estimator:?}");
            }
        }
        let gap = Estimator::OptimalityGap { target: 1.0 }.of(&x);
        let moved = Estimator::OptimalityGap { target: scale + shift }.of(&other);
        prop_assert!(gap >= 0.0 && near(scale * gap, moved));
    }

    #[test]
    fn mirrored_scores_have_an_interval_around_their_centre(x in scores(2..6_usize, 3)) {
        // With each score its mirror image around 0 in the same task, every estimate is 0.
        let mirrored: Vec<f64> = x.values().iter().copied().chain(x.values().iter().map(|value| -value)).collect();
        let both = Scores::new(2 * x.n_runs(), 3, mirrored).unwrap();
        for estimator in [Estimator::Mean, Estimator::Median, Estimator::Iqm] {
            let interval = stratified_bootstrap(&both, estimator, &few());
            prop_assert!(near(interval.point, 0.0) && interval.low <= 1e-9 && interval.high >= -1e-9, "{interval:?}");
        }
    }

    #[test]
    fn intervals_grow_with_confidence(x in any_scores(), estimator in prop::sample::select(&ESTIMATORS)) {
        let with = |percent| few().with_confidence(Confidence::percent(percent).unwrap());
        let at = |percent| stratified_bootstrap(&x, estimator, &with(percent));
        let (narrow, wide) = (at(80.0), at(95.0));
        prop_assert!(wide.low <= narrow.low && narrow.low <= narrow.high && narrow.high <= wide.high);
    }

    #[test]
    fn one_arm_improves_as_often_as_the_other_does_not((x, y) in arms()) {
        let (forth, back) = (probability_of_improvement(&x, &y).unwrap(), probability_of_improvement(&y, &x).unwrap());
        prop_assert!((forth + back - 1.0).abs() < 1e-12 && (0.0..=1.0).contains(&forth));
        prop_assert!((probability_of_improvement(&x, &x).unwrap() - 0.5).abs() < 1e-12);
        let cubed = probability_of_improvement(&map(&x, |v| v.powi(3)), &map(&y, |v| v.powi(3))).unwrap();
        prop_assert_eq!(forth, cubed); // ranks only
        let interval = improvement_bootstrap(&x, &y, &few()).unwrap();
        prop_assert_eq!(interval.point, forth);
        prop_assert!(0.0 <= interval.low && interval.low <= interval.high && interval.high <= 1.0);
    }

    #[test]
    fn profiles_fall_from_one_to_zero(x in any_scores()) {
        let taus: Vec<f64> = (-21..=30).map(|tenths| f64::from(tenths) / 10.0).collect();
        for kind in [Profile::Runs, Profile::TaskMeans] {
            let profile = performance_profile(&x, &taus, kind, &few()).unwrap();
            let falls = |a: Interval, b: Interval| a.point >= b.point && a.low >= b.low && a.high >= b.high;
            prop_assert!(profile.windows(2).all(|pair| falls(pair[0], pair[1])));
            prop_assert_eq!((profile[0].point, profile[51].point), (1.0, 0.0));
        }
        // The area under the run-score profile, from -2.1 up, is the mean above -2.1: scores are whole tenths.
        let shares = performance_profile(&x, &taus, Profile::Runs, &few()).unwrap();
        let area: f64 = shares.iter().map(|at| at.point * 0.1).sum();
        prop_assert!((area - 2.1 - Estimator::Mean.of(&x)).abs() < 1e-9);
    }

    #[test]
    fn paired_differences_change_sign_with_the_order_of_the_arms(
        (x, y) in (1..5_usize, 1..6_usize).prop_flat_map(|(m, n)| (scores(Just(n), m), scores(Just(n), m)))
    ) {
        for unit in [Unit::Runs, Unit::Tasks] {
            let forth = paired_differences(&x, &y, unit, &few()).unwrap();
            let back = paired_differences(&y, &x, unit, &few()).unwrap();
            prop_assert!(near(forth.point, -back.point) && near(forth.low, -back.high) && near(forth.high, -back.low));
            prop_assert!(near(forth.point, Estimator::Mean.of(&x) - Estimator::Mean.of(&y)));
        }
    }

    #[test]
    fn wilson_mirrors_successes_and_failures(n in 1..500_usize, share in 0.0..=1.0_f64, percent in 1.0..99.9_f64) {
        let (successes, confidence) = ((share * n as f64) as usize, Confidence::percent(percent).unwrap());
        let (wins, losses) = (wilson(successes, n, confidence).unwrap(), wilson(n - successes, n, confidence).unwrap());
        prop_assert!(near(wins.low, 1.0 - losses.high) && near(wins.high, 1.0 - losses.low));
        prop_assert!(0.0 <= wins.low && wins.low <= wins.point && wins.point <= wins.high && wins.high <= 1.0);
    }
}
