//! The same random scores by PyPI's `rliable`, whose authors' paper the estimators are from.
//!
//! Needs a Python with `tests/rliable/requirements.txt` installed, named by `HEADWAY_RLIABLE_PYTHON`; the checks make
//! one:
//!
//! ```text
//! python3 -m venv VENV && VENV/bin/pip install -r crates/stats/tests/rliable/requirements.txt
//! HEADWAY_RLIABLE_PYTHON=VENV/bin/python cargo test --release -p headway-stats --test rliable -- --ignored
//! ```

#![allow(clippy::print_stdout, reason = "says in the log of the checks how well both agree")]

use std::collections::BTreeMap;
use std::io::Write;
use std::process::{Command, Stdio};

use headway_stats::{
    Bootstrap, Confidence, Estimator, Interval, Profile, Scores, improvement_bootstrap, performance_profile,
    stratified_bootstrap,
};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::{Deserialize, Serialize};

const N_CASES: usize = 100;
/// Some figures take Python hundreds of microseconds a time: only so many cases have intervals of them.
const N_PROFILES: usize = 20;
const N_IMPROVEMENTS: usize = 8;
/// Resamples of ours and of theirs.
const N_OURS: usize = 10_000;
const N_THEIRS: usize = 600;
/// The probability below the lower end, and above the upper one, of a 95 % interval.
const TAIL: f64 = 0.025;

/// The figures that have many values, and the improvement.
const AGGREGATES: [&str; 5] = ["mean", "median", "iqm", "gap", "improvement"];

/// A question to `tests/rliable/answer.py`.
#[derive(Serialize)]
struct Case {
    x: Vec<Vec<f64>>,
    y: Vec<Vec<f64>>,
    taus: Vec<f64>,
    gamma: f64,
    reps: Reps,
}

/// Numbers of resamples; without any there is no interval.
#[derive(Serialize)]
struct Reps {
    aggregates: usize,
    profiles: usize,
    improvement: usize,
}

/// Its answer on one figure.
#[derive(Deserialize)]
struct Answer {
    point: f64,
    low: Option<f64>,
    high: Option<f64>,
}

/// Up to 12 runs in up to 6 tasks; scores are whole hundredths, so that there are ties, and no threshold is near one,
/// nor near a mean of them.
fn case(rng: &mut ChaCha8Rng, place: usize) -> Case {
    let mut below = |n: u32| rng.next_u32() % n;
    let (n_tasks, gamma) = (1 + below(6), 0.5 + f64::from(below(100)) / 100.0);
    let spread = 10 + below(150);
    let mut arm = || -> Vec<Vec<f64>> {
        let (n_runs, first) = (3 + below(10), f64::from(below(40)) / 100.0);
        let mut score = || first + f64::from(below(spread)) / 100.0;
        (0..n_runs).map(|_| (0..n_tasks).map(|_| score()).collect()).collect()
    };
    let taus = (0..7).map(|i| 0.2 * f64::from(i) + 1e-5 * std::f64::consts::PI).collect();
    let of_first = |n: usize| if place < n { N_THEIRS } else { 0 };
    let reps = Reps { aggregates: N_THEIRS, profiles: of_first(N_PROFILES), improvement: of_first(N_IMPROVEMENTS) };
    Case { x: arm(), y: arm(), taus, gamma, reps }
}

/// Our figures of one case, by the names of the answers.
struct Ours {
    x: Scores,
    y: Scores,
    gamma: f64,
    taus: Vec<f64>,
}

impl Ours {
    fn new(case: &Case) -> Self {
        let [x, y] = [&case.x, &case.y].map(|rows| Scores::from_rows(rows).unwrap());
        Self { x, y, gamma: case.gamma, taus: case.taus.clone() }
    }

    fn names(&self) -> impl Iterator<Item = String> {
        let profiles =
            ["runs", "means"].into_iter().flat_map(|kind| (0..self.taus.len()).map(move |i| format!("{kind} {i}")));
        AGGREGATES.into_iter().map(str::to_owned).chain(profiles)
    }

    fn interval(&self, name: &str, how: &Bootstrap) -> Interval {
        let estimator = match name {
            "mean" => Estimator::Mean,
            "median" => Estimator::Median,
            "iqm" => Estimator::Iqm,
            "gap" => Estimator::OptimalityGap { target: self.gamma },
            "improvement" => return improvement_bootstrap(&self.x, &self.y, how).unwrap(),
            profile => return self.profile(profile, how),
        };
        stratified_bootstrap(&self.x, estimator, how)
    }

    fn profile(&self, name: &str, how: &Bootstrap) -> Interval {
        let (kind, place) = name.split_once(' ').unwrap();
        let kind = if kind == "runs" { Profile::Runs } else { Profile::TaskMeans };
        let tau = self.taus[place.parse::<usize>().unwrap()];
        performance_profile(&self.x, &[tau], kind, how).unwrap()[0]
    }
}

fn theirs(cases: &[Case]) -> Vec<BTreeMap<String, Answer>> {
    let python = std::env::var("HEADWAY_RLIABLE_PYTHON").expect("HEADWAY_RLIABLE_PYTHON names a Python with rliable");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/rliable/answer.py");
    let mut child = Command::new(&python).arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
    let child = child.as_mut().unwrap_or_else(|error| panic!("cannot start {python}: {error}"));
    child.stdin.take().unwrap().write_all(&serde_json::to_vec(cases).unwrap()).unwrap();
    let answers = serde_json::from_reader(child.stdout.take().unwrap());
    assert!(child.wait().unwrap().success(), "{script} failed");
    answers.unwrap()
}

/// Ends within and not within their tolerance.
#[derive(Default)]
struct Tally {
    within: usize,
    beyond: Vec<String>,
}

impl Tally {
    fn count(&mut self, name: String, ends: (f64, f64), outer: Interval, inner: Interval) {
        for (end, low, high) in [(ends.0, outer.low, inner.low), (ends.1, inner.high, outer.high)] {
            if (low - 1e-9..=high + 1e-9).contains(&end) {
                self.within += 1;
            } else {
                self.beyond.push(format!("{name}: {end} is not from {low} to {high}"));
            }
        }
    }

    fn share(&self) -> f64 {
        self.within as f64 / (self.within + self.beyond.len()) as f64
    }
}

/// Compares the ends of intervals, with a tolerance of `z` standard errors of the difference of two independent
/// bootstraps.
///
/// The end at tail q of n resamples lies at a probability whose standard error is `sqrt(q (1 - q) / n)`, whatever the
/// distribution: that of the difference is `s = sqrt(q (1 - q) (1 / n_ours + 1 / n_theirs))`. So their end must lie
/// between our quantiles at `q - z s` and `q + z s`, which are the ends of our intervals at two other confidences.
fn compare(cases: &[Case], answers: &[BTreeMap<String, Answer>], z: f64, wanted: fn(&str) -> bool) -> Tally {
    let error = (TAIL * (1.0 - TAIL) * (1.0 / N_OURS as f64 + 1.0 / N_THEIRS as f64)).sqrt();
    let with_tail = |tail: f64| {
        let confidence = Confidence::percent(100.0 * (1.0 - 2.0 * tail.max(1e-6))).unwrap();
        Bootstrap::new(N_OURS, 0).unwrap().with_confidence(confidence)
    };
    let (outer, inner) = (with_tail(TAIL - z * error), with_tail(TAIL + z * error));
    let mut tally = Tally::default();
    for (place, (case, answer)) in cases.iter().zip(answers).enumerate() {
        let ours = Ours::new(case);
        for (name, answer) in answer.iter().filter(|(name, _)| wanted(name)) {
            if let Some(ends) = answer.low.zip(answer.high) {
                tally.count(
                    format!("case {place}, {name}"),
                    ends,
                    ours.interval(name, &outer),
                    ours.interval(name, &inner),
                );
            }
        }
    }
    tally
}

#[test]
#[ignore = "needs a Python with rliable, named by HEADWAY_RLIABLE_PYTHON"]
fn points_and_intervals_agree_with_rliable() {
    let mut rng = ChaCha8Rng::seed_from_u64(2021);
    let cases: Vec<Case> = (0..N_CASES).map(|place| case(&mut rng, place)).collect();
    let answers = theirs(&cases);

    let mut worst = 0.0_f64;
    for (place, (case, answer)) in cases.iter().zip(&answers).enumerate() {
        let ours = Ours::new(case);
        assert_eq!(ours.names().count(), answer.len());
        for name in ours.names() {
            let (found, expected) = (ours.interval(&name, &Bootstrap::new(1, 0).unwrap()).point, answer[&name].point);
            let difference = (found - expected).abs();
            assert!(difference < 1e-12, "case {place}, {name}: {found} against {expected}");
            worst = worst.max(difference);
        }
    }

    // By chance an end of some hundred resamples is five standard errors off about once in a million.
    let all = compare(&cases, &answers, 5.0, |_| true);
    // Of aggregates, which have many values, two standard errors hold 95 % of the ends; a wrong resampling would not.
    let close = compare(&cases, &answers, 2.0, |name| AGGREGATES.contains(&name));
    println!(
        "points differ by {worst:.1e} at most; {:.2} % of {} ends lie within 5 standard errors, {:.1} % of {} within 2",
        100.0 * all.share(),
        all.within + all.beyond.len(),
        100.0 * close.share(),
        close.within + close.beyond.len()
    );
    assert!(all.beyond.is_empty(), "beyond Monte-Carlo error: {:#?}", all.beyond);
    assert!(close.share() > 0.9, "too often beyond two standard errors: {:#?}", close.beyond);
}
