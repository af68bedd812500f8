use headway_reward::{Event, Reward, RewardError, State, Transition};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_6, PI};

/// Needless braking: the deceleration of a vehicle that brakes although the way ahead is clear, in m/s².
///
/// Tag `smooth/needless_braking`. "Frequent deceleration when approaching obstacles" is the fault that Liu et al. set
/// out to cure. Their R_couple pays for a speed and thereby asks for little braking; this reward measures the braking
/// itself. With v and the lidar scan of the state before the step, and a = (v' - v) / dt,
///
/// ```text
/// pays -a   if a < -min_deceleration and every beam within +-half_angle is longer than v^2 / (2 a_max) + margin
///       0   otherwise
/// ```
///
/// where a_max is the vehicle's own limit: what lies beyond the stopping distance can still be braked for later. Without
/// a beam in the cone nothing is known to be clear and nothing is paid; nor is it for the jolt of a collision. It pays
/// the fault, so give it a *negative weight* in a `sum`. It sees a cone, not the vehicle's track: braking in order to
/// turn into a gap beside the cone is paid too, so keep the weight small against that of progress.
///
/// ```
/// use headway_reward::{Reward, State, Transition};
/// use smooth_rewards::NeedlessBraking;
///
/// let before = State { speed: 1.0, scan: &[4.0], beam_angles: &[0.0], ..State::default() };
/// let after = State { speed: 0.8, ..before };
/// let step = Transition { before, after, dt: 0.2, ..Transition::default() };
/// // 1 m/s² of braking, and 4 m are more than the 1 / (2 x 2) m to stop in, plus 0.6 m.
/// assert!((NeedlessBraking::default().reward(&step) - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NeedlessBraking {
    /// The deceleration up to which slowing down is free, m/s²; not negative; 0.3 by default.
    pub min_deceleration: f64,
    /// Half the opening angle of the cone that has to be clear, rad, in [0, pi]; pi/6 (30 degrees) by default.
    pub half_angle: f64,
    /// What has to be clear beyond the stopping distance, m from the lidar, so the vehicle's own front included; not
    /// negative; 0.6 by default.
    pub margin: f64,
}

impl Default for NeedlessBraking {
    /// Slowing by more than 0.3 m/s² while 60 degrees ahead are clear for 0.6 m beyond the stopping distance.
    fn default() -> Self {
        Self { min_deceleration: 0.3, half_angle: FRAC_PI_6, margin: 0.6 }
    }
}

impl NeedlessBraking {
    /// Whether some beam looks into the cone, and all that do are longer than `distance`.
    fn is_clear(&self, state: &State<'_>, distance: f64) -> bool {
        let mut ahead = state
            .beam_angles
            .iter()
            .zip(state.scan)
            .filter(|(angle, _)| angle.abs() <= self.half_angle)
            .map(|(_, &range)| f64::from(range))
            .peekable();
        ahead.peek().is_some() && ahead.all(|range| range > distance)
    }
}

#[typetag::serde(name = "smooth/needless_braking")]
impl Reward for NeedlessBraking {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        let deceleration = -t.acceleration();
        if deceleration <= self.min_deceleration || t.event == Some(Event::Collision) {
            return 0.0;
        }
        let stopping_distance = t.before.speed.powi(2) / (2.0 * t.limits.max_acceleration);
        if self.is_clear(&t.before, stopping_distance + self.margin) { deceleration } else { 0.0 }
    }

    fn validate(&self) -> Result<(), RewardError> {
        for (field, value) in [("min_deceleration", self.min_deceleration), ("margin", self.margin)] {
            let ok = value.is_finite() && value >= 0.0;
            RewardError::require(ok, field, value, "finite and not negative")?;
        }
        let angle = self.half_angle;
        RewardError::require((0.0..=PI).contains(&angle), "half_angle", angle, "in [0, pi] rad")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headway_reward::testing;

    const BEAM_ANGLES: [f64; 5] = [-1.0, -FRAC_PI_6, 0.0, FRAC_PI_6, 1.0];
    const CLEAR: [f32; 5] = [5.0; 5];

    /// From 1.5 m/s to `speed` in 0.5 s under `scan`. Stopping takes 1.5² / (2 x 2) = 0.5625 m, so 1.1625 m have to be
    /// clear.
    fn slow_to(speed: f64, scan: &[f32; 5], event: Option<Event>) -> f64 {
        let before = State { speed: 1.5, scan, beam_angles: &BEAM_ANGLES, ..State::default() };
        let after = State { speed, ..before };
        NeedlessBraking::default().reward(&Transition { before, after, dt: 0.5, event, ..Transition::default() })
    }

    #[test]
    fn keeps_every_promise_of_a_reward() {
        assert_eq!(testing::check(&NeedlessBraking::default()), Ok(()));
    }

    #[test]
    fn pays_the_deceleration_when_clear() {
        assert_eq!(slow_to(1.0, &CLEAR, None), 1.0);
        assert_eq!(slow_to(0.5, &CLEAR, None), 2.0);
        assert_eq!(slow_to(0.5, &CLEAR, Some(Event::Reach)), 2.0);
    }

    #[test]
    fn driving_on_and_slowing_gently_are_free() {
        for speed in [2.0, 1.5, 1.4] {
            assert_eq!(slow_to(speed, &CLEAR, None), 0.0);
        }
    }

    #[test]
    fn braking_is_needed_when_the_cone_is_blocked_to_its_rim() {
        assert_eq!(slow_to(1.0, &[5.0, 5.0, 1.16, 5.0, 5.0], None), 0.0);
        assert_eq!(slow_to(1.0, &[5.0, 1.16, 5.0, 5.0, 5.0], None), 0.0);
        assert_eq!(slow_to(1.0, &[5.0, 5.0, 1.17, 5.0, 5.0], None), 1.0);
        assert_eq!(slow_to(1.0, &[0.3, 5.0, 5.0, 5.0, 0.3], None), 1.0);
    }

    #[test]
    fn a_collision_is_no_braking() {
        assert_eq!(slow_to(0.0, &CLEAR, Some(Event::Collision)), 0.0);
    }

    #[test]
    fn nothing_is_clear_where_nothing_is_seen() {
        let before = State { speed: 1.5, ..State::default() };
        let blind = Transition { before, ..Transition::default() };
        assert_eq!(NeedlessBraking::default().reward(&blind), 0.0);
    }

    #[test]
    fn validate_names_the_field() {
        let wide = NeedlessBraking { half_angle: 30.0, ..NeedlessBraking::default() };
        assert_eq!(wide.validate().unwrap_err().to_string(), "half_angle = 30: must be in [0, pi] rad");
    }
}
