use crate::{Event, Reward, RewardError, State, Transition};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_6, PI};

/// R_couple, the reward of Liu et al., eq. (5), which couples the speed to the angle of the nearest obstacle:
///
/// ```text
///            | -100             if hit
/// R_couple = | 20 (1 + g(v))    elif angle > 30 deg
///            | 10 (1 + g(v))    elif angle <= 30 deg
///            | 10               else                       g(v) = exp(-(v - v_bar)^2 / 2),   v_bar = 1.2 m/s
/// ```
///
/// Tag `r_couple`. v and the angle are those at the end of the step (`after`), the angle that of Fig. 1 of the paper
/// ([`State::obstacle_angle`]). What the equation leaves open is read so:
/// - The angle is above or not above 30 degrees whenever there is one, so "else" can only mean that there is none:
///   no obstacle near. The threshold itself counts as in front.
/// - There is no branch for reaching the goal. Arriving pays like any other step, and another reward has to make the
///   vehicle go there (see [`Sum`](crate::Sum)).
///
/// Mind what it asks for. The factor of two between side and front outweighs the speed: g is flat, g(0) = 0.487 and
/// g(0.9) = 0.956. The best place to be is beside an obstacle, at 40 a step, and in the open any speed pays 10.
///
/// ```
/// use headway_reward::{RCouple, Reward, State, Transition};
///
/// let after = State { speed: 1.2, obstacle_angle: Some(1.0), ..State::default() };
/// let step = Transition { after, ..Transition::default() };
/// assert_eq!(RCouple::default().reward(&step), 40.0); // 20 (1 + g(v_bar))
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RCouple {
    /// The desired speed v_bar, m/s; 1.2 in the paper.
    pub desired_speed: f64,
    /// Paid for a collision; -100 in the paper.
    pub collision: f64,
    /// The factor of 1 + g when the obstacle lies to the side; 20 in the paper.
    pub side: f64,
    /// The factor of 1 + g when the obstacle lies in front; 10 in the paper.
    pub front: f64,
    /// Paid when there is no obstacle near; 10 in the paper.
    pub otherwise: f64,
    /// The largest angle that counts as in front, rad, in [0, pi]; pi/6 (30 degrees) in the paper.
    pub angle_threshold: f64,
    /// What divides (v - v_bar)^2 in g, (m/s)²; positive; 2 in the paper.
    pub speed_width: f64,
}

impl Default for RCouple {
    /// The paper's numbers.
    fn default() -> Self {
        Self {
            desired_speed: 1.2,
            collision: -100.0,
            side: 20.0,
            front: 10.0,
            otherwise: 10.0,
            angle_threshold: FRAC_PI_6,
            speed_width: 2.0,
        }
    }
}

impl RCouple {
    /// The branches of eq. (5) for a vehicle that has not hit anything.
    fn driving(&self, after: &State<'_>) -> f64 {
        match after.obstacle_angle {
            Some(angle) if angle > self.angle_threshold => self.side * (1.0 + self.g(after.speed)),
            Some(_) => self.front * (1.0 + self.g(after.speed)),
            None => self.otherwise,
        }
    }

    /// How close `speed` is to the desired one, in [0, 1].
    fn g(&self, speed: f64) -> f64 {
        (-(speed - self.desired_speed).powi(2) / self.speed_width).exp()
    }
}

#[typetag::serde(name = "r_couple")]
impl Reward for RCouple {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        match t.event {
            Some(Event::Collision) => self.collision,
            Some(Event::Reach) | None => self.driving(&t.after),
        }
    }

    fn validate(&self) -> Result<(), RewardError> {
        RewardError::require_finite("desired_speed", self.desired_speed)?;
        RewardError::require_finite("collision", self.collision)?;
        RewardError::require_finite("side", self.side)?;
        RewardError::require_finite("front", self.front)?;
        RewardError::require_finite("otherwise", self.otherwise)?;
        let (angle, width) = (self.angle_threshold, self.speed_width);
        RewardError::require((0.0..=PI).contains(&angle), "angle_threshold", angle, "in [0, pi] rad")?;
        RewardError::require(width.is_finite() && width > 0.0, "speed_width", width, "positive and finite")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pay(speed: f64, obstacle_angle: Option<f64>, event: Option<Event>) -> f64 {
        let after = State { speed, obstacle_angle, ..State::default() };
        RCouple::default().reward(&Transition { after, event, ..Transition::default() })
    }

    fn assert_close(value: f64, expected: f64) {
        assert!((value - expected).abs() < 5e-4, "{value} is not {expected}");
    }

    #[test]
    fn equation_5_by_hand() {
        // At v_bar g = 1; at rest g = exp(-1.44 / 2) = exp(-0.72) = 0.48675; at 2.2 m/s g = exp(-0.5) = 0.60653.
        assert_eq!(pay(1.2, Some(PI / 2.0), None), 40.0);
        assert_close(pay(0.0, Some(PI / 2.0), None), 29.7350);
        assert_close(pay(2.2, Some(PI / 2.0), None), 32.1306);
        assert_eq!(pay(1.2, Some(0.2), None), 20.0);
        assert_close(pay(0.0, Some(0.2), None), 14.8675);
        assert_eq!(pay(1.2, None, None), 10.0);
        assert_eq!(pay(0.0, None, None), 10.0);
    }

    #[test]
    fn a_hit_pays_the_same_at_any_speed_and_angle() {
        for angle in [None, Some(0.0), Some(PI)] {
            assert_eq!(pay(0.0, angle, Some(Event::Collision)), -100.0);
            assert_eq!(pay(1.2, angle, Some(Event::Collision)), -100.0);
        }
    }

    #[test]
    fn the_threshold_itself_is_in_front() {
        assert_eq!(pay(1.2, Some(FRAC_PI_6), None), 20.0);
        assert_eq!(pay(1.2, Some(FRAC_PI_6.next_up()), None), 40.0);
        assert_eq!(pay(1.2, Some(0.0), None), 20.0);
    }

    #[test]
    fn there_is_no_reach_branch() {
        for angle in [None, Some(0.1), Some(2.0)] {
            assert_eq!(pay(0.7, angle, Some(Event::Reach)), pay(0.7, angle, None));
        }
    }

    #[test]
    fn only_the_state_after_the_step_counts() {
        let busy = State { speed: 1.2, obstacle_angle: Some(2.0), ..State::default() };
        let step = Transition { before: busy, ..Transition::default() };
        assert_eq!(RCouple::default().reward(&step), 10.0);
    }

    #[test]
    fn every_constant_is_a_field() {
        let reward = RCouple {
            desired_speed: 0.5,
            collision: -1.0,
            side: 2.0,
            front: 3.0,
            otherwise: 4.0,
            angle_threshold: 1.0,
            speed_width: 0.25,
        };
        let pay = |obstacle_angle, event| {
            let after = State { speed: 1.0, obstacle_angle, ..State::default() };
            reward.reward(&Transition { after, event, ..Transition::default() })
        };
        // g = exp(-0.25 / 0.25) = 0.36788
        assert_eq!(pay(Some(0.9), Some(Event::Collision)), -1.0);
        assert_close(pay(Some(1.1), None), 2.73576);
        assert_close(pay(Some(0.9), None), 4.10364);
        assert_eq!(pay(None, None), 4.0);
    }

    #[test]
    fn validate_names_the_field() {
        let error = |reward: RCouple| reward.validate().unwrap_err().to_string();
        let flat = RCouple { speed_width: 0.0, ..RCouple::default() };
        let degrees = RCouple { angle_threshold: 30.0, ..RCouple::default() };
        assert_eq!(error(flat), "speed_width = 0: must be positive and finite");
        assert_eq!(error(degrees), "angle_threshold = 30: must be in [0, pi] rad");
    }
}
