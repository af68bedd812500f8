//! Rewards for driving: the [`Reward`] trait, the reward R of Liu et al. and their speed-coupled R_couple, and rewards
//! that people combine.
//!
//! A reward R(s, a, s') sees one [`Transition`]: plain SI numbers, all relative to the vehicle. So this crate depends
//! on no other of Headway, and a plugin that depends on it compiles in seconds.
//!
//! | tag | reward | pays |
//! |---|---|---|
//! | `r` | [`R`] | Liu et al., eq. (4): a number each for a step, a collision and reaching the goal |
//! | `r_couple` | [`RCouple`] | Liu et al., eq. (5): the speed, coupled to the angle of the nearest obstacle |
//! | `progress` | [`Progress`] | 1 per metre of distance to the goal |
//! | `heading` | [`Heading`] | the cosine of the goal's bearing, per step |
//! | `time` | [`Time`] | 1 per second |
//! | `proximity` | [`Proximity`] | how deep the vehicle is inside a safety margin, 0 to 1, per step |
//! | `steady_speed` | [`SteadySpeed`] | arriving, progress up to a desired speed; charges more speed, and braking for nothing |
//! | `sum` | [`Sum`] | the weighted sum of others |
//!
//! In a spec a reward is a table whose `type` is its tag. Fields left out take their defaults, unknown ones are errors:
//!
//! ```
//! use headway_reward::{Reward, State, Transition};
//!
//! let reward: Box<dyn Reward> = toml::from_str(r#"
//!     type = "sum"
//!     terms = [
//!         { weight = 1.0, reward = { type = "r", no_collision = 0.0, collision = -50.0 } },
//!         { weight = 40.0, reward = { type = "progress" } },
//!         { weight = -5.0, reward = { type = "proximity", margin = 0.2 } },
//!     ]
//! "#)?;
//! reward.validate()?;
//!
//! let after = State { goal_distance: 4.75, clearance: 0.1, ..State::default() };
//! let step = Transition { after, ..Transition::default() }; // 0.25 m nearer to the goal, 0.1 m from an obstacle
//! assert_eq!(reward.reward(&step), 7.5); // 40 x 0.25 - 5 x 0.5
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`registry`] lists what specs can name, plugins included; [`testing::check`] checks any reward.

mod error;
mod heading;
mod progress;
mod proximity;
mod r;
mod r_couple;
mod registry;
mod reward;
mod serde_error;
mod state;
mod steady_speed;
mod sum;
pub mod testing;
mod time;
mod transition;
mod value;

pub use error::RewardError;
pub use heading::Heading;
pub use progress::Progress;
pub use proximity::Proximity;
pub use r::R;
pub use r_couple::RCouple;
pub use registry::{Entry, check_tag, registry};
pub use reward::Reward;
pub use state::{Limits, State};
pub use steady_speed::SteadySpeed;
pub use sum::{Sum, Term};
pub use time::Time;
pub use transition::{Event, Transition};
