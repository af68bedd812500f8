//! What can go wrong in this crate.

use headway_reward::RewardError;
use headway_sim::{FieldError, SimError};

/// Why a spec was refused or an environment could not go on.
#[derive(Debug, thiserror::Error)]
pub enum EnvError {
    /// A number outside what its field allows; the field's path starts at its table (`vehicle.max_speed`).
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A scenario that cannot be made.
    #[error("world: {0}")]
    World(SimError),
    /// A reward whose fields make no sense.
    #[error(transparent)]
    Reward(#[from] RewardError),
    /// A goal that no route on the grid leads to.
    #[error("no route from ({}, {}) to ({}, {}) on a grid of {cell} m: allow a smaller env.route.cell", from[0], from[1], goal[0], goal[1])]
    NoRoute {
        /// Where the route was to start, metres.
        from: [f64; 2],
        /// Where it was to end, metres.
        goal: [f64; 2],
        /// Edge of a cell, metres.
        cell: f64,
    },
    /// A world too large for a map of small cells.
    #[error(
        "a map of {width:.0} x {height:.0} m in cells of {cell} m does not fit in memory: allow a larger env.route.cell"
    )]
    MapTooLarge {
        /// Edge of a cell, metres.
        cell: f64,
        /// The room's extent along x, metres.
        width: f64,
        /// The room's extent along y, metres.
        height: f64,
    },
    /// An action beyond the action set.
    #[error("action {action} in environment {index}: there are {n_actions} actions, 0 to {}", n_actions - 1)]
    NoSuchAction {
        /// The action asked for.
        action: u32,
        /// In which environment.
        index: usize,
        /// How many there are.
        n_actions: usize,
    },
    /// A slice of the wrong length.
    #[error("{what} holds {found} entries: must be {expected}")]
    Shape {
        /// Which argument.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A saved state that does not fit.
    #[error("the saved state holds {found} {what}, this environment {expected}")]
    StateMismatch {
        /// What differs.
        what: &'static str,
        /// The saved number.
        found: usize,
        /// The number here.
        expected: usize,
    },
    /// A saved state whose routes were planned otherwise.
    #[error("the saved state's planner has other numbers than this environment's (env.route)")]
    OtherPlanner,
    /// Threads that could not be started.
    #[error("cannot start the environments' threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A stream that could not be written.
    #[error("cannot write the environment's state: {0}")]
    Write(#[from] rmp_serde::encode::Error),
    /// A stream that could not be read.
    #[error("cannot read the environment's state: {0}")]
    Read(#[from] rmp_serde::decode::Error),
}

impl From<SimError> for EnvError {
    fn from(error: SimError) -> Self {
        match error {
            SimError::Field(field) => Self::Field(field.under("world")),
            other => Self::World(other),
        }
    }
}

/// Refuses a slice of the wrong length.
pub(crate) fn check_len(what: &'static str, found: usize, expected: usize) -> Result<(), EnvError> {
    if found == expected { Ok(()) } else { Err(EnvError::Shape { what, found, expected }) }
}
