//! The one error type of the crate.

/// Anything that can go wrong in this crate, with the field or row, its value, and what is allowed.
#[derive(Debug, thiserror::Error)]
pub enum RlError {
    /// A field of a spec is out of its range.
    #[error("agent.{field} = {value}: allowed is {allowed}")]
    Spec {
        /// The path of the field inside the spec, as written in TOML.
        field: &'static str,
        /// The value found.
        value: String,
        /// The values that are allowed.
        allowed: &'static str,
    },
    /// An array has the wrong number of elements.
    #[error("{what} has {found} elements, expected {expected} ({shape})")]
    Shape {
        /// The array.
        what: &'static str,
        /// The number of its elements.
        found: usize,
        /// The number it should have.
        expected: usize,
        /// The shape it should have, in words.
        shape: String,
    },
    /// An action is not one of the agent's.
    #[error("actions[{row}] = {action}: allowed is 0..{n_actions}")]
    Action {
        /// The row of the batch.
        row: usize,
        /// The action found.
        action: u32,
        /// The number of actions.
        n_actions: usize,
    },
    /// An array holds a NaN or an infinity.
    #[error("{what}[{row}][{column}] = {value}: allowed is any finite number")]
    NotFinite {
        /// The array.
        what: &'static str,
        /// The row of the batch.
        row: usize,
        /// The column within the row (0 for rewards).
        column: usize,
        /// The value found.
        value: f32,
    },
    /// The loss or the gradient is no longer finite.
    #[error(
        "training diverged at gradient step {gradient_step}: {what} = {value}; lower the learning rate, clip gradients, or scale rewards"
    )]
    Diverged {
        /// The gradient step, counted from 1.
        gradient_step: u64,
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f32,
    },
    /// A saved state belongs to an agent of another shape.
    #[error("saved state has {field} = {found}, this agent has {expected}")]
    StateMismatch {
        /// The field that differs.
        field: &'static str,
        /// Its value in the stream.
        found: String,
        /// Its value in the agent that loads.
        expected: String,
    },
    /// A saved state is damaged.
    #[error("saved state is damaged: {what}")]
    CorruptState {
        /// What does not add up.
        what: &'static str,
    },
    /// A state could not be written.
    #[error("cannot write the state: {0}")]
    Write(#[from] rmp_serde::encode::Error),
    /// A state could not be read.
    #[error("cannot read the state: {0}")]
    Read(#[from] rmp_serde::decode::Error),
    /// The tensor library failed.
    #[error("tensor operation failed: {0}")]
    Tensor(Box<candle_core::Error>),
}

impl From<candle_core::Error> for RlError {
    fn from(error: candle_core::Error) -> Self {
        Self::Tensor(Box::new(error))
    }
}

/// Fails unless `found == expected`; `shape` is only built for the message.
pub(crate) fn check_len(
    what: &'static str,
    found: usize,
    expected: usize,
    shape: impl FnOnce() -> String,
) -> Result<(), RlError> {
    if found == expected {
        return Ok(());
    }
    Err(RlError::Shape { what, found, expected, shape: shape() })
}
