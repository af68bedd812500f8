//! Ids: hashes of all that determines a result.

use std::fmt::{self, Display};
use std::path::Path;

use headway_planning::ShieldSpec;
use serde::{Deserialize, Serialize};

use super::RESULTS_VERSION;
use super::done::digest;
use super::error::{StoreError, unserialisable};

/// Number of hexadecimal digits of an id: 64 bits.
const N_DIGITS: usize = 16;

/// The name of a run's or an evaluation's folder: the first 16 hexadecimal digits of a SHA-256 hash.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Id(String);

impl Id {
    /// The id as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    fn of(key: &impl Serialize) -> Result<Self, StoreError> {
        let value = toml::Value::try_from(key).map_err(unserialisable(Path::new("spec.toml")))?;
        let mut text = String::new();
        write_canonical(&value, &mut text);
        Ok(Self(digest(text.as_bytes())[..N_DIGITS].to_owned()))
    }
}

impl Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// All that determines what a training run learns, [`RESULTS_VERSION`] aside.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct TrainKey<'a, S: ?Sized> {
    /// The resolved training spec: no level names, no evaluation.
    pub spec: &'a S,
    /// The seed of the run.
    pub seed: u64,
    /// The version of the reward, which a plugin raises when the same fields pay differently.
    pub reward_version: u32,
}

impl<S: Serialize + ?Sized> TrainKey<'_, S> {
    /// The id of the run.
    ///
    /// # Errors
    /// [`StoreError::Serialise`] if the spec has no TOML form.
    pub fn id(&self) -> Result<Id, StoreError> {
        Id::of(&Versioned { kind: "train", results_version: RESULTS_VERSION, key: self })
    }
}

/// All that determines an evaluation of a given run, [`RESULTS_VERSION`] aside; also the evaluation's `spec.toml`.
#[derive(Debug, Clone, Serialize)]
pub struct EvaluationKey<'a, W: ?Sized> {
    /// Number of episodes.
    pub n_episodes: usize,
    /// The seed of the held-out scenarios.
    pub seed: u64,
    /// Time after which an episode is a timeout, s.
    pub time_limit: f64,
    /// SHA-256 of the files that the world comes from, if it comes from files.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<String>,
    /// The shield around whoever drives, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shield: Option<ShieldSpec>,
    /// The spec of the world; its name in the report does not count.
    pub world: &'a W,
}

impl<W: Serialize + ?Sized> EvaluationKey<'_, W> {
    /// The id of the evaluation.
    ///
    /// # Errors
    /// [`StoreError::Serialise`] if the spec has no TOML form.
    pub fn id(&self) -> Result<Id, StoreError> {
        Id::of(&Versioned { kind: "evaluation", results_version: RESULTS_VERSION, key: self })
    }
}

#[derive(Serialize)]
struct Versioned<'a, K> {
    kind: &'static str,
    results_version: u32,
    key: &'a K,
}

/// The value as one line in which equal values look equal: tables sorted by key, numbers in their shortest exact form.
///
/// JSON would not do: it has no infinity, and a spec may hold one.
fn write_canonical(value: &toml::Value, text: &mut String) {
    match value {
        toml::Value::Table(table) => {
            let mut entries: Vec<_> = table.iter().collect();
            entries.sort_by_key(|(key, _)| *key);
            text.push('{');
            for (key, value) in entries {
                text.push_str(&quoted(key));
                text.push(':');
                write_canonical(value, text);
                text.push(',');
            }
            text.push('}');
        }
        toml::Value::Array(values) => {
            text.push('[');
            for value in values {
                write_canonical(value, text);
                text.push(',');
            }
            text.push(']');
        }
        toml::Value::String(string) => text.push_str(&quoted(string)),
        toml::Value::Float(number) => text.push_str(&format!("{number:?}")),
        toml::Value::Integer(number) => text.push_str(&number.to_string()),
        toml::Value::Boolean(boolean) => text.push_str(&boolean.to_string()),
        toml::Value::Datetime(datetime) => text.push_str(&datetime.to_string()),
    }
}

fn quoted(string: &str) -> String {
    serde_json::Value::from(string).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn train(spec: &impl Serialize, seed: u64, reward_version: u32) -> Id {
        TrainKey { spec, seed, reward_version }.id().expect("has a TOML form")
    }

    fn evaluation(n_episodes: usize, seed: u64, time_limit: f64, world: &str) -> Id {
        let world = &json!({ "type": world });
        EvaluationKey { n_episodes, seed, time_limit, files: Vec::new(), shield: None, world }
            .id()
            .expect("has a TOML form")
    }

    #[test]
    fn the_canonical_text() {
        let value: toml::Value =
            toml::from_str::<toml::Table>("b = [1, 2.0]\na.y = inf\na.x = '\"'\nc = 1e-7").unwrap().into();
        let mut text = String::new();
        write_canonical(&value, &mut text);
        assert_eq!(text, r#"{"a":{"x":"\"","y":inf,},"b":[1,2.0,],"c":1e-7,}"#);
    }

    #[test]
    fn the_order_of_fields_does_not_count_and_everything_else_does() {
        #[derive(Serialize)]
        struct One {
            gamma: f64,
            beams: u32,
        }
        #[derive(Serialize)]
        struct Other {
            beams: u32,
            gamma: f64,
        }
        let id = train(&One { gamma: 0.95, beams: 36 }, 0, 1);
        assert_eq!(id.as_str().len(), N_DIGITS);
        assert_eq!(id, train(&Other { beams: 36, gamma: 0.95 }, 0, 1));
        assert_ne!(id, train(&One { gamma: 0.96, beams: 36 }, 0, 1));
        assert_ne!(id, train(&One { gamma: 0.95, beams: 36 }, 1, 1));
        assert_ne!(id, train(&One { gamma: 0.95, beams: 36 }, 0, 2));
        assert_ne!(
            train(&One { gamma: f64::INFINITY, beams: 36 }, 0, 1),
            train(&One { gamma: f64::NAN, beams: 36 }, 0, 1)
        );
    }

    #[test]
    fn evaluations_have_ids_of_their_own() {
        let id = evaluation(100, 7, 60.0, "room");
        assert_eq!(id, evaluation(100, 7, 60.0, "room"));
        for other in [
            evaluation(101, 7, 60.0, "room"),
            evaluation(100, 8, 60.0, "room"),
            evaluation(100, 7, 61.0, "room"),
            evaluation(100, 7, 60.0, "hall"),
        ] {
            assert_ne!(id, other);
        }
    }

    #[test]
    fn ids_do_not_drift() {
        // If this fails, every results folder in the world is recomputed: raise RESULTS_VERSION instead.
        assert_eq!(train(&json!({ "gamma": 0.95 }), 3, 1).as_str(), "f5a75f82ccc99f26");
    }
}
