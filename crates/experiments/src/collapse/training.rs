//! Verdicts on the rows of a training's metrics.

use std::collections::VecDeque;

use super::Collapse;
use crate::train::MetricsRow;

/// How many rows in a row must show it: one may be bad luck.
pub const N_RECENT: usize = 3;
/// Probability of random actions above which nobody's behaviour is judged: it is not yet the policy's.
pub const EPSILON: f64 = 0.1;
/// Share of time from which on a policy spins.
pub const SPINNING: f64 = 0.5;
/// Speed of approach to the goal, m/s, below which a policy makes no progress, if it does not arrive either.
pub const PROGRESS: f64 = 0.05;
/// Share of goals reached below which it does not arrive.
pub const ARRIVED: f64 = 0.2;
/// Share of a hidden layer from which on its units count as dead.
pub const DEAD_UNITS: f64 = 0.9;
/// How many times as large as any return a value must be to explode.
pub const Q_EXCESS: f64 = 2.0;
/// Entropy of actions, of that of all alike, below which there is but one: about that of 99 % for one of twelve.
pub const ENTROPY: f64 = 0.02;

/// How a policy has collapsed by the end of these rows of metrics: what each of the last [`N_RECENT`] shows, with the mean of its
/// numbers over them. Of fewer rows there is no verdict.
///
/// - [`Collapse::Spinning`]: `spinning >=` [`SPINNING`].
/// - [`Collapse::NoProgress`]: `progress <` [`PROGRESS`] and `arrived <` [`ARRIVED`] (where no goal ended, none was reached).
/// - [`Collapse::OneAction`]: `action_entropy <` [`ENTROPY`].
/// - [`Collapse::DeadUnits`]: a share of `dead_units >=` [`DEAD_UNITS`] in a layer.
/// - [`Collapse::ExplodingQ`]: `max_abs_q >` [`Q_EXCESS`] times `q_bound`.
///
/// The first three are judged only where `epsilon <=` [`EPSILON`].
pub fn of_training(rows: &[MetricsRow]) -> Vec<Collapse> {
    let Some(recent) = rows.last_chunk::<N_RECENT>() else { return Vec::new() };
    [spinning(recent), no_progress(recent), one_action(recent), dead_units(recent), exploding_q(recent)]
        .into_iter()
        .flatten()
        .collect()
}

type Recent = [MetricsRow; N_RECENT];

fn spinning(rows: &Recent) -> Option<Collapse> {
    let [share] = all(rows, |row| acts(row)?.spinning.filter(|share| *share >= SPINNING).map(|share| [share]))?;
    Some(Collapse::Spinning { share })
}

fn no_progress(rows: &Recent) -> Option<Collapse> {
    let figures = |row: &MetricsRow| {
        let (progress, arrived) = (acts(row)?.progress?, row.arrived.unwrap_or(0.0));
        (progress < PROGRESS && arrived < ARRIVED).then_some([progress, row.abs_progress?, arrived])
    };
    let [progress, abs_progress, arrived] = all(rows, figures)?;
    Some(Collapse::NoProgress { progress, abs_progress, arrived })
}

fn one_action(rows: &Recent) -> Option<Collapse> {
    let [entropy] = all(rows, |row| acts(row)?.action_entropy.filter(|entropy| *entropy < ENTROPY).map(|e| [e]))?;
    Some(Collapse::OneAction { entropy })
}

/// Of several such layers the one with most dead units.
fn dead_units(rows: &Recent) -> Option<Collapse> {
    let of_layer = |layer: usize| {
        let dead = |row: &MetricsRow| row.dead_units.get(layer).filter(|share| **share >= DEAD_UNITS).map(|s| [*s]);
        let [share] = all(rows, dead)?;
        Some((layer, share))
    };
    let layers = (0..rows[0].dead_units.len()).filter_map(of_layer);
    let (layer, share) = layers.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    Some(Collapse::DeadUnits { layer: layer + 1, share })
}

fn exploding_q(rows: &Recent) -> Option<Collapse> {
    let figures = |row: &MetricsRow| {
        let (max_abs_q, bound) = (row.max_abs_q?, row.q_bound?);
        (max_abs_q > Q_EXCESS * bound).then_some([max_abs_q, bound])
    };
    let [max_abs_q, bound] = all(rows, figures)?;
    Some(Collapse::ExplodingQ { max_abs_q, bound })
}

/// The row, if what happened in it was the policy's doing.
fn acts(row: &MetricsRow) -> Option<&MetricsRow> {
    (row.epsilon <= EPSILON).then_some(row)
}

/// The means of the figures that every row shows; none if one of them does not.
fn all<const N: usize>(rows: &Recent, figures: impl Fn(&MetricsRow) -> Option<[f64; N]>) -> Option<[f64; N]> {
    let mut sums = [0.0; N];
    for row in rows {
        let figures = figures(row)?;
        sums.iter_mut().zip(figures).for_each(|(sum, figure)| *sum += figure);
    }
    Some(sums.map(|sum| sum / N_RECENT as f64))
}

/// One that looks on while a policy is trained and says once of each kind that it has collapsed.
#[derive(Debug, Default)]
pub struct Watchdog {
    recent: VecDeque<MetricsRow>,
    said: Vec<&'static str>,
}

impl Watchdog {
    /// Takes in the next row; what has collapsed and was not said before.
    pub fn push(&mut self, row: MetricsRow) -> Vec<Collapse> {
        if self.recent.len() == N_RECENT {
            self.recent.pop_front();
        }
        self.recent.push_back(row);
        let mut news = self.verdict();
        news.retain(|collapse| !self.said.contains(&collapse.kind()));
        self.said.extend(news.iter().map(Collapse::kind));
        news
    }

    /// How things stand: [`of_training`] of the rows up to now.
    pub fn verdict(&mut self) -> Vec<Collapse> {
        of_training(self.recent.make_contiguous())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of a healthy training.
    fn healthy() -> MetricsRow {
        MetricsRow {
            env_steps: 10_000,
            gradient_steps: 300,
            reward_mean: 1.0,
            n_reached: 90,
            n_collisions: 10,
            n_timeouts: 0,
            loss: Some(0.1),
            mean_q: Some(2.0),
            grad_norm: Some(1.0),
            epsilon: 0.02,
            learning_rate: 1e-3,
            return_mean: Some(100.0),
            arrived: Some(0.9),
            timed_out: Some(0.0),
            progress: Some(0.8),
            abs_progress: Some(0.9),
            spinning: Some(0.01),
            action_entropy: Some(0.7),
            dead_units: vec![0.2, 0.1],
            max_abs_q: Some(3.0),
            q_bound: Some(20.0),
        }
    }

    /// The verdict on three rows, each `healthy` but for what `change` does to it.
    fn verdict(change: impl Fn(usize, &mut MetricsRow)) -> Vec<Collapse> {
        let rows = (0..3).map(|k| {
            let mut row = healthy();
            change(k, &mut row);
            row
        });
        of_training(&rows.collect::<Vec<_>>())
    }

    #[test]
    fn a_healthy_series_has_none() {
        assert_eq!(verdict(|_, _| ()), []);
    }

    #[test]
    fn spinning_is_the_mean_of_three_shares() {
        let shares = [0.5, 0.75, 1.0];
        assert_eq!(verdict(|k, row| row.spinning = Some(shares[k])), [Collapse::Spinning { share: 0.75 }]);
        let recovered = [0.5, 0.75, 0.49];
        assert_eq!(verdict(|k, row| row.spinning = Some(recovered[k])), []);
    }

    #[test]
    fn no_progress_asks_for_neither_approach_nor_arrival() {
        let parks = |row: &mut MetricsRow| {
            (row.progress, row.abs_progress, row.arrived) = (Some(0.02), Some(0.5), Some(0.0));
        };
        let found = verdict(|_, row| parks(row));
        let [Collapse::NoProgress { progress, abs_progress, arrived }] = found[..] else { panic!("{found:?}") };
        assert!((progress - 0.02).abs() < 1e-12 && (abs_progress - 0.5).abs() < 1e-12 && arrived == 0.0);
        assert_eq!(
            verdict(|_, row| {
                parks(row);
                row.arrived = Some(0.2);
            }),
            [],
            "some arrive"
        );
        assert_eq!(
            verdict(|_, row| {
                parks(row);
                row.progress = Some(0.05);
            }),
            [],
            "some come nearer"
        );
        // In an interval in which no episode ended, none arrived.
        assert_eq!(
            verdict(|_, row| {
                parks(row);
                row.arrived = None;
            })
            .len(),
            1
        );
        // Nor is anybody judged who mostly acts at random.
        assert_eq!(
            verdict(|k, row| {
                parks(row);
                row.epsilon = if k == 0 { 0.3 } else { 0.1 };
            }),
            []
        );
    }

    #[test]
    fn one_action_is_no_entropy() {
        assert_eq!(verdict(|_, row| row.action_entropy = Some(0.0)), [Collapse::OneAction { entropy: 0.0 }]);
        assert_eq!(verdict(|_, row| row.action_entropy = Some(0.02)), []);
    }

    #[test]
    fn dead_units_are_those_of_the_worst_layer() {
        let found = verdict(|_, row| row.dead_units = vec![0.9, 1.0, 0.0]);
        assert_eq!(found, [Collapse::DeadUnits { layer: 2, share: 1.0 }]);
        assert_eq!(verdict(|k, row| row.dead_units[k.min(1)] = 1.0), [], "never the same layer three times");
        // The weights are the policy's also while it explores.
        assert_eq!(verdict(|_, row| (row.dead_units, row.epsilon) = (vec![1.0], 1.0)).len(), 1);
    }

    #[test]
    fn values_explode_beyond_twice_all_returns() {
        assert_eq!(verdict(|_, row| row.max_abs_q = Some(40.0)), []);
        let found = verdict(|_, row| row.max_abs_q = Some(45.0));
        assert_eq!(found, [Collapse::ExplodingQ { max_abs_q: 45.0, bound: 20.0 }]);
        assert_eq!(found[0].describe(), "has exploding Q (|Q| up to 45.000, returns up to 20.000)");
        assert_eq!(verdict(|_, row| (row.max_abs_q, row.q_bound) = (Some(45.0), None)), [], "gamma = 1: no bound");
    }

    #[test]
    fn what_an_earlier_version_did_not_measure_is_not_judged() {
        let text = "env_steps,gradient_steps,reward_mean,n_reached,n_collisions,n_timeouts,loss,mean_q,grad_norm,\
                    epsilon,learning_rate\n640,4,-0.5,0,0,0,0.1,0.2,0.3,0.01,0.001\n";
        let rows: Result<Vec<MetricsRow>, _> = csv::Reader::from_reader(text.as_bytes()).deserialize().collect();
        let row = rows.unwrap().remove(0);
        assert_eq!((row.progress, row.dead_units.len()), (None, 0));
        assert_eq!(of_training(&[row.clone(), row.clone(), row]), []);
    }

    #[test]
    fn two_rows_are_too_few() {
        let row = MetricsRow { spinning: Some(1.0), ..healthy() };
        assert_eq!(of_training(&[row.clone(), row]), []);
    }

    #[test]
    fn the_watchdog_barks_once_for_each_kind() {
        let mut watchdog = Watchdog::default();
        let spins = MetricsRow { spinning: Some(1.0), ..healthy() };
        let both = MetricsRow { action_entropy: Some(0.0), ..spins.clone() };
        let kinds = |found: Vec<Collapse>| found.iter().map(Collapse::kind).collect::<Vec<_>>();
        assert_eq!(watchdog.push(spins.clone()), []);
        assert_eq!(watchdog.push(both.clone()), []);
        assert_eq!(kinds(watchdog.push(both.clone())), ["spinning"]);
        assert_eq!(kinds(watchdog.push(both)), ["one_action"]);
        assert_eq!(kinds(watchdog.push(spins.clone())), [] as [&str; 0]);
        assert_eq!(kinds(watchdog.verdict()), ["spinning"], "what is over is not the verdict");
        watchdog.push(healthy());
        assert_eq!(watchdog.push(spins), []);
        assert_eq!(watchdog.verdict(), []);
    }
}
