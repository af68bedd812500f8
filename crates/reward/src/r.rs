use crate::{Event, Reward, RewardError, Transition};
use serde::{Deserialize, Serialize};

/// R, the plain reward of Liu et al., eq. (4), "a similar reward function" of earlier work:
///
/// ```text
///     |   10   no collision
/// R = | -100   collision
///     |  100   reach
/// ```
///
/// Tag `r`. The first branch pays every step that ends in neither event. Mind what that means: at a discount gamma
/// merely living is worth 10 / (1 - gamma), 200 at 0.95 and 1000 at 0.99, and thus more than the 100 of arriving. Where
/// reaching the goal ends the episode, R rewards not to arrive.
///
/// ```
/// use headway_reward::{Event, R, Reward, Transition};
///
/// let step = Transition::default();
/// assert_eq!(R::default().reward(&step), 10.0);
/// assert_eq!(R::default().reward(&Transition { event: Some(Event::Reach), ..step }), 100.0);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct R {
    /// Paid for a step without event; 10 in the paper.
    pub no_collision: f64,
    /// Paid for a collision; -100 in the paper.
    pub collision: f64,
    /// Paid for reaching the goal; 100 in the paper.
    pub reach: f64,
}

impl Default for R {
    /// The paper's numbers.
    fn default() -> Self {
        Self { no_collision: 10.0, collision: -100.0, reach: 100.0 }
    }
}

#[typetag::serde(name = "r")]
impl Reward for R {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        match t.event {
            None => self.no_collision,
            Some(Event::Collision) => self.collision,
            Some(Event::Reach) => self.reach,
        }
    }

    fn validate(&self) -> Result<(), RewardError> {
        RewardError::require_finite("no_collision", self.no_collision)?;
        RewardError::require_finite("collision", self.collision)?;
        RewardError::require_finite("reach", self.reach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pay(event: Option<Event>) -> f64 {
        R::default().reward(&Transition { event, ..Transition::default() })
    }

    #[test]
    fn equation_4_by_hand() {
        assert_eq!(pay(None), 10.0);
        assert_eq!(pay(Some(Event::Collision)), -100.0);
        assert_eq!(pay(Some(Event::Reach)), 100.0);
    }

    #[test]
    fn validate_names_the_field() {
        let reward = R { reach: f64::NAN, ..R::default() };
        assert_eq!(reward.validate().unwrap_err().to_string(), "reach = NaN: must be finite");
    }
}
