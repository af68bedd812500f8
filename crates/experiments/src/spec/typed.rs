//! From TOML values to specs, with the exact place of what does not fit.

use headway_reward::{RewardError, check_tag};
use serde::de::DeserializeOwned;
use serde_path_to_error::{Path, Segment};
use toml::Value;

use super::head::HEAD_KEYS;
use super::suggest::{closest, did_you_mean, list};
use super::{KeyPath, path};

/// Said of `[axis]` where `[[axis]]` was meant.
const NOT_AN_ARRAY: &str = "must be an array, not a table";

/// A value that does not fit its type, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Misfit {
    /// The value, or the table that lacks one.
    pub(crate) path: KeyPath,
    /// Why it does not fit.
    pub(crate) why: Why,
}

/// In which way a value does not fit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Why {
    /// The last segment is no key there; these are.
    UnknownKey(Vec<String>),
    /// The value is no choice there; these are.
    UnknownChoice(Vec<String>),
    /// A key is missing.
    MissingKey(String),
    /// Anything else, in words.
    Other(String),
}

impl Misfit {
    /// What is wrong and what is allowed, for people; `root` is the tree that did not fit.
    pub(crate) fn explain(&self, root: &Value) -> String {
        match &self.why {
            Why::UnknownKey(known) => unknown_key(self.path.last(), &self.path.parent(), known),
            Why::UnknownChoice(known) => {
                let word = path::get(root, &self.path).and_then(Value::as_str).unwrap_or(self.path.last());
                unknown_reward(word, known).unwrap_or_else(|| {
                    format!("unknown {}{}Known: {}", self.noun(), did_you_mean(word, known), list(known))
                })
            }
            Why::MissingKey(key) => format!("the key `{key}` is missing"),
            Why::Other(words) if words == NOT_AN_ARRAY => format!("{words}; write its tables as [[{}]]", self.path),
            Why::Other(words) => match path::get(root, &self.path).and_then(|value| written_well(value, words)) {
                Some(hint) => format!("{words}; {hint}"),
                None => words.clone(),
            },
        }
    }

    /// What an unknown choice would have chosen.
    fn noun(&self) -> &'static str {
        if self.path.last() == "type" { "type" } else { "choice" }
    }
}

/// What the rewards' own crate says of an unknown reward, if the choice was one of rewards.
fn unknown_reward(tag: &str, known: &[String]) -> Option<String> {
    let error = check_tag(tag).err()?;
    let is_of_rewards = matches!(&error, RewardError::Unknown { known: rewards, .. } if known == rewards);
    is_of_rewards.then(|| match closest(tag, known) {
        Some(close) => format!("{error}. Did you mean `{close}`?"),
        None => error.to_string(),
    })
}

/// How to write a number that TOML reads as something else (`.9`, `"3"`, `1e3` where a whole one is wanted).
fn written_well(value: &Value, expected: &str) -> Option<String> {
    let number = match value {
        Value::Float(number) => *number,
        Value::String(text) => text.parse().ok()?,
        _ => return None,
    };
    if expected.starts_with("must be a whole number") {
        let is_whole = number.fract() == 0.0 && number >= 0.0;
        let fits = number < 2f64.powi(63);
        return is_whole.then(|| if fits { format!("write {number}") } else { "the greatest is 2^63 - 1".into() });
    }
    let is_wanted = expected.contains("a number") && number.is_finite() && value.is_str();
    is_wanted.then(|| format!("write {}", Value::Float(number)))
}

/// "unknown key" with a suggestion and the keys that the table `holder` has.
pub(crate) fn unknown_key<S: AsRef<str>>(key: &str, holder: &KeyPath, known: &[S]) -> String {
    let is_root = holder.segments().is_empty();
    let head = HEAD_KEYS.iter().filter(|_| is_root).copied();
    let known: Vec<&str> = head.chain(known.iter().map(AsRef::as_ref)).collect();
    let suggestion = did_you_mean(key, &known);
    match (known.is_empty(), is_root) {
        (true, _) => format!("unknown key `{key}`: `{holder}` has no keys"),
        (_, true) => format!("unknown key `{key}`{suggestion}Keys of a spec file: {}", list(&known)),
        _ => format!("unknown key `{key}`{suggestion}Keys of `{holder}`: {}", list(&known)),
    }
}

/// Parses `root` as a `T`.
pub(crate) fn parse<T: DeserializeOwned>(root: &Value) -> Result<T, Misfit> {
    serde_path_to_error::deserialize(root.clone()).map_err(|error| {
        let message = one_line(error.inner());
        let start = reached(error.path(), root);
        let path = culprit::<T>(root, start, &message);
        let why =
            if message.ends_with(" expected string only") { words_at::<T>(root, &path) } else { Why::of(&message) };
        Misfit { path, why }
    })
}

/// Which words are allowed at `path`, asked of the parser with a word that nothing is called.
pub(crate) fn words_at<T: DeserializeOwned>(root: &Value, path: &KeyPath) -> Why {
    let mut asked = root.clone();
    if let Some(value) = path::get_mut(&mut asked, path) {
        *value = Value::String("?".into());
    }
    let answer: Result<T, _> = asked.try_into();
    answer.map_or_else(|error| Why::of(&one_line(&error)), |_| Why::Other("must be a string".into()))
}

/// The first line of what serde says: the rest repeats the place.
fn one_line(error: &toml::de::Error) -> String {
    error.message().lines().next().unwrap_or_default().to_owned()
}

/// As much of serde's path as exists in `root`: serde ends it at the first table with a `type`.
fn reached(path: &Path, root: &Value) -> KeyPath {
    let mut reached = KeyPath::default();
    for segment in path {
        let next = match segment {
            Segment::Seq { index } => reached.join(index.to_string()),
            Segment::Map { key } => reached.join(key),
            Segment::Enum { .. } | Segment::Unknown => break,
        };
        if path::get(root, &next).is_none() {
            break;
        }
        reached = next;
    }
    reached
}

/// The first value below `start` that serde said `message` of.
///
/// Serde reads a table with a `type` through a buffer and forgets where in it an error was. But it stops at the first
/// error, so we take values away from the end, children before parents, until it says something else. That costs one
/// parse per value, on the way to an error only.
fn culprit<T: DeserializeOwned>(root: &Value, start: KeyPath, message: &str) -> KeyPath {
    let why = Why::of(message);
    let mut rest = root.clone();
    let mut still_says_it = |candidate: &KeyPath| {
        rest = path::without(&rest, candidate);
        let answer: Result<T, _> = rest.clone().try_into();
        answer.is_err_and(|error| one_line(&error) == message)
    };
    let candidates = path::descendants(root, &start).into_iter().rev();
    let mut candidates = candidates.filter(|candidate| why.may_be_at(root, candidate, message));
    candidates.find(|candidate| !still_says_it(candidate)).unwrap_or(start)
}

impl Why {
    /// What serde's `message` means.
    fn of(message: &str) -> Self {
        if message.starts_with("unknown field ") {
            Self::UnknownKey(expected_words(message))
        } else if message.starts_with("unknown variant ") {
            Self::UnknownChoice(expected_words(message))
        } else if let Some(key) = message.strip_prefix("missing field ") {
            Self::MissingKey(key.trim_matches('`').to_owned())
        } else {
            Self::Other(plain(message))
        }
    }

    /// Whether a problem of this kind can lie at `candidate`.
    fn may_be_at(&self, root: &Value, candidate: &KeyPath, message: &str) -> bool {
        let value = path::get(root, candidate);
        let subject = message.split('`').nth(1).unwrap_or_default();
        match self {
            Self::UnknownKey(_) => candidate.last() == subject,
            Self::UnknownChoice(_) => value.and_then(Value::as_str).unwrap_or(candidate.last()) == subject,
            Self::MissingKey(_) => value.is_some_and(Value::is_table),
            Self::Other(_) => candidate.last() != "type",
        }
    }
}

/// The words that serde puts in back quotes after "expected".
fn expected_words(message: &str) -> Vec<String> {
    let (_, expected) = message.rsplit_once(", expected ").unwrap_or_default();
    expected.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// "invalid type: string "x", expected f64" in words that need no Rust.
fn plain(message: &str) -> String {
    let Some((found, expected)) = message
        .strip_prefix("invalid type: ")
        .or_else(|| message.strip_prefix("invalid value: "))
        .and_then(|rest| rest.rsplit_once(", expected "))
    else {
        return message.to_owned();
    };
    let expected = match expected {
        "f64" | "f32" => "a number",
        "usize" | "u8" | "u16" | "u32" | "u64" => "a whole number, 0 or above",
        "isize" | "i8" | "i16" | "i32" | "i64" => "a whole number",
        "a boolean" => "true or false",
        "a sequence" => "an array",
        "a map" => "a table",
        other if ["struct ", "dyn ", "internally tagged enum "].iter().any(|p| other.starts_with(p)) => "a table",
        other => other,
    };
    match found {
        "map" => format!("must be {expected}, not a table"),
        "sequence" => format!("must be {expected}, not an array"),
        // Any other value stands in the message already.
        _ => format!("must be {expected}"),
    }
}
