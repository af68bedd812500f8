//! The metrics of one trained policy over its evaluation episodes.

use super::{EpisodeRecord, Outcome};

/// The metrics of one seed's policy over its evaluation episodes; `None` where a metric is undefined.
///
/// Speeds are ratios of sums (all the distance over all the time), so that long episodes weigh as much as they last.
///
/// ```
/// use headway_experiments::episode::{EpisodeMeter, Outcome, Sample, SeedSummary};
///
/// let step = Sample { speed_before: 1.0, speed_after: 1.0, dt: 0.2, distance: 0.2, clearance: 3.0, free_range: 5.0 };
/// let mut meter = EpisodeMeter::new(2.0);
/// meter.push(&step);
/// let summary = SeedSummary::of(&[meter.finish(0, Outcome::Timeout, 4.0)]);
/// assert_eq!((summary.timeout, summary.mean_speed), (Some(1.0), Some(1.0)));
/// assert_eq!(summary.speed_in_successes, None); // there was none
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeedSummary {
    /// Number of episodes.
    pub n_episodes: usize,
    /// Share of episodes that reached the goal, in [0, 1].
    pub success: Option<f64>,
    /// Share of episodes that ended in a collision, in [0, 1].
    pub collision: Option<f64>,
    /// Share of episodes that ran out of time, in [0, 1].
    pub timeout: Option<f64>,
    /// Total distance over total time of all episodes, failures included, m/s.
    pub mean_speed: Option<f64>,
    /// Total distance over total time of the successful episodes, m/s.
    pub speed_in_successes: Option<f64>,
    /// Total distance over total time with a clearance below 1 m, m/s.
    pub speed_near_obstacles: Option<f64>,
    /// Decelerations per distance driven in all episodes, 1/m.
    pub decelerations_per_m: Option<f64>,
    /// Needless decelerations per distance driven in all episodes, 1/m.
    pub needless_decelerations_per_m: Option<f64>,
    /// Mean success weighted by path length, in [0, 1].
    pub spl: Option<f64>,
    /// Mean absolute jerk of the forward speed over the time of all episodes, m/s^3; undefined if any lacks it.
    pub mean_jerk: Option<f64>,
    /// Share of all commands that a shield did not pass on as they were, in [0, 1]; undefined without a shield.
    pub vetoes: Option<f64>,
    /// Share of all commands in whose place a shield braked, in [0, 1]; undefined without a shield.
    pub stops: Option<f64>,
}

impl SeedSummary {
    /// The summary of one policy's episodes.
    pub fn of(episodes: &[EpisodeRecord]) -> Self {
        let total = |value: fn(&EpisodeRecord) -> f64| episodes.iter().map(value).sum::<f64>();
        let n = episodes.len() as f64;
        let share = |outcome| ratio(episodes.iter().filter(|e| e.outcome == outcome).count() as f64, n);
        let distance = total(|e| e.distance);
        let n_shielded = total(|e| e.n_shielded as f64);
        Self {
            n_episodes: episodes.len(),
            success: share(Outcome::Success),
            collision: share(Outcome::Collision),
            timeout: share(Outcome::Timeout),
            mean_speed: ratio(distance, total(|e| e.duration)),
            speed_in_successes: ratio(
                total(|e| if e.outcome == Outcome::Success { e.distance } else { 0.0 }),
                total(|e| if e.outcome == Outcome::Success { e.duration } else { 0.0 }),
            ),
            speed_near_obstacles: ratio(total(|e| e.near_distance), total(|e| e.near_time)),
            decelerations_per_m: ratio(total(|e| f64::from(e.n_decelerations)), distance),
            needless_decelerations_per_m: ratio(total(|e| f64::from(e.n_needless_decelerations)), distance),
            spl: ratio(total(|e| e.spl), n),
            mean_jerk: mean_jerk(episodes),
            vetoes: ratio(total(|e| e.n_vetoes as f64), n_shielded),
            stops: ratio(total(|e| e.n_stops as f64), n_shielded),
        }
    }
}

/// The jerk of each episode, weighted by how long it lasted.
fn mean_jerk(episodes: &[EpisodeRecord]) -> Option<f64> {
    let changes: Option<f64> = episodes.iter().map(|e| Some(e.mean_jerk? * e.duration)).sum();
    ratio(changes?, episodes.iter().map(|e| e.duration).sum())
}

/// `a / b`, undefined for `b = 0`.
fn ratio(a: f64, b: f64) -> Option<f64> {
    (b > 0.0).then(|| a / b)
}

/// One metric of a [`SeedSummary`], by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Metric {
    /// [`SeedSummary::success`].
    Success,
    /// [`SeedSummary::collision`].
    Collision,
    /// [`SeedSummary::timeout`].
    Timeout,
    /// [`SeedSummary::mean_speed`].
    MeanSpeed,
    /// [`SeedSummary::speed_in_successes`].
    SpeedInSuccesses,
    /// [`SeedSummary::speed_near_obstacles`].
    SpeedNearObstacles,
    /// [`SeedSummary::decelerations_per_m`].
    DecelerationsPerM,
    /// [`SeedSummary::needless_decelerations_per_m`].
    NeedlessDecelerationsPerM,
    /// [`SeedSummary::spl`].
    Spl,
    /// [`SeedSummary::mean_jerk`].
    MeanJerk,
    /// [`SeedSummary::vetoes`].
    Vetoes,
    /// [`SeedSummary::stops`].
    Stops,
}

/// The kind of quantity that a [`Metric`] is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// A share of episodes or of commands, in [0, 1].
    Rate,
    /// A speed, m/s.
    Speed,
    /// A count per distance, 1/m.
    PerMetre,
    /// A change of acceleration, m/s^3.
    Jerk,
    /// A score in [0, 1] without a unit.
    Score,
}

impl Metric {
    /// Every metric, in the order of reports.
    pub const ALL: [Self; 12] = [
        Self::Success,
        Self::Collision,
        Self::Timeout,
        Self::MeanSpeed,
        Self::SpeedInSuccesses,
        Self::SpeedNearObstacles,
        Self::DecelerationsPerM,
        Self::NeedlessDecelerationsPerM,
        Self::Spl,
        Self::MeanJerk,
        Self::Vetoes,
        Self::Stops,
    ];

    /// The name in JSON and CSV reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Success => "success",
            Self::Collision => "collision",
            Self::Timeout => "timeout",
            Self::MeanSpeed => "mean_speed",
            Self::SpeedInSuccesses => "speed_in_successes",
            Self::SpeedNearObstacles => "speed_near_obstacles",
            Self::DecelerationsPerM => "decelerations_per_m",
            Self::NeedlessDecelerationsPerM => "needless_decelerations_per_m",
            Self::Spl => "spl",
            Self::MeanJerk => "mean_jerk",
            Self::Vetoes => "vetoes",
            Self::Stops => "stops",
        }
    }

    /// The kind of quantity.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Success | Self::Collision | Self::Timeout | Self::Vetoes | Self::Stops => Quantity::Rate,
            Self::MeanSpeed | Self::SpeedInSuccesses | Self::SpeedNearObstacles => Quantity::Speed,
            Self::DecelerationsPerM | Self::NeedlessDecelerationsPerM => Quantity::PerMetre,
            Self::MeanJerk => Quantity::Jerk,
            Self::Spl => Quantity::Score,
        }
    }

    /// Whether it tells of a shield, and so says nothing without one.
    pub fn is_of_shield(self) -> bool {
        matches!(self, Self::Vetoes | Self::Stops)
    }

    /// The metric that is the share of an outcome.
    pub fn share_of(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Success => Self::Success,
            Outcome::Collision => Self::Collision,
            Outcome::Timeout => Self::Timeout,
        }
    }

    /// The outcome whose share of the episodes this metric is, if it is one.
    pub fn outcome(self) -> Option<Outcome> {
        match self {
            Self::Success => Some(Outcome::Success),
            Self::Collision => Some(Outcome::Collision),
            Self::Timeout => Some(Outcome::Timeout),
            _ => None,
        }
    }

    /// The value in a summary.
    pub fn of(self, summary: &SeedSummary) -> Option<f64> {
        match self {
            Self::Success => summary.success,
            Self::Collision => summary.collision,
            Self::Timeout => summary.timeout,
            Self::MeanSpeed => summary.mean_speed,
            Self::SpeedInSuccesses => summary.speed_in_successes,
            Self::SpeedNearObstacles => summary.speed_near_obstacles,
            Self::DecelerationsPerM => summary.decelerations_per_m,
            Self::NeedlessDecelerationsPerM => summary.needless_decelerations_per_m,
            Self::Spl => summary.spl,
            Self::MeanJerk => summary.mean_jerk,
            Self::Vetoes => summary.vetoes,
            Self::Stops => summary.stops,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn episode(outcome: Outcome, duration: f64, distance: f64) -> EpisodeRecord {
        EpisodeRecord {
            scenario: 0,
            outcome,
            duration,
            distance,
            geodesic: 4.0,
            spl: if outcome == Outcome::Success { 0.8 } else { 0.0 },
            near_time: 1.0,
            near_distance: 0.5,
            n_decelerations: 3,
            n_needless_decelerations: 1,
            mean_jerk: Some(2.0),
            drawn: String::new(),
            n_shielded: 0,
            n_vetoes: 0,
            n_stops: 0,
        }
    }

    #[test]
    fn worked_by_hand() {
        let summary = SeedSummary::of(&[
            episode(Outcome::Success, 5.0, 5.0),
            episode(Outcome::Success, 3.0, 5.0),
            episode(Outcome::Collision, 2.0, 1.0),
            episode(Outcome::Timeout, 10.0, 1.0),
        ]);
        assert_eq!(summary.n_episodes, 4);
        assert_eq!((summary.success, summary.collision, summary.timeout), (Some(0.5), Some(0.25), Some(0.25)));
        assert_eq!(summary.mean_speed, Some(12.0 / 20.0));
        assert_eq!(summary.speed_in_successes, Some(10.0 / 8.0));
        assert_eq!(summary.speed_near_obstacles, Some(0.5));
        assert_eq!(summary.decelerations_per_m, Some(1.0));
        assert_eq!(summary.needless_decelerations_per_m, Some(4.0 / 12.0));
        assert_eq!(summary.spl, Some(0.4));
    }

    #[test]
    fn jerk_weighs_episodes_by_their_time() {
        let jerk = |mean_jerk, duration| EpisodeRecord { mean_jerk, ..episode(Outcome::Success, duration, 5.0) };
        assert_eq!(SeedSummary::of(&[jerk(Some(1.0), 9.0), jerk(Some(3.0), 3.0)]).mean_jerk, Some(1.5));
        assert_eq!(SeedSummary::of(&[jerk(Some(1.0), 9.0), jerk(None, 3.0)]).mean_jerk, None);
    }

    #[test]
    fn interventions_are_shares_of_all_commands() {
        let shielded = |n_shielded, n_vetoes, n_stops| EpisodeRecord {
            n_shielded,
            n_vetoes,
            n_stops,
            ..episode(Outcome::Success, 5.0, 5.0)
        };
        let summary = SeedSummary::of(&[shielded(10, 4, 1), shielded(30, 6, 0)]);
        assert_eq!((summary.vetoes, summary.stops), (Some(0.25), Some(0.025)));
        assert_eq!(SeedSummary::of(&[shielded(0, 0, 0)]).vetoes, None);
    }

    #[test]
    fn what_cannot_be_measured_is_none() {
        let stuck = EpisodeRecord { near_time: 0.0, near_distance: 0.0, ..episode(Outcome::Timeout, 30.0, 0.0) };
        let summary = SeedSummary::of(&[stuck]);
        assert_eq!((summary.success, summary.mean_speed), (Some(0.0), Some(0.0)));
        assert_eq!(summary.speed_in_successes, None);
        assert_eq!(summary.speed_near_obstacles, None);
        assert_eq!(summary.decelerations_per_m, None); // it never moved
        for metric in Metric::ALL {
            assert_eq!(metric.of(&SeedSummary::of(&[])), None, "{}", metric.name());
        }
    }
}
