use crate::{Reward, Transition};
use serde::{Deserialize, Serialize};

/// Time: 1 per second, so `dt` per step; a negative weight in a [`Sum`](crate::Sum) makes it a cost of dawdling.
///
/// Tag `time`. Per second rather than per step, so that a spec keeps its meaning when the control period changes.
///
/// ```
/// use headway_reward::{Reward, Time, Transition};
///
/// assert_eq!(Time {}.reward(&Transition { dt: 0.1, ..Transition::default() }), 0.1);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Time {}

#[typetag::serde(name = "time")]
impl Reward for Time {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        t.dt
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_pays_one_in_any_number_of_steps() {
        for n_steps in [1_u32, 5, 20] {
            let dt = 1.0 / f64::from(n_steps);
            let step = Transition { dt, ..Transition::default() };
            let total: f64 = (0..n_steps).map(|_| Time {}.reward(&step)).sum();
            assert!((total - 1.0).abs() < 1e-12, "{n_steps} steps: {total}");
        }
    }
}
