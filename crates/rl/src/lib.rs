//! Deep Q-learning on plain numbers: one [`Agent`] trait, [`Dqn`] with two target rules, and [`TabularQ`] as its oracle.
//!
//! The crate implements the learning half of Liu et al., "Adaptive speed planning for Unmanned Vehicle Based on Deep
//! Reinforcement Learning": Q-learning (eq. 1), its loss (eq. 2), the DQN target (eq. 3) and Double DQN
//! (van Hasselt, Guez, Silver 2016). `docs/dqn.md` lists every hyper-parameter with source and unit, and every
//! deviation from the papers.
//!
//! # What it knows nothing of
//! Vehicles, lidars, rewards, worlds, files, threads, clocks. An agent sees rows of `f32`, chooses `u32`s and hears
//! `f32` rewards and two flags. It never touches an environment: somebody else runs the loop
//!
//! ```
//! use headway_rl::{Agent, DqnSpec, Mode, StepBatch};
//!
//! # fn main() -> Result<(), headway_rl::RlError> {
//! let spec = DqnSpec { warm_up: 64, hidden: vec![16], ..DqnSpec::default() };
//! let (obs_dim, n_actions, n_envs, n_steps, seed) = (3, 2, 4, 400, 7);
//! let mut agent = spec.build(obs_dim, n_actions, n_envs, n_steps, seed)?;
//!
//! let obs = vec![0.5; n_envs * obs_dim]; // [n_envs, obs_dim], row-major
//! let mut actions = vec![0; n_envs];
//! let mut n_updates = 0;
//! for _ in 0..n_steps / n_envs as u64 {
//!     agent.act(&obs, Mode::Explore, &mut actions)?;
//!     agent.observe(StepBatch {
//!         obs: &obs,
//!         actions: &actions,
//!         rewards: &[1.0; 4],
//!         next_obs: &obs, // what the step led to, before any reset
//!         terminated: &[false; 4],
//!         truncated: &[false; 4],
//!     })?;
//!     while let Some(loss) = agent.update()? {
//!         assert!(loss.value.is_finite());
//!         n_updates += 1;
//!     }
//! }
//! assert_eq!(n_updates, (400 - 64) / 32);
//! # Ok(())
//! # }
//! ```
//!
//! # Shape
//! - [`Agent`], [`Mode`], [`StepBatch`], [`Loss`]: the seam. `observe` checks its batch; nothing behind it checks again.
//! - [`DqnSpec`]: plain data, validated once by [`DqnSpec::build`].
//! - [`target`], [`LossFn`], [`n_step_return`], the schedules: the formulas, as pure functions. The learner calls these
//!   very functions on rows of Q-values and carries only the derivative with respect to Q back to the weights, so what the
//!   tests pin by hand is what runs.
//! - [`Dqn`]: n-step queues -> replay, which keeps every observation once -> learner (online, target and averaged
//!   networks, Adam). Networks are candle tensors; a pass forward, a pass back and a step of Adam are one operation each.
//!
//! # Determinism
//! Every random number comes from ChaCha8 streams named `weights`, `exploration` and `replay`, derived from one seed.
//! Equal spec, seed and inputs give equal bytes in [`Agent::save`], on machines with the same vector instructions.
//! A learner computes on the calling thread only, whatever the environment variables, because at these sizes a second
//! thread slows it down. Run one learner per core instead.

mod adam;
mod agent;
mod batch;
mod checkpoint;
mod dqn;
mod error;
mod kernel;
mod learner;
mod loss_fn;
mod mlp;
mod n_step;
mod network;
mod observations;
mod probe;
mod random;
mod replay;
mod schedule;
mod spec;
mod tabular;
pub mod target;
mod tensors;

#[cfg(test)]
mod reference;

pub use agent::{Agent, Loss, Mode};
pub use batch::StepBatch;
pub use dqn::Dqn;
pub use error::RlError;
pub use loss_fn::LossFn;
pub use n_step::n_step_return;
pub use network::Layer;
pub use probe::Probe;
pub use schedule::{Epsilon, LearningRate};
pub use spec::{AdamSpec, DqnSpec, GradientClip, TargetUpdate};
pub use tabular::{TabularQ, TabularSpec};
pub use target::TargetRule;
