//! The words that a key of a spec takes.

use toml::Value;

use super::typed::{Why, words_at};
use super::{KeyPath, RunSpec, path};

/// The words that the key at a dotted path takes; none where it takes no words, or does not exist.
///
/// They are asked of the parser itself, with a word that nothing is called.
///
/// ```
/// use headway_experiments::spec::choices;
/// assert_eq!(choices("world.type"), ["room", "room_10x15", "room_25x25", "barn", "files", "mixture"]);
/// assert!(choices("agent.gamma").is_empty());
/// ```
pub fn choices(path: &str) -> Vec<String> {
    let path: KeyPath = path.parse().unwrap_or_default();
    let words = Value::try_from(RunSpec::default())
        .ok()
        .filter(|tree| path::get(tree, &path).is_some_and(Value::is_str))
        .map(|tree| words_at::<RunSpec>(&tree, &path));
    match words {
        Some(Why::UnknownChoice(words)) => words,
        _ => Vec::new(),
    }
}
