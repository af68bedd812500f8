use crate::{Reward, RewardError, Transition};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A weighted sum of rewards, `sum_i w_i R_i(s, a, s')`; an empty one pays 0.
///
/// Tag `sum`. Every kind of reward can be a term, a plugin's and another sum included.
///
/// ```
/// use headway_reward::{Event, Progress, R, Reward, Sum, Time, Transition};
///
/// let spec = r#"
///     type = "sum"
///     terms = [
///         { weight = 1.0, reward = { type = "r", no_collision = 0.0, collision = -50.0 } },
///         { weight = 40.0, reward = { type = "progress" } },
///         { weight = -2.5, reward = { type = "time" } },
///     ]
/// "#;
/// let reward: Box<dyn Reward> = toml::from_str(spec)?;
/// let step = Transition { event: Some(Event::Collision), ..Transition::default() };
/// assert_eq!(reward.reward(&step), -50.5); // no progress, 0.2 s
///
/// let same = Sum::default()
///     .with(1.0, R { no_collision: 0.0, collision: -50.0, ..R::default() })
///     .with(40.0, Progress::default())
///     .with(-2.5, Time {});
/// assert_eq!(same.reward(&step), -50.5);
/// # Ok::<(), toml::de::Error>(())
/// ```
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sum {
    /// What is summed, in this order.
    pub terms: Vec<Term>,
}

/// One term of a [`Sum`]: a reward and its weight.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Term {
    /// What the reward is multiplied by; negative for a penalty.
    pub weight: f64,
    /// The reward.
    pub reward: Arc<dyn Reward>,
}

impl Sum {
    /// The same sum with one more term.
    #[must_use]
    pub fn with(mut self, weight: f64, reward: impl Reward + 'static) -> Self {
        let reward = Arc::new(reward);
        self.terms.push(Term { weight, reward });
        self
    }
}

#[typetag::serde(name = "sum")]
impl Reward for Sum {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        // A fold from 0.0, since std's sum of no floats is -0.0.
        self.terms.iter().fold(0.0, |sum, term| sum + term.weight * term.reward.reward(t))
    }

    /// The sum of its terms' versions. Versions only rise, so for given terms it changes whenever one of theirs does.
    fn version(&self) -> u32 {
        self.terms.iter().fold(0, |sum, term| sum.saturating_add(term.reward.version()))
    }

    fn validate(&self) -> Result<(), RewardError> {
        for (index, term) in self.terms.iter().enumerate() {
            RewardError::require_finite("weight", term.weight)
                .and_then(|()| term.reward.validate())
                .map_err(|error| RewardError::Term { index, source: Box::new(error) })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Heading, Proximity, R, RCouple, Time};

    #[test]
    fn weights_and_terms_by_hand() {
        // 0.5 x 10 (no collision) + 2 x 1 (facing the goal) - 10 x 0.2 s
        let sum = Sum::default().with(0.5, R::default()).with(2.0, Heading {}).with(-10.0, Time {});
        assert_eq!(sum.reward(&Transition::default()), 5.0);
    }

    #[test]
    fn nothing_pays_nothing() {
        let paid = Sum::default().reward(&Transition::default());
        assert_eq!(paid, 0.0);
        assert!(paid.is_sign_positive());
    }

    #[test]
    fn sums_nest() {
        let inner = Sum::default().with(3.0, R::default());
        let outer = Sum::default().with(2.0, inner).with(1.0, RCouple::default());
        assert_eq!(outer.reward(&Transition::default()), 70.0);
        assert_eq!(outer.version(), 2);
    }

    #[test]
    fn validate_names_term_and_field() {
        let inner = Sum::default().with(1.0, Proximity { margin: -1.0 });
        let outer = Sum::default().with(1.0, R::default()).with(1.0, inner);
        let error = outer.validate().unwrap_err().to_string();
        assert_eq!(error, "terms[1]: terms[0]: margin = -1: must be positive and finite");

        let error = Sum::default().with(f64::NAN, R::default()).validate().unwrap_err();
        assert_eq!(error.to_string(), "terms[0]: weight = NaN: must be finite");
    }
}
