use crate::{Reward, Transition};
use serde::{Deserialize, Serialize};

/// Heading: the cosine of the goal's bearing after the step, 1 when the vehicle points at the goal and -1 when away.
///
/// Tag `heading`. Paid per step, at rest too: a vehicle that stands and looks at its goal earns as much as one that
/// drives there. [`Progress`](crate::Progress) has no such trap.
///
/// ```
/// use headway_reward::{Heading, Reward, Transition};
///
/// assert_eq!(Heading {}.reward(&Transition::default()), 1.0); // the goal lies straight ahead
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Heading {}

#[typetag::serde(name = "heading")]
impl Reward for Heading {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        t.after.goal_bearing.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::State;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI};

    #[test]
    fn cosines_by_hand() {
        for (goal_bearing, expected) in [(0.0, 1.0), (FRAC_PI_3, 0.5), (-FRAC_PI_3, 0.5), (FRAC_PI_2, 0.0), (PI, -1.0)]
        {
            let after = State { goal_bearing, ..State::default() };
            let paid = Heading {}.reward(&Transition { after, ..Transition::default() });
            assert!((paid - expected).abs() < 1e-12, "{goal_bearing}: {paid}");
        }
    }
}
