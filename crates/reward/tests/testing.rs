//! `testing::check` catches each way of being a bad reward.

use headway_reward::{Event, Reward, RewardError, Transition, testing};
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicU32, Ordering};

fn message(reward: &dyn Reward) -> String {
    testing::check(reward).unwrap_err().to_string()
}

/// Divides by a speed that can be zero.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Infinite {}

#[typetag::serde(name = "bad/infinite")]
impl Reward for Infinite {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        1.0 / t.after.speed
    }
}

#[test]
fn infinity_is_caught_with_its_transition() {
    let message = message(&Infinite {});
    let start = "pays inf, which is not finite, for transition 6 (event None, speed ";
    assert!(message.starts_with(start), "{message}");
    assert!(message.contains("-> 0, obstacle angle None, clearance -0.3"), "{message}");
}

/// Goes wrong in one corner only: a collision at negative clearance while dead ahead.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Corner {}

#[typetag::serde(name = "bad/corner")]
impl Reward for Corner {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        let corner = t.event == Some(Event::Collision) && t.after.obstacle_angle == Some(0.0);
        if corner { t.after.clearance.sqrt() } else { 0.0 }
    }
}

#[test]
fn a_rare_nan_is_caught() {
    assert!(message(&Corner {}).starts_with("pays NaN, which is not finite, for transition "));
}

/// Remembers the clearance of the step before.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Remembers {
    #[serde(skip)]
    last: AtomicU32,
}

#[typetag::serde(name = "bad/remembers")]
impl Reward for Remembers {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        f64::from(self.last.swap(t.after.clearance.to_bits() as u32, Ordering::Relaxed))
    }
}

#[test]
fn memory_is_caught() {
    let error = testing::check(&Remembers::default()).unwrap_err();
    assert!(matches!(error, RewardError::NotPure { .. }), "{error}");
}

/// Forgets a field that matters when written.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Forgets {
    #[serde(skip)]
    scale: f64,
}

#[typetag::serde(name = "bad/forgets")]
impl Reward for Forgets {
    fn reward(&self, _: &Transition<'_>) -> f64 {
        self.scale
    }
}

#[test]
fn a_field_lost_in_the_spec_is_caught() {
    let message = message(&Forgets { scale: 2.0 });
    let start = "pays 2, but 0 once written to a spec and read back, for transition 0 (";
    assert!(message.starts_with(start), "{message}");
}

/// Has a version that its spec does not decide.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Unversioned {
    #[serde(skip)]
    version: u32,
}

#[typetag::serde(name = "bad/unversioned")]
impl Reward for Unversioned {
    fn reward(&self, _: &Transition<'_>) -> f64 {
        0.0
    }

    fn version(&self) -> u32 {
        self.version
    }
}

#[test]
fn a_version_lost_in_the_spec_is_caught() {
    let message = message(&Unversioned { version: 3 });
    assert_eq!(message, "has version 3, but 0 once written to a spec and read back");
}

/// Lacks `deny_unknown_fields`.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
struct Lenient {}

#[typetag::serde(name = "bad/lenient")]
impl Reward for Lenient {
    fn reward(&self, _: &Transition<'_>) -> f64 {
        0.0
    }
}

#[test]
fn a_lenient_reward_is_caught() {
    assert_eq!(
        message(&Lenient {}),
        "`bad/lenient` accepts a field it does not have; give it `#[serde(deny_unknown_fields)]`"
    );
}

/// A unit struct, to which serde has no way of denying fields.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Unit;

#[typetag::serde(name = "bad/unit")]
impl Reward for Unit {
    fn reward(&self, _: &Transition<'_>) -> f64 {
        0.0
    }
}

#[test]
fn a_unit_struct_is_caught() {
    let error = testing::check(&Unit).unwrap_err();
    assert!(matches!(error, RewardError::AcceptsUnknownField { .. }), "{error}");
}

/// Lacks `default`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Demanding {
    scale: f64,
}

#[typetag::serde(name = "bad/demanding")]
impl Reward for Demanding {
    fn reward(&self, _: &Transition<'_>) -> f64 {
        self.scale
    }
}

#[test]
fn a_reward_without_default_is_caught_and_listed_as_such() {
    let expected = "`type = \"bad/demanding\"` alone does not load: missing field `scale`; give the reward `Default` and \
                    `#[serde(default)]`";
    assert_eq!(message(&Demanding { scale: 1.0 }), expected);

    let entries = headway_reward::registry().unwrap();
    let entry = entries.iter().find(|entry| entry.tag == "bad/demanding").unwrap();
    assert_eq!(entry.default.as_ref().unwrap_err().to_string(), expected);
}

/// Holds what TOML cannot.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Unwritable {
    seed: u64,
}

#[typetag::serde(name = "bad/unwritable")]
impl Reward for Unwritable {
    fn reward(&self, _: &Transition<'_>) -> f64 {
        0.0
    }
}

#[test]
fn what_a_spec_cannot_hold_is_caught() {
    assert_eq!(testing::check(&Unwritable { seed: 7 }), Ok(()));
    let message = message(&Unwritable { seed: u64::MAX });
    let expected = "cannot be written to a spec: 18446744073709551615 does not fit an integer";
    assert_eq!(message, expected);
}

#[test]
fn invalid_fields_are_caught_first() {
    let message = message(&headway_reward::Proximity { margin: 0.0 });
    assert_eq!(message, "margin = 0: must be positive and finite");
}
