use crate::{Reward, RewardError, Transition};
use serde::{Deserialize, Serialize};

/// Proximity: how deep the vehicle is inside a safety margin, 0 at its rim and beyond, 1 on contact.
///
/// Tag `proximity`. Pays `max(0, 1 - c / margin)` per step, c being the clearance after the step; above 1 where the
/// footprint overlaps an obstacle, as it may at a collision. A negative weight in a [`Sum`](crate::Sum) makes it a
/// penalty.
///
/// ```
/// use headway_reward::{Proximity, Reward, State, Transition};
///
/// let after = State { clearance: 0.05, ..State::default() };
/// let step = Transition { after, ..Transition::default() };
/// assert_eq!(Proximity { margin: 0.2 }.reward(&step), 0.75);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Proximity {
    /// The clearance below which something is paid, m; positive; 0.2 by default.
    pub margin: f64,
}

impl Default for Proximity {
    /// A margin of 0.2 m.
    fn default() -> Self {
        Self { margin: 0.2 }
    }
}

#[typetag::serde(name = "proximity")]
impl Reward for Proximity {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        (1.0 - t.after.clearance / self.margin).max(0.0)
    }

    fn validate(&self) -> Result<(), RewardError> {
        let margin = self.margin;
        RewardError::require(margin.is_finite() && margin > 0.0, "margin", margin, "positive and finite")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::State;

    fn pay(clearance: f64) -> f64 {
        let after = State { clearance, ..State::default() };
        Proximity { margin: 0.5 }.reward(&Transition { after, ..Transition::default() })
    }

    #[test]
    fn clearances_by_hand() {
        assert_eq!(pay(0.125), 0.75);
        assert_eq!(pay(0.0), 1.0);
        assert_eq!(pay(-0.25), 1.5);
    }

    #[test]
    fn nothing_at_the_rim_and_beyond() {
        assert_eq!(pay(0.5), 0.0);
        assert_eq!(pay(7.0), 0.0);
    }

    #[test]
    fn validate_names_the_field() {
        let error = Proximity { margin: 0.0 }.validate().unwrap_err();
        assert_eq!(error.to_string(), "margin = 0: must be positive and finite");
    }
}
