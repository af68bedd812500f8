use crate::{Event, Reward, RewardError, State, Transition};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_6, PI};

/// Steady speed: arrive, at no more than a desired speed, and brake only for what is in the way.
///
/// Tag `steady_speed`. A step of length dt pays the sum of
///
/// ```text
///   reach                                   if it reaches the goal
///   collision                               if it touches something
///   progress min(p, v_bar dt)               p: metres nearer to the goal, v_bar the desired speed
///   time dt                                 each second, on the way or not
///   proximity max(0, 1 - c / margin) dt     c: clearance after the step, m
///   overspeed max(0, v - v_bar)^2 dt        v: speed after the step, m/s
///   braking |dv|                            if dv/dt < -0.3 m/s^2 and nothing in the way asks for it
/// ```
///
/// Progress above v_bar pays nothing more, and overspeed costs: the best speed is v_bar. `braking` is charged where no beam
/// within 30 degrees of where it goes, behind it in reverse, is nearer than the stopping distance and `headway`, v^2 / (2 a) + headway, v
/// being the speed before the step and a the greatest deceleration: the definition of a needless deceleration, from
/// what the lidar reported. Without a lidar nothing is in the way. Every term counts per metre, second or m/s: a shorter control period
/// pays the same.
///
/// Nothing is paid for being alive, nor for being anywhere: whoever comes no nearer only loses, and in a circle progress
/// pays no more than it costs.
///
/// ```
/// use headway_reward::{Reward, State, SteadySpeed, Transition};
///
/// let cruise = State { speed: 1.2, ..State::default() };
/// let after = State { goal_distance: 4.76, ..cruise };
/// let step = Transition { before: cruise, after, ..Transition::default() };
/// let reward = SteadySpeed::default();
/// assert!((reward.reward(&step) - (40.0 * 0.24 - 2.5 * 0.2)).abs() < 1e-9);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SteadySpeed {
    /// The desired speed v_bar, m/s; positive.
    pub desired_speed: f64,
    /// Paid for reaching the goal.
    pub reach: f64,
    /// Paid for a collision.
    pub collision: f64,
    /// Paid per metre of progress, as far as the desired speed allows it.
    pub progress: f64,
    /// Paid per second.
    pub time: f64,
    /// Paid per second on contact, falling linearly to nothing at `margin`.
    pub proximity: f64,
    /// The clearance below which `proximity` counts, m; positive.
    pub margin: f64,
    /// Paid per second and (m/s)² above the desired speed.
    pub overspeed: f64,
    /// Paid per m/s of needless braking.
    pub braking: f64,
    /// The range beyond the stopping distance that makes braking needless, m.
    pub headway: f64,
}

impl Default for SteadySpeed {
    fn default() -> Self {
        Self {
            desired_speed: 1.2,
            reach: 100.0,
            collision: -50.0,
            progress: 40.0,
            time: -2.5,
            proximity: -25.0,
            margin: 0.2,
            overspeed: -100.0,
            braking: -30.0,
            headway: 0.6,
        }
    }
}

/// The acceleration below which a step brakes, m/s².
const BRAKES: f64 = -0.3;
/// How far from the driving direction something is in the way, rad.
const AHEAD: f64 = FRAC_PI_6;

impl SteadySpeed {
    /// What the step ended in.
    fn event(&self, event: Option<Event>) -> f64 {
        match event {
            Some(Event::Reach) => self.reach,
            Some(Event::Collision) => self.collision,
            None => 0.0,
        }
    }

    /// The speed that a step braked away although nothing was in the way, m/s.
    fn needless_braking(&self, t: &Transition<'_>) -> f64 {
        let (v, next) = (t.before.speed.abs(), t.after.speed.abs());
        let needs = v * v / (2.0 * t.limits.max_acceleration) + self.headway;
        if next - v < BRAKES * t.dt && range_ahead(&t.before) > needs { v - next } else { 0.0 }
    }
}

/// The nearest range within 30 degrees of where the vehicle goes, behind it in reverse, m; infinite without a beam there.
fn range_ahead(state: &State<'_>) -> f64 {
    let aside = |angle: &f64| if state.speed < 0.0 { PI - angle.abs() } else { angle.abs() };
    let ahead = state.beam_angles.iter().zip(state.scan).filter(|(angle, _)| aside(angle) <= AHEAD);
    ahead.fold(f64::INFINITY, |nearest, (_, range)| nearest.min(f64::from(*range)))
}

#[typetag::serde(name = "steady_speed")]
impl Reward for SteadySpeed {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        let progress = t.progress().min(self.desired_speed * t.dt);
        let depth = (1.0 - t.after.clearance / self.margin).max(0.0);
        let excess = (t.after.speed.abs() - self.desired_speed).max(0.0);
        self.event(t.event)
            + self.progress * progress
            + (self.time + self.proximity * depth + self.overspeed * excess * excess) * t.dt
            + self.braking * self.needless_braking(t)
    }

    fn validate(&self) -> Result<(), RewardError> {
        for (field, number) in [
            ("reach", self.reach),
            ("collision", self.collision),
            ("progress", self.progress),
            ("time", self.time),
            ("proximity", self.proximity),
            ("overspeed", self.overspeed),
            ("braking", self.braking),
        ] {
            RewardError::require_finite(field, number)?;
        }
        let (v, margin, headway) = (self.desired_speed, self.margin, self.headway);
        RewardError::require(v.is_finite() && v > 0.0, "desired_speed", v, "positive and finite")?;
        RewardError::require(margin.is_finite() && margin > 0.0, "margin", margin, "positive and finite")?;
        RewardError::require(headway.is_finite() && headway >= 0.0, "headway", headway, "finite and not negative")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_pays(step: &Transition<'_>, expected: f64) {
        let pay = SteadySpeed::default().reward(step);
        assert!((pay - expected).abs() < 1e-9, "{pay} is not {expected}");
    }

    /// A step of 0.2 s from one speed to another, `progress` metres nearer to the goal.
    fn step(speeds: [f64; 2], progress: f64) -> Transition<'static> {
        let before = State { speed: speeds[0], ..State::default() };
        let after = State { speed: speeds[1], goal_distance: 5.0 - progress, ..State::default() };
        Transition { before, after, ..Transition::default() }
    }

    #[test]
    fn progress_pays_up_to_the_desired_speed() {
        assert_pays(&step([0.0; 2], 0.0), -0.5);
        assert_pays(&step([1.0; 2], 0.2), 8.0 - 0.5);
        assert_pays(&step([1.2; 2], 0.24), 9.6 - 0.5);
        assert_pays(&step([1.2; 2], 0.30), 9.6 - 0.5);
        assert_pays(&step([1.0; 2], -0.2), -8.0 - 0.5);
    }

    #[test]
    fn overspeed_by_hand() {
        // 0.3 m/s too fast: -100 x 0.09 x 0.2.
        assert_pays(&step([1.5; 2], 0.30), 9.6 - 0.5 - 1.8);
    }

    #[test]
    fn events_add_to_the_step() {
        let reach = Transition { event: Some(Event::Reach), ..step([1.0; 2], 0.2) };
        let collision = Transition { event: Some(Event::Collision), ..step([1.0; 2], 0.2) };
        assert_pays(&reach, 107.5);
        assert_pays(&collision, -42.5);
    }

    #[test]
    fn proximity_by_hand() {
        let mut near = step([0.0; 2], 0.0);
        near.after.clearance = 0.05;
        assert_pays(&near, -0.5 - 25.0 * 0.75 * 0.2);
        near.after.clearance = 0.2;
        assert_pays(&near, -0.5);
    }

    #[test]
    fn braking_costs_where_nothing_is_in_the_way() {
        // From 1 m/s: 0.25 m to stop and 0.6 m more.
        let beam_angles = [-0.6, -0.5, 0.0, 0.5, 0.6];
        for (scan, cost) in [([0.1, 0.9, 0.9, 0.9, 0.1], 12.0), ([5.0, 5.0, 5.0, 0.84, 5.0], 0.0)] {
            let mut braking = step([1.0, 0.6], 0.1);
            (braking.before.scan, braking.before.beam_angles) = (&scan, &beam_angles);
            assert_pays(&braking, 4.0 - 0.5 - cost);
        }
        assert_pays(&step([1.0, 0.95], 0.1), 4.0 - 0.5); // -0.25 m/s^2: coasting
        assert_pays(&step([0.6, 1.0], 0.1), 4.0 - 0.5);
    }

    #[test]
    fn reverse_is_judged_by_its_size_and_by_what_is_behind() {
        assert_pays(&step([-1.5; 2], 0.0), -0.5 - 1.8);
        for (scan, cost) in [([0.1, 5.0], 12.0), ([5.0, 0.1], 0.0)] {
            let mut braking = step([-1.0, -0.6], 0.0);
            (braking.before.scan, braking.before.beam_angles) = (&scan, &[0.0, 3.0]);
            assert_pays(&braking, -0.5 - cost);
        }
    }

    #[test]
    fn a_shorter_period_pays_the_same() {
        let reward = SteadySpeed::default();
        let whole = step([1.4; 2], 0.2);
        let half = Transition { dt: 0.1, ..step([1.4; 2], 0.1) };
        assert!((reward.reward(&whole) - 2.0 * reward.reward(&half)).abs() < 1e-9);
    }

    #[test]
    fn validate_names_the_field() {
        let error = |reward: SteadySpeed| reward.validate().unwrap_err().to_string();
        let still = SteadySpeed { desired_speed: 0.0, ..SteadySpeed::default() };
        assert_eq!(error(still), "desired_speed = 0: must be positive and finite");
        let thin = SteadySpeed { margin: -0.2, ..SteadySpeed::default() };
        assert_eq!(error(thin), "margin = -0.2: must be positive and finite");
        let lost = SteadySpeed { braking: f64::NAN, ..SteadySpeed::default() };
        assert!(error(lost).starts_with("braking = NaN"));
    }
}
