//! What is wrong with a spec, and where.

use std::fmt;
use std::path::PathBuf;

use toml::Value;

use super::KeyPath;

/// Where a value was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// In a spec file.
    File {
        /// The file as it was named.
        file: PathBuf,
        /// The line, counted from 1, where it is known.
        line: Option<usize>,
        /// Which axis and level, or which `when`, where it is one.
        part: Option<String>,
    },
    /// In an option `--set PATH=VALUE` of the command line.
    CommandLine,
}

impl Place {
    /// This place, said to be in `part` of its file.
    pub(crate) fn in_part(self, part: &str) -> Self {
        match self {
            Self::File { file, line, .. } => Self::File { file, line, part: Some(part.to_owned()) },
            Self::CommandLine => Self::CommandLine,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::File { file, line, part } = self else {
            return f.write_str("--set");
        };
        write!(f, "{}", file.display())?;
        if let Some(line) = line {
            write!(f, ":{line}")?;
        }
        if let Some(part) = part {
            write!(f, " ({part})")?;
        }
        Ok(())
    }
}

/// A value of a spec that is not allowed, before its place in a file is looked up.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Which value; a fault of no single value names their table.
    pub path: KeyPath,
    /// What is wrong and what is allowed.
    pub problem: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path, self.problem)
    }
}

impl std::error::Error for Fault {}

impl Fault {
    /// `problem` with the value at the path of these segments.
    pub fn new<S: AsRef<str>>(segments: impl IntoIterator<Item = S>, problem: impl Into<String>) -> Self {
        let path = KeyPath::new(segments.into_iter().map(|segment| segment.as_ref().to_owned()));
        Self { path, problem: problem.into() }
    }
}

/// Why a spec was refused: the place, the dotted path, its value, and what would do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SpecError {
    /// Where it is written.
    pub place: Box<Place>,
    /// Which value, where one is to blame.
    pub path: Option<KeyPath>,
    /// That value, shortened where it is long.
    pub value: Option<String>,
    /// What is wrong and what is allowed.
    pub problem: String,
}

impl fmt::Display for SpecError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.place)?;
        if let Some(path) = &self.path {
            write!(f, "{path}")?;
            if let Some(value) = &self.value {
                write!(f, " = {value}")?;
            }
            f.write_str(": ")?;
        }
        f.write_str(&self.problem)
    }
}

impl std::error::Error for SpecError {}

impl SpecError {
    /// This error, said to need other values than the one named too.
    pub(crate) fn given(mut self, others: &str) -> Self {
        self.problem += &format!(" ({others})");
        self
    }
}

/// Characters of a value that a message shows.
const WIDTH: usize = 60;

/// A value in as many characters as a message has room for.
pub(crate) fn in_short(value: &Value) -> String {
    let text = match value {
        // TOML's own form of 1e-320 has as many zeros.
        Value::Float(x) if value.to_string().len() > WIDTH => format!("{x:e}"),
        other => other.to_string(),
    };
    match text.char_indices().nth(WIDTH) {
        Some(_) => text.chars().take(WIDTH - 3).chain("...".chars()).collect(),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_values_are_shortened() {
        assert_eq!(in_short(&Value::Float(0.5)), "0.5");
        assert_eq!(in_short(&Value::Float(1e-320)), "1e-320");
        assert_eq!(in_short(&Value::Float(-1e300)), "-1e300");
        let long = in_short(&Value::String("\u{fc}".repeat(100)));
        assert_eq!((long.chars().count(), long.ends_with("\u{fc}...")), (WIDTH, true));
        assert_eq!(in_short(&Value::Array(vec![1.into(); 2])), "[1, 1]");
    }
}
