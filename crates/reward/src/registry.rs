use crate::serde_error::SerdeError;
use crate::{Reward, RewardError};
use serde::Deserialize;
use serde::de::value::MapDeserializer;
use std::sync::Arc;

/// One kind of reward that specs can name in this binary.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The name, the value of `type` in a spec.
    pub tag: &'static str,
    /// The reward with every field at its default, or why there is none; serialise it to show the fields.
    pub default: Result<Arc<dyn Reward>, RewardError>,
}

/// All kinds of reward that specs can name in this binary, sorted by tag: ours and those of the plugins linked into it.
///
/// ```
/// let entries = headway_reward::registry()?;
/// let proximity = entries.into_iter().find(|entry| entry.tag == "proximity").expect("ours");
/// assert_eq!(toml::to_string(&*proximity.default?)?, "type = \"proximity\"\nmargin = 0.2\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RewardError::Duplicate`] where two rewards have the same tag, since neither could be loaded.
pub fn registry() -> Result<Vec<Entry>, RewardError> {
    let tags = tags();
    match tags.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(RewardError::Duplicate { tag: pair[0] }),
        None => Ok(tags.into_iter().map(entry).collect()),
    }
}

/// Whether a spec may name a reward `tag`; for a message better than serde's own, which knows nothing of plugins.
///
/// ```
/// use headway_reward::check_tag;
///
/// assert_eq!(check_tag("r_couple"), Ok(()));
/// let message = check_tag("smooth/needless_braking").unwrap_err().to_string();
/// assert!(message.starts_with("unknown reward `smooth/needless_braking`: this binary knows "));
/// assert!(message.contains("`use my_rewards as _;`"));
/// ```
///
/// # Errors
/// [`RewardError::Unknown`] where no reward has this tag, [`RewardError::Duplicate`] where several have.
pub fn check_tag(tag: &str) -> Result<(), RewardError> {
    let known = tags();
    let mut found = known.iter().filter(|known| **known == tag);
    match (found.next(), found.next()) {
        (Some(_), None) => Ok(()),
        (Some(tag), Some(_)) => Err(RewardError::Duplicate { tag }),
        (None, _) => Err(unknown(tag, known)),
    }
}

fn unknown(tag: &str, mut known: Vec<&'static str>) -> RewardError {
    known.dedup();
    RewardError::Unknown { tag: tag.to_owned(), known }
}

fn entry(tag: &'static str) -> Entry {
    Entry { tag, default: default_of(tag).map(Arc::from) }
}

/// The reward that `{ type = tag }` alone loads.
pub(crate) fn default_of(tag: &str) -> Result<Box<dyn Reward>, RewardError> {
    load(tag).map_err(|error| RewardError::NoDefault { tag: tag.to_owned(), reason: error.to_string() })
}

/// All registered tags, sorted; one that is registered twice occurs twice.
fn tags() -> Vec<&'static str> {
    // No reward can be named so, hence this asks for the list.
    match load("\0") {
        Err(SerdeError::UnknownVariant(known)) => known.to_vec(),
        _ => Vec::new(),
    }
}

fn load(tag: &str) -> Result<Box<dyn Reward>, SerdeError> {
    Deserialize::deserialize(MapDeserializer::new(std::iter::once(("type", tag))))
}
