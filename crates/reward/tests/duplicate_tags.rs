//! Two plugins of one name. They spoil the registry of the whole process, hence a test binary of their own.

use headway_reward::{Reward, RewardError, Transition, check_tag, registry};
use serde::{Deserialize, Serialize};

macro_rules! plugin {
    ($name:ident) => {
        #[derive(Debug, Default, Serialize, Deserialize)]
        struct $name {}

        #[typetag::serde(name = "same")]
        impl Reward for $name {
            fn reward(&self, _: &Transition<'_>) -> f64 {
                0.0
            }
        }
    };
}

plugin!(First);
plugin!(Second);

#[test]
fn the_registry_reports_them() {
    let error = registry().unwrap_err();
    assert_eq!(error, RewardError::Duplicate { tag: "same" });
    assert_eq!(
        error.to_string(),
        "two rewards are named `same`; rename one: a plugin's names begin with its own, as in `my_rewards/overspeed`"
    );
}

#[test]
fn the_tag_is_refused_and_the_others_are_not() {
    assert_eq!(check_tag("same"), Err(RewardError::Duplicate { tag: "same" }));
    assert_eq!(check_tag("r"), Ok(()));
}

#[test]
fn an_unknown_tag_lists_it_once() {
    let Err(RewardError::Unknown { known, .. }) = check_tag("other") else {
        panic!("nobody registered it");
    };
    assert_eq!(known.iter().filter(|tag| **tag == "same").count(), 1);
}
