//! The policy file and its runtime: what robots, simulators and other programs load to drive.
//!
//! A policy file is one safetensors file. Its tensors are the network's weights; its metadata hold all
//! that driving needs besides: vehicle, lidar, observation, normalisation, actions ([`Header`]). A [`Policy`] compiles
//! without any learning framework; a [`Driver`] is a [`headway_planning::Controller`] made from it.
//!
//! # Example
//! ```
//! use headway_policy::{Header, Layer, Policy};
//!
//! // A network of one layer that always prefers action 10: 1.5 m/s straight ahead.
//! let header = Header::default();
//! let mut bias = vec![0.0; 12];
//! bias[10] = 1.0;
//! let layer = Layer { weight: vec![0.0; 12 * header.obs_dim()?], bias };
//! let policy = Policy::new(header, vec![layer])?;
//! let read_back = Policy::from_bytes(&policy.to_bytes()?)?;
//! assert_eq!(read_back, policy);
//!
//! let mut slower = policy.header().vehicle.clone();
//! slower.max_speed = 1.0;
//! let refusal = policy.check(&slower, &policy.header().lidar).unwrap_err();
//! assert_eq!(
//!     refusal.to_string(),
//!     "this policy was made for another robot: vehicle.max_speed is 1.5 in the policy, 1.0 here"
//! );
//! # Ok::<(), headway_policy::PolicyError>(())
//! ```

mod atomic;
mod driver;
mod error;
mod file;
mod header;
mod mlp;
mod normalisation;

pub use driver::Driver;
pub use error::PolicyError;
pub use header::Header;
pub use mlp::{Layer, Policy};
pub use normalisation::Normalisation;
