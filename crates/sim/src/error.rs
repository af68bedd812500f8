//! What can go wrong in this crate.

use crate::FieldError;

/// Why a spec was refused or a scenario could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimError {
    /// A number outside what its field allows.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A world file that was refused.
    #[error(transparent)]
    File(#[from] crate::files::FileError),
    /// An obstacle of a given world that leaves its room.
    #[error("obstacle {index} at ({x}, {y}) reaches out of the {width} x {height} m room")]
    OutsideRoom {
        /// Which obstacle, counted from 0.
        index: usize,
        /// Its position, metres.
        x: f64,
        /// Its position, metres.
        y: f64,
        /// The room's extent along x, metres.
        width: f64,
        /// The room's extent along y, metres.
        height: f64,
    },
    /// A room too full for the next obstacle.
    #[error(
        "cannot place {what} in a {width:.1} x {height:.1} m room with gaps of {min_gap} m: {tries} tries failed; \
         allow fewer or smaller obstacles, a smaller min_gap, or a larger room"
    )]
    CannotPlace {
        /// The obstacle that found no place.
        what: String,
        /// The room's extent along x, metres.
        width: f64,
        /// The room's extent along y, metres.
        height: f64,
        /// The required gap, metres.
        min_gap: f64,
        /// How often it was tried.
        tries: usize,
    },
    /// A room in which no start and goal are far enough apart and joined by a path.
    #[error(
        "found no start and goal at least {distance} m apart, each with {clearance} m to spare and joined by a path \
         {diameter:.2} m wide, in a {width:.1} x {height:.1} m room after {tries} tries; \
         allow a smaller start_goal_distance, fewer obstacles, or larger gaps"
    )]
    NoRoute {
        /// The required straight distance, metres.
        distance: f64,
        /// The required clearance at both ends, metres.
        clearance: f64,
        /// The width of the footprint's circumscribed circle, metres.
        diameter: f64,
        /// The room's extent along x, metres.
        width: f64,
        /// The room's extent along y, metres.
        height: f64,
        /// How often it was tried.
        tries: usize,
    },
}

impl SimError {
    /// The same refusal, if it is one of a field, seen from what holds it under `parent`.
    #[must_use]
    pub(crate) fn under(self, parent: &str) -> Self {
        match self {
            Self::Field(error) => Self::Field(error.under(parent)),
            other => other,
        }
    }
}
