//! What can go wrong in this crate.

use headway_sim::FieldError;

/// Why a policy could not be made, read, written or used.
#[derive(Debug, thiserror::Error)]
pub enum PolicyError {
    /// A number in the header outside what its field allows.
    #[error("the policy's header: {0}")]
    Header(#[from] FieldError),
    /// A file that holds no policy.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: String,
        /// What is not as it must be.
        source: Box<PolicyError>,
    },
    /// A file that could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Bytes that are not a policy file.
    #[error("not a policy file: {0}")]
    Format(String),
    /// A network that does not fit its header.
    #[error("{what}: found {found}, must be {expected}")]
    Shape {
        /// Which part of the network.
        what: String,
        /// What it is: a count, or the shape of a tensor.
        found: String,
        /// What it must be.
        expected: String,
    },
    /// A weight that is not a finite number.
    #[error("layer {layer} holds a weight that is not a finite number")]
    NotFinite {
        /// Which layer, counted from 0.
        layer: usize,
    },
    /// Another vehicle or another lidar than the policy was trained with.
    #[error("this policy was made for another robot: {}", differences.join("; "))]
    Mismatch {
        /// What differs, one entry per number.
        differences: Vec<String>,
    },
}
