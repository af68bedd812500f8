use crate::{RewardError, Transition};
use std::fmt::Debug;

/// R(s, a, s'): what one step of the vehicle is worth.
///
/// This is the open seam: implement it in a crate of your own and a spec can name your reward (see `docs/plugins.md`).
///
/// # Why it looks so
/// - *One argument.* A [`Transition`] is plain numbers. A reward therefore needs neither simulator nor lidar to compile
///   or to be tested, and a field added to it later breaks no reward.
/// - *Both states.* Shaping that leaves the best policy unchanged is a difference of potentials of s and s' (Ng, Harada
///   and Russell, 1999); progress towards the goal is one.
/// - *`&self`, and nothing else.* A reward is a pure function: the same transition always pays the same. So all
///   environments of all threads share one reward, a checkpoint holds no state of it, and a recorded transition can be
///   paid again. What a reward would like to remember, such as the last speed, belongs into [`State`](crate::State).
/// - *`f64`.* Learning runs in `f32`; the one conversion, with the scaling, happens in the environment.
/// - *Spec data.* A reward is serde data named by its tag, so the spec of a run says what the run was paid for. Give it
///   `Default` and `#[serde(default, deny_unknown_fields)]`: each number can then be left out, and none misspelt.
///
/// ```
/// use headway_reward::{Reward, Transition, testing};
/// use serde::{Deserialize, Serialize};
///
/// /// Pays the share of the top speed that the vehicle drives at.
/// #[derive(Clone, Debug, Default, Serialize, Deserialize)]
/// #[serde(default, deny_unknown_fields)]
/// struct Haste {}
///
/// #[typetag::serde(name = "example/haste")]
/// impl Reward for Haste {
///     fn reward(&self, t: &Transition<'_>) -> f64 {
///         t.after.speed / t.limits.max_speed
///     }
/// }
///
/// assert_eq!(testing::check(&Haste {}), Ok(()));
/// let spec: Box<dyn Reward> = toml::from_str(r#"type = "example/haste""#)?;
/// assert_eq!(spec.reward(&Transition::default()), 0.0);
/// # Ok::<(), toml::de::Error>(())
/// ```
#[typetag::serde(tag = "type")]
pub trait Reward: Send + Sync + Debug {
    /// The reward of one step, in a unit of its own; finite for every transition that a vehicle can make.
    fn reward(&self, transition: &Transition<'_>) -> f64;

    /// The version of what the reward pays: raise it whenever the same fields pay differently than before.
    ///
    /// Runs are identified by their spec and by this number, so that a change of code never passes for an old result.
    fn version(&self) -> u32 {
        1
    }

    /// Whether the fields make sense; checked once, when a spec is built.
    ///
    /// # Errors
    /// Names the field, its value and what is allowed; [`RewardError::require`] builds such an error.
    fn validate(&self) -> Result<(), RewardError> {
        Ok(())
    }
}
