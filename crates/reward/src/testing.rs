//! Checks for any reward, ours or a plugin's: the one line that belongs in the tests of each.

use crate::registry::default_of;
use crate::value::{Value, to_value};
use crate::{Reward, RewardError, Transition};
use serde::Deserialize;

mod transitions;

pub use transitions::transitions;

/// Whether `reward` keeps the promises that every reward makes, on all of [`transitions`].
///
/// It checks that the reward
/// - finds its own fields valid,
/// - pays a finite number for every transition,
/// - is pure: pays the same again when asked again, in another order,
/// - can be written to a spec and read back, and then pays the same and has the same version,
/// - refuses a field that it does not have, and
/// - loads from its tag alone, every field then at its default.
///
/// ```
/// use headway_reward::{RCouple, testing};
///
/// assert_eq!(testing::check(&RCouple::default()), Ok(()));
/// ```
///
/// # Errors
/// The first promise broken, and where: `pays NaN, which is not finite, for transition 17 (...)`.
pub fn check(reward: &dyn Reward) -> Result<(), RewardError> {
    reward.validate()?;
    let cases = transitions();
    let paid = pay(reward, &cases)?;
    check_pure(reward, &cases, &paid)?;
    let spec = to_value(reward).map_err(|error| serde_failed("written to a spec", error))?;
    check_round_trip(reward, &spec, &cases, &paid)?;
    check_strict(spec)
}

fn pay(reward: &dyn Reward, cases: &[Transition<'_>]) -> Result<Vec<f64>, RewardError> {
    let pay_one = |(index, case)| {
        let value = reward.reward(case);
        if value.is_finite() {
            Ok(value)
        } else {
            let case = describe(index, case);
            Err(RewardError::NotFinite { value, case })
        }
    };
    cases.iter().enumerate().map(pay_one).collect()
}

/// Asks again backwards, so that a reward that remembers the last step, or counts, is caught.
fn check_pure(reward: &dyn Reward, cases: &[Transition<'_>], paid: &[f64]) -> Result<(), RewardError> {
    for (index, (case, &first)) in cases.iter().zip(paid).enumerate().rev() {
        let second = reward.reward(case);
        if first != second {
            let case = describe(index, case);
            return Err(RewardError::NotPure { first, second, case });
        }
    }
    Ok(())
}

fn check_round_trip(
    reward: &dyn Reward,
    spec: &Value,
    cases: &[Transition<'_>],
    paid: &[f64],
) -> Result<(), RewardError> {
    let copy = load(spec.clone()).map_err(|error| serde_failed("read back from its spec", error))?;
    for (index, (case, &original)) in cases.iter().zip(paid).enumerate() {
        let reloaded = copy.reward(case);
        if original != reloaded {
            let case = describe(index, case);
            return Err(RewardError::RoundTrip { original, reloaded, case });
        }
    }
    match (reward.version(), copy.version()) {
        (original, reloaded) if original != reloaded => Err(RewardError::Version { original, reloaded }),
        _ => Ok(()),
    }
}

/// Whether the spec's reward refuses a field it does not have, and does without those it has.
fn check_strict(spec: Value) -> Result<(), RewardError> {
    let Value::Map(mut entries) = spec else {
        return Err(serde_failed("written to a spec", "it is not a table"));
    };
    let tag = match entries.iter().find(|(key, _)| key == "type") {
        Some((_, Value::String(tag))) => tag.clone(),
        _ => return Err(serde_failed("written to a spec", "it has no type")),
    };
    entries.push(("no_field_is_named_so".to_owned(), Value::Bool(true)));
    match load(Value::Map(entries)) {
        Ok(_) => Err(RewardError::AcceptsUnknownField { tag }),
        Err(_) => default_of(&tag).map(drop),
    }
}

fn load(spec: Value) -> Result<Box<dyn Reward>, impl ToString> {
    Deserialize::deserialize(spec)
}

fn serde_failed(what: &'static str, reason: impl ToString) -> RewardError {
    RewardError::Serde { what, reason: reason.to_string() }
}

/// What tells one of [`transitions`] from the others.
fn describe(index: usize, t: &Transition<'_>) -> String {
    format!(
        "transition {index} (event {:?}, speed {} -> {}, obstacle angle {:?}, clearance {}, goal distance {} -> {}, \
         bearing {}, dt {}, {} beams)",
        t.event,
        t.before.speed,
        t.after.speed,
        t.after.obstacle_angle,
        t.after.clearance,
        t.before.goal_distance,
        t.after.goal_distance,
        t.after.goal_bearing,
        t.dt,
        t.after.scan.len(),
    )
}
