//! What a reward really pays for: the exact return of scripted drivers, before anything is trained.
//!
//! A reward is meant to pay for arriving. Whether it does is a matter of arithmetic: what does it pay, discounted and for
//! ever, a driver that parks, spins, orbits an obstacle, stops before the goal, crashes, or arrives at one speed or another?
//! Where a driver that does not arrive earns most, a learner that succeeds will learn not to arrive.
//!
//! The drivers are driven by the cell's own vehicle and seen by its own lidar, without their noise, in one scene: at rest, the
//! goal straight ahead, one disc beside the way. What a driver does is a beginning and then the end of the episode, or a cycle
//! that repeats exactly; so its return is a closed form ([`Payments`]) and not an estimate. There is no time limit: a learner
//! bootstraps through one.
//!
//! - [`Case`]: all that an audit depends on; cells that agree in it are audited once.
//! - [`Audit`]: what came of it, with a verdict.

mod case;
mod drivers;
mod gamma;
mod payments;
mod places;
mod ride;
mod scene;
mod text;
mod verdict;

pub use case::{Case, Steering};
pub use drivers::{Behaviour, End, Pace};
pub use payments::Payments;
pub use places::{Place, SpeedTerm, SpeedVerdict};
pub use text::{Entry, table};
pub use verdict::{Audit, Paid};
