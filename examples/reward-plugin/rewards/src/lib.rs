//! Rewards for smooth driving: an example of a Headway reward plugin.
//!
//! | tag | reward | pays |
//! |---|---|---|
//! | `smooth/needless_braking` | [`NeedlessBraking`] | the deceleration, in m/s², while the way ahead is clear |
//! | `smooth/overspeed` | [`Overspeed`] | what the speed has above a limit, in m/s |
//!
//! A reward is one file: a plain struct, its defaults, and `impl Reward` under `#[typetag::serde(name = "...")]`.
//! Nothing needs registering beyond that attribute. How to use a plugin is told in Headway's `docs/plugins.md`.

mod needless_braking;
mod overspeed;

pub use needless_braking::NeedlessBraking;
pub use overspeed::Overspeed;
