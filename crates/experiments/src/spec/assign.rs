//! Assignments of the command line: `--set PATH=VALUE`.

use std::fmt;
use std::str::FromStr;

use toml::{Table, Value};

use super::KeyPath;
use super::error::in_short;
use super::integers::{TOO_LARGE, first_too_large};

/// One `PATH=VALUE`: the value at a dotted path and what replaces it.
///
/// VALUE is read as TOML; what is no TOML is taken as a plain string.
///
/// ```
/// use headway_experiments::spec::Assignment;
/// let set: Assignment = "agent.target=double_dqn".parse()?;
/// assert_eq!(set.path.to_string(), "agent.target");
/// assert_eq!(set.value.as_str(), Some("double_dqn"));
/// let set: Assignment = "agent.gamma=0.9".parse()?;
/// assert_eq!(set.value.as_float(), Some(0.9));
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Assignment {
    /// The path that must exist.
    pub path: KeyPath,
    /// What replaces the value there.
    pub value: Value,
}

impl FromStr for Assignment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (path, value) = text.split_once('=').ok_or("write PATH=VALUE, for example agent.gamma=0.9")?;
        let (path, value): (KeyPath, _) = (path.parse()?, value.trim());
        let value = value_of(value).map_err(|problem| too_large(&path, value).unwrap_or(problem))?;
        Ok(Self { path, value })
    }
}

impl fmt::Display for Assignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.path, in_short(&self.value))
    }
}

/// `text` as a TOML value, or else as a string; tables and arrays are taken as nothing else.
fn value_of(text: &str) -> Result<Value, String> {
    match format!("value = {text}\n").parse::<Table>() {
        Ok(mut table) if table.len() == 1 => Ok(table.remove("value").unwrap_or_else(|| Value::String(text.into()))),
        Err(error) if text.starts_with(['{', '[']) => Err(format!("not valid TOML: {}", error.message())),
        _ => Ok(Value::String(text.into())),
    }
}

/// What is wrong with a `value` that holds too large a number.
fn too_large(path: &KeyPath, value: &str) -> Option<String> {
    let (below, number) = first_too_large(&format!("value = {value}\n"))?;
    Some(format!("{} = {number}: {TOO_LARGE}", path.extend(&below.below(&KeyPath::new(["value"])))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_toml_or_else_strings() {
        for (text, expected) in [
            ("a=1", Value::Integer(1)),
            ("a=1_000", Value::Integer(1000)),
            ("a = 0.5", Value::Float(0.5)),
            ("a=[1, 2]", Value::Array(vec![1.into(), 2.into()])),
            ("a=dqn", Value::String("dqn".into())),
            ("a=\"dqn\"", Value::String("dqn".into())),
            ("a=my/reward", Value::String("my/reward".into())),
            ("a=x=y", Value::String("x=y".into())),
            ("a=1\nb=2", Value::String("1\nb=2".into())),
            ("a=", Value::String(String::new())),
        ] {
            assert_eq!(text.parse::<Assignment>().unwrap().value, expected, "{text}");
        }
        let refusal = "seeds={ first = 18446744073709551615 }".parse::<Assignment>().unwrap_err();
        assert_eq!(refusal, "seeds.first = 18446744073709551615: whole numbers reach from -2^63 to 2^63 - 1");
        let table = "a={ type = 'r' }".parse::<Assignment>().unwrap();
        assert_eq!(table.value.get("type").and_then(Value::as_str), Some("r"));
    }

    #[test]
    fn what_is_no_assignment_is_refused() {
        for text in ["gamma", "=1", "a..b=1", ".a=1", "a={ b = }", "a=[1, 2", "a={ b = dqn }"] {
            assert!(text.parse::<Assignment>().is_err(), "{text}");
        }
    }
}
