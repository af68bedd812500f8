//! The navigation MDP: what an agent observes, what its actions do, what it is paid, and when an episode
//! ends. Batched, auto-reset, deterministic; knows no learning.
//!
//! From data to driving: a [`NavSpec`] is built into a checked [`Mdp`]; a [`Navigator`] is one vehicle in
//! one scenario of it; a [`NavEnv`] is many of them in lock-step behind the [`Env`] trait.
//!
//! # Example
//! ```
//! use headway_env::{Env, NavEnv, NavSpec, Step};
//!
//! let mut env = NavEnv::new(NavSpec::default().build()?, 4);
//! let mut obs = vec![0.0; 4 * env.obs_dim()];
//! env.reset(7, &mut obs)?;
//! let mut step = Step::new(4, env.obs_dim());
//! env.step(&[0, 1, 2, 3], &mut step)?;
//! assert!(step.rewards.iter().all(|reward| reward.is_finite()));
//! # Ok::<(), headway_env::EnvError>(())
//! ```

mod actions;
mod encoder;
mod env;
mod error;
mod history;
mod mdp;
mod nav_env;
mod navigator;
mod observation;
mod randomize;
mod robot;
mod shard;
mod spec;

pub use actions::{ActionSet, ActionSpec};
pub use encoder::Encoder;
pub use env::{Env, Step};
pub use error::EnvError;
pub use headway_reward::{Event, Transition};
pub use history::History;
pub use mdp::Mdp;
pub use nav_env::NavEnv;
pub use navigator::{Navigator, StepEnd};
pub use observation::{ObservationSpec, ScanEncoding, Side};
pub use randomize::{Distribution, RandomizeSpec};
pub use spec::{Control, EnvSpec, GoalHandling, NavSpec, RouteSource, TrueMapSpec};
