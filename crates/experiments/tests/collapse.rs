//! Real trainings, small ones, of which it is known how they end: one that parks and dithers, and one that drives.

use headway_experiments::collapse::{Collapse, Watchdog};
use headway_experiments::spec::{Grid, RunSpec};
use headway_experiments::train::{MetricsRow, Training};

/// Reading P of Table I with R, as published: a collision costs as much as it should, but nothing says where to go, and to stand
/// still is safe. Beside it the recommended set-up.
const SPEC: &str = r#"
name = "ends"
seeds = { first = 0, count = 1 }
train = { n_steps = 60_000, log_every = 5_000 }
agent = { n_step = 3 }

[[axis]]
name = "arm"
[axis.levels]
recommended = {}

[axis.levels.P]
"world" = { type = "room_10x15" }
"reward" = { type = "r" }
"env.actions.speeds" = [0.0, 0.3, 0.6, 0.9, 1.2, 1.5]
"env.actions.yaw_rates" = [-1.5, -0.75, 0.0, 0.75, 1.5]
"#;

/// The rows of a training, and what the watchdog said of them: while it went on, and at the end.
fn train(spec: &RunSpec) -> (Vec<MetricsRow>, Vec<Collapse>, Vec<Collapse>) {
    let (mut training, mut watchdog) = (Training::new(spec, 0).unwrap(), Watchdog::default());
    let (mut rows, mut said) = (Vec::new(), Vec::new());
    while !training.is_over() {
        training.step().unwrap();
        if let Some(row) = training.metrics().unwrap() {
            rows.push(row.clone());
            said.extend(watchdog.push(row));
        }
    }
    (rows, said, watchdog.verdict())
}

fn arms() -> [RunSpec; 2] {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ends.toml");
    std::fs::write(&path, SPEC).unwrap();
    let grid = Grid::load(&path, &[]).unwrap();
    let [recommended, p] = &grid.cells[..] else { panic!("{} cells", grid.cells.len()) };
    [recommended.spec.clone(), p.spec.clone()]
}

#[test]
fn a_policy_that_nothing_draws_to_its_goal_makes_no_progress() {
    let [_, p] = arms();
    let (rows, said, verdict) = train(&p);
    let kinds: Vec<_> = said.iter().map(Collapse::kind).collect();
    assert_eq!(kinds, ["no_progress"], "said once, and nothing else: {said:?}");
    let [Collapse::NoProgress { progress, arrived, .. }] = verdict[..] else { panic!("{verdict:?}") };
    assert!(progress.abs() < 0.05 && arrived < 0.2, "{verdict:?}");
    let last = rows.last().unwrap();
    assert!(last.timed_out.unwrap() > 0.8, "{last:?}");
}

#[test]
fn a_policy_that_learns_is_left_alone() {
    let [recommended, _] = arms();
    let (rows, said, verdict) = train(&recommended);
    assert_eq!((&said[..], &verdict[..]), (&[][..], &[][..]));
    let (first, last) = (&rows[0], rows.last().unwrap());
    assert!(last.arrived.unwrap() > 0.9 && last.progress.unwrap() > 0.7, "{last:?}");
    assert!(last.return_mean > first.return_mean && last.action_entropy.unwrap() > 0.3);
    assert_eq!((last.dead_units.len(), last.dead_units.iter().all(|share| *share < 0.5)), (2, true));
    // 100 for the goal, 40 times 0.3 m in a step, scaled by 0.01, at gamma 0.95.
    assert!((20.0..25.0).contains(&last.q_bound.unwrap()) && last.max_abs_q < last.q_bound);
}
