use crate::{Reward, RewardError, Transition};
use serde::{Deserialize, Serialize};

/// Progress: 1 per metre by which the distance to the goal decreases, so -1 per metre away from it.
///
/// Tag `progress`. With `speed_cap` it pays `min(d(s) - d(s'), speed_cap dt)`, d being
/// [`goal_distance`](crate::State::goal_distance): what is driven faster than the cap earns no more. The distance is
/// that of a straight line, which leads into dead ends as well as past obstacles. Without a cap it is the shaping by a
/// potential of Ng, Harada and Russell (1999) at gamma = 1: any two ways from s to s' earn the same, so circling earns
/// nothing.
///
/// ```
/// use headway_reward::{Progress, Reward, State, Transition};
///
/// let after = State { goal_distance: 4.7, ..State::default() };
/// let step = Transition { after, ..Transition::default() }; // from 5 m, in 0.2 s
/// assert!((Progress::default().reward(&step) - 0.3).abs() < 1e-12);
/// assert!((Progress { speed_cap: Some(1.0) }.reward(&step) - 0.2).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Progress {
    /// The speed towards the goal above which nothing more is paid, m/s; positive; no cap by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_cap: Option<f64>,
}

#[typetag::serde(name = "progress")]
impl Reward for Progress {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        match self.speed_cap {
            Some(cap) => t.progress().min(cap * t.dt),
            None => t.progress(),
        }
    }

    fn validate(&self) -> Result<(), RewardError> {
        let cap = self.speed_cap.unwrap_or(1.0);
        RewardError::require(cap.is_finite() && cap > 0.0, "speed_cap", cap, "positive and finite")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Event, State};

    fn pay(reward: &Progress, before: f64, after: f64) -> f64 {
        let at = |goal_distance| State { goal_distance, ..State::default() };
        reward.reward(&Transition {
            before: at(before),
            after: at(after),
            dt: 0.5,
            event: Some(Event::Reach), // an event changes nothing
            ..Transition::default()
        })
    }

    #[test]
    fn metres_by_hand() {
        assert_eq!(pay(&Progress::default(), 4.0, 3.25), 0.75);
        assert_eq!(pay(&Progress::default(), 3.25, 4.0), -0.75);
        assert_eq!(pay(&Progress::default(), 2.0, 2.0), 0.0);
    }

    #[test]
    fn the_cap_bounds_gain_but_not_loss() {
        let capped = Progress { speed_cap: Some(1.0) };
        assert_eq!(pay(&capped, 4.0, 3.25), 0.5);
        assert_eq!(pay(&capped, 4.0, 3.75), 0.25);
        assert_eq!(pay(&capped, 3.0, 4.0), -1.0);
    }

    #[test]
    fn validate_names_the_field() {
        let error = Progress { speed_cap: Some(0.0) }.validate().unwrap_err();
        assert_eq!(error.to_string(), "speed_cap = 0: must be positive and finite");
    }
}
