//! The accumulator over an episode's control steps.

use super::{EpisodeRecord, Outcome};

/// Clearance below which the vehicle counts as near an obstacle, m.
pub const NEAR_CLEARANCE: f64 = 1.0;
/// Rate of change of speed below which a control step decelerates, m/s^2.
pub const DECELERATION_THRESHOLD: f64 = -0.3;
/// Distance beyond the stopping distance that a cone must be clear for braking to be needless, m.
pub const BRAKING_MARGIN: f64 = 0.6;

/// One control step, as the simulator sees it without noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Forward speed at the start of the step, m/s.
    pub speed_before: f64,
    /// Forward speed at the end of the step, m/s; in a step that ends in a collision the speed at contact, not zero: a
    /// wall that stops the vehicle is no deceleration of its driver.
    pub speed_after: f64,
    /// Length of the step, s, positive; the last step of an episode may be shorter than the others.
    pub dt: f64,
    /// Distance driven in the step, m.
    pub distance: f64,
    /// Distance from the footprint to the nearest obstacle or wall at the start of the step, m.
    pub clearance: f64,
    /// Distance from the vehicle's centre to the nearest obstacle or wall within 30 degrees of its heading at the start
    /// of the step, m, true and not as measured; infinite where there is none.
    pub free_range: f64,
}

/// The accumulator that turns the control steps of one episode into its [`EpisodeRecord`].
///
/// A *deceleration* is a maximal run of consecutive steps in which `dv/dt <` [`DECELERATION_THRESHOLD`], where `v` is the
/// magnitude of the forward speed. It is *needless* if in every one of its steps the cone ahead was clear beyond the
/// stopping distance and a margin, `free_range > v^2 / (2 a) + 0.6 m`, with `v` the speed at the start of the step and
/// `a` the greatest deceleration of the vehicle: braking that was called for at any moment is not needless.
///
/// The *mean absolute jerk* is `sum_k |a_k - a_(k-1)| / sum_k dt_k`, m/s^3, with `a_k` the mean acceleration of the forward
/// speed in step `k`, and `a_0 = 0` before the first step, in which a vehicle at rest starts. Where all steps are equally long it
/// is the mean of `|a_k - a_(k-1)| / dt`; a last step cut short by a collision weighs as much as it lasts.
///
/// A step belongs to the near time and distance if its clearance is below [`NEAR_CLEARANCE`].
///
/// ```
/// use headway_experiments::episode::{EpisodeMeter, Outcome, Sample};
///
/// let mut meter = EpisodeMeter::new(2.0);
/// let cruise =
///     Sample { speed_before: 1.0, speed_after: 1.0, dt: 0.2, distance: 0.2, clearance: 3.0, free_range: 5.0 };
/// meter.push(&cruise);
/// meter.push(&Sample { speed_after: 0.8, distance: 0.18, ..cruise }); // brakes with 5 m ahead
/// let record = meter.finish(0, Outcome::Timeout, 4.0);
/// assert_eq!((record.n_decelerations, record.n_needless_decelerations), (1, 1));
/// ```
#[derive(Debug, Clone)]
pub struct EpisodeMeter {
    max_deceleration: f64,
    duration: f64,
    distance: f64,
    near_time: f64,
    near_distance: f64,
    n_decelerations: u32,
    n_needless_decelerations: u32,
    braking: Braking,
    /// In the last step, m/s^2.
    acceleration: f64,
    /// The sum of the absolute changes of the acceleration, m/s^2.
    acceleration_changes: f64,
}

/// What the last step was part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Braking {
    No,
    /// A deceleration that was needless up to now.
    Needless,
    Needed,
}

impl EpisodeMeter {
    /// A meter at the start of an episode; `max_deceleration` of the vehicle in m/s^2, positive.
    pub fn new(max_deceleration: f64) -> Self {
        Self {
            max_deceleration,
            duration: 0.0,
            distance: 0.0,
            near_time: 0.0,
            near_distance: 0.0,
            n_decelerations: 0,
            n_needless_decelerations: 0,
            braking: Braking::No,
            acceleration: 0.0,
            acceleration_changes: 0.0,
        }
    }

    /// Adds the next control step.
    pub fn push(&mut self, sample: &Sample) {
        self.duration += sample.dt;
        self.distance += sample.distance;
        if sample.clearance < NEAR_CLEARANCE {
            self.near_time += sample.dt;
            self.near_distance += sample.distance;
        }
        // A step that a collision ends as it begins has no acceleration.
        if sample.dt > 0.0 {
            let acceleration = (sample.speed_after - sample.speed_before) / sample.dt;
            self.acceleration_changes += (acceleration - self.acceleration).abs();
            self.acceleration = acceleration;
        }
        let before = self.braking;
        self.braking = self.next_braking(sample);
        if self.braking != Braking::No && before == Braking::No {
            self.n_decelerations += 1;
        }
        if self.braking == Braking::No && before == Braking::Needless {
            self.n_needless_decelerations += 1;
        }
    }

    fn next_braking(&self, sample: &Sample) -> Braking {
        let (v, next) = (sample.speed_before.abs(), sample.speed_after.abs());
        if next - v >= DECELERATION_THRESHOLD * sample.dt {
            return Braking::No;
        }
        let stopping_distance = v * v / (2.0 * self.max_deceleration);
        if self.braking == Braking::Needed || sample.free_range <= stopping_distance + BRAKING_MARGIN {
            Braking::Needed
        } else {
            Braking::Needless
        }
    }

    /// The record of the episode that ends here; `geodesic` as in [`EpisodeRecord::geodesic`], m.
    pub fn finish(self, scenario: u64, outcome: Outcome, geodesic: f64) -> EpisodeRecord {
        EpisodeRecord {
            scenario,
            outcome,
            duration: self.duration,
            distance: self.distance,
            geodesic,
            spl: spl(outcome, self.distance, geodesic),
            near_time: self.near_time,
            near_distance: self.near_distance,
            n_decelerations: self.n_decelerations,
            n_needless_decelerations: self.n_needless_decelerations + u32::from(self.braking == Braking::Needless),
            mean_jerk: (self.duration > 0.0).then(|| self.acceleration_changes / self.duration),
            drawn: String::new(),
            n_shielded: 0,
            n_vetoes: 0,
            n_stops: 0,
        }
    }
}

/// `S L / max(P, L)`; a success that needed no path counts in full.
fn spl(outcome: Outcome, distance: f64, geodesic: f64) -> f64 {
    match outcome {
        Outcome::Success if geodesic > 0.0 => geodesic / distance.max(geodesic),
        Outcome::Success => 1.0,
        Outcome::Collision | Outcome::Timeout => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CRUISE: Sample =
        Sample { speed_before: 1.0, speed_after: 1.0, dt: 0.2, distance: 0.2, clearance: 2.0, free_range: 5.0 };

    fn speeds(meter: &mut EpisodeMeter, speeds: &[f64], free_range: f64) {
        for pair in speeds.windows(2) {
            meter.push(&Sample { speed_before: pair[0], speed_after: pair[1], free_range, ..CRUISE });
        }
    }

    fn counts(meter: EpisodeMeter) -> (u32, u32) {
        let record = meter.finish(0, Outcome::Success, 1.0);
        (record.n_decelerations, record.n_needless_decelerations)
    }

    #[test]
    fn sums_time_and_distance_and_splits_off_the_near_part() {
        let mut meter = EpisodeMeter::new(2.0);
        meter.push(&CRUISE);
        meter.push(&Sample { clearance: 1.0, distance: 0.25, ..CRUISE }); // the limit itself is not near
        meter.push(&Sample { clearance: 0.5, distance: 0.5, dt: 0.1, ..CRUISE });
        let record = meter.finish(7, Outcome::Collision, 3.0);
        assert_eq!(record.scenario, 7);
        assert!((record.duration - 0.5).abs() < 1e-12 && (record.distance - 0.95).abs() < 1e-12);
        assert_eq!((record.near_time, record.near_distance), (0.1, 0.5));
        assert_eq!((record.spl, record.geodesic), (0.0, 3.0));
    }

    #[test]
    fn a_deceleration_is_a_maximal_run_of_steps() {
        let mut meter = EpisodeMeter::new(2.0);
        // -2, -2 m/s^2 | 0 | -1 m/s^2 | +1 | -1 at the end of the episode: three runs.
        speeds(&mut meter, &[1.5, 1.1, 0.7, 0.7, 0.5, 0.7, 0.5], 0.1);
        assert_eq!(counts(meter), (3, 0));
    }

    #[test]
    fn losing_speed_at_the_threshold_is_no_deceleration() {
        let mut meter = EpisodeMeter::new(2.0);
        let step = |speed_after| Sample { speed_before: 0.0, speed_after, dt: 1.0, ..CRUISE };
        meter.push(&Sample { speed_before: 0.3, ..step(0.0) });
        assert_eq!(counts(meter.clone()), (0, 0));
        meter.push(&Sample { speed_before: 0.31, ..step(0.0) });
        assert_eq!(counts(meter), (1, 1));
    }

    #[test]
    fn needless_asks_for_a_clear_cone_beyond_the_stopping_distance() {
        // v = 1, a = 2: 0.25 m to stop, and the margin of 0.6 m.
        for (free_range, needless) in [(0.85, 0), (0.8501, 1), (f64::INFINITY, 1)] {
            let mut meter = EpisodeMeter::new(2.0);
            speeds(&mut meter, &[1.0, 0.8], free_range);
            assert_eq!(counts(meter), (1, needless), "free range {free_range}");
        }
    }

    #[test]
    fn one_blocked_step_makes_the_whole_deceleration_needed() {
        for blocked in 0..3 {
            let mut meter = EpisodeMeter::new(2.0);
            for (step, speed) in [1.5, 1.1, 0.7].into_iter().enumerate() {
                let free_range = if step == blocked { 0.1 } else { 9.0 };
                meter.push(&Sample { speed_before: speed, speed_after: speed - 0.4, free_range, ..CRUISE });
            }
            speeds(&mut meter, &[0.3, 0.5], 9.0);
            speeds(&mut meter, &[0.5, 0.3], 9.0); // the next one is judged afresh
            assert_eq!(counts(meter), (2, 1), "blocked in step {blocked}");
        }
    }

    #[test]
    fn reversing_slower_is_a_deceleration_too() {
        let mut meter = EpisodeMeter::new(2.0);
        speeds(&mut meter, &[-0.2, -0.6, -0.2], 0.1);
        assert_eq!(counts(meter), (1, 0));
    }

    #[test]
    fn jerk_is_the_mean_absolute_change_of_the_acceleration() {
        let jerk_of = |path: &[f64]| {
            let mut meter = EpisodeMeter::new(2.0);
            speeds(&mut meter, path, 5.0);
            meter.finish(0, Outcome::Timeout, 1.0).mean_jerk.unwrap()
        };
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} is not {b}");
        close(jerk_of(&[1.0, 1.0, 1.0]), 0.0);
        // a = 2, 2 m/s^2: one jump from 0 to 2 in 0.4 s.
        close(jerk_of(&[0.0, 0.4, 0.8]), 5.0);
        // a = 2, 0, -1, 1 m/s^2: changes of 2, 2, 1 and 2 in 0.8 s.
        close(jerk_of(&[0.0, 0.4, 0.4, 0.2, 0.4]), 8.75);
        // Reversing counts by its sign: a = -2, then 2.
        close(jerk_of(&[0.0, -0.4, 0.0]), 15.0);
        assert_eq!(EpisodeMeter::new(2.0).finish(0, Outcome::Timeout, 1.0).mean_jerk, None);
    }

    #[test]
    fn a_step_cut_short_by_a_collision_does_not_blow_up_the_jerk() {
        let mut meter = EpisodeMeter::new(2.0);
        speeds(&mut meter, &[1.0, 1.0, 1.0, 1.0, 1.0], 5.0);
        meter.push(&Sample { speed_before: 1.0, speed_after: 0.998, dt: 0.001, ..CRUISE }); // brakes at 2 m/s^2
        let jerk = meter.finish(0, Outcome::Collision, 1.0).mean_jerk.unwrap();
        assert!((jerk - 2.0 / 0.801).abs() < 1e-9, "{jerk}");
    }

    #[test]
    fn a_step_of_no_time_adds_no_jerk() {
        for speed_after in [1.0, 0.9] {
            let mut meter = EpisodeMeter::new(2.0);
            speeds(&mut meter, &[1.0, 1.0, 1.0], 5.0);
            meter.push(&Sample { speed_before: 1.0, speed_after, dt: 0.0, distance: 0.0, ..CRUISE });
            assert_eq!(meter.finish(0, Outcome::Collision, 1.0).mean_jerk, Some(0.0));
        }
    }

    #[test]
    fn spl_weighs_success_by_path_length() {
        let spl_after = |outcome, distance: f64, geodesic| {
            let mut meter = EpisodeMeter::new(2.0);
            meter.push(&Sample { distance, ..CRUISE });
            meter.finish(0, outcome, geodesic).spl
        };
        assert_eq!(spl_after(Outcome::Success, 8.0, 6.0), 0.75);
        assert_eq!(spl_after(Outcome::Success, 5.9, 6.0), 1.0); // a planned path may be longer than the driven one
        assert_eq!(spl_after(Outcome::Timeout, 8.0, 6.0), 0.0);
        assert_eq!(spl_after(Outcome::Success, 0.0, 0.0), 1.0);
    }
}
