use serde::{de, ser};
use std::fmt::{self, Display};

/// A serde error that keeps the one thing we look at, the list that an unknown variant comes with.
///
/// typetag has no function to list what is registered, but it passes that list, as data, to the error of whichever
/// deserialiser it serves.
#[derive(Debug)]
pub(crate) enum SerdeError {
    /// A tag was not registered; these are.
    UnknownVariant(&'static [&'static str]),
    /// Anything else.
    Message(String),
}

impl Display for SerdeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownVariant(known) => {
                write!(f, "unknown name, expected one of {}", known.join(", "))
            }
            Self::Message(message) => f.write_str(message),
        }
    }
}

impl std::error::Error for SerdeError {}

impl de::Error for SerdeError {
    fn custom<T: Display>(message: T) -> Self {
        Self::Message(message.to_string())
    }

    fn unknown_variant(_: &str, expected: &'static [&'static str]) -> Self {
        Self::UnknownVariant(expected)
    }
}

impl ser::Error for SerdeError {
    fn custom<T: Display>(message: T) -> Self {
        Self::Message(message.to_string())
    }
}
