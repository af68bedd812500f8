use headway_reward::{Reward, RewardError, Transition};
use serde::{Deserialize, Serialize};

/// Overspeed: how much faster than the limit the vehicle drives, m/s.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Overspeed {
    /// The speed that is free, m/s.
    pub limit: f64,
}

impl Default for Overspeed {
    fn default() -> Self {
        Self { limit: 1.2 }
    }
}

#[typetag::serde(name = "smooth/overspeed")]
impl Reward for Overspeed {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        (t.after.speed - self.limit).max(0.0)
    }

    fn validate(&self) -> Result<(), RewardError> {
        RewardError::require_finite("limit", self.limit)
    }
}
