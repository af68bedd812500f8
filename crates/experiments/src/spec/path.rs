//! Dotted paths into a tree of TOML values.

use std::fmt;
use std::str::FromStr;

use toml::Value;

/// A dotted path into a spec, as in `reward.terms.1.weight`; numbers index arrays.
///
/// ```
/// use headway_experiments::spec::KeyPath;
/// let path: KeyPath = "reward.terms.1.weight".parse()?;
/// assert_eq!(path.segments(), ["reward", "terms", "1", "weight"]);
/// assert!("reward..weight".parse::<KeyPath>().is_err());
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct KeyPath(Vec<String>);

impl KeyPath {
    /// The path of these segments.
    pub(crate) fn new<S: Into<String>>(segments: impl IntoIterator<Item = S>) -> Self {
        Self(segments.into_iter().map(Into::into).collect())
    }

    /// Its segments, from the root.
    pub fn segments(&self) -> &[String] {
        &self.0
    }

    /// The first segment: the table's name.
    pub(crate) fn first(&self) -> &str {
        self.0.first().map_or("", String::as_str)
    }

    /// The last segment: the key's name.
    pub(crate) fn last(&self) -> &str {
        self.0.last().map_or("", String::as_str)
    }

    /// The path of the table or array that holds this one.
    pub(crate) fn parent(&self) -> Self {
        Self(self.0[..self.0.len().saturating_sub(1)].to_vec())
    }

    /// This path, one segment longer.
    pub(crate) fn join(&self, segment: impl Into<String>) -> Self {
        let mut longer = self.clone();
        longer.0.push(segment.into());
        longer
    }

    /// This path followed by `further`.
    pub(crate) fn extend(&self, further: &Self) -> Self {
        Self(self.0.iter().chain(&further.0).cloned().collect())
    }

    /// What of this path lies beyond `base`; nothing where `base` is longer.
    pub(crate) fn below(&self, base: &Self) -> Self {
        Self(self.0.get(base.0.len()..).unwrap_or_default().to_vec())
    }

    /// Whether `self` leads to `other` or to something that holds it.
    pub(crate) fn is_prefix_of(&self, other: &Self) -> bool {
        other.0.starts_with(&self.0)
    }
}

impl fmt::Display for KeyPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join("."))
    }
}

impl FromStr for KeyPath {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let segments = text.trim().split('.').map(str::trim);
        if segments.clone().any(str::is_empty) {
            return Err(format!("`{text}` is no dotted path such as agent.gamma"));
        }
        Ok(Self::new(segments))
    }
}

/// The value one segment below `value`.
fn child<'v>(value: &'v Value, segment: &str) -> Option<&'v Value> {
    match value {
        Value::Table(table) => table.get(segment),
        Value::Array(items) => items.get(segment.parse::<usize>().ok()?),
        _ => None,
    }
}

/// The value one segment below `value`.
fn child_mut<'v>(value: &'v mut Value, segment: &str) -> Option<&'v mut Value> {
    match value {
        Value::Table(table) => table.get_mut(segment),
        Value::Array(items) => items.get_mut(segment.parse::<usize>().ok()?),
        _ => None,
    }
}

/// The value at `path` under `root`.
pub(crate) fn get<'v>(root: &'v Value, path: &KeyPath) -> Option<&'v Value> {
    path.0.iter().try_fold(root, |value, segment| child(value, segment))
}

/// The value at `path` under `root`.
pub(crate) fn get_mut<'v>(root: &'v mut Value, path: &KeyPath) -> Option<&'v mut Value> {
    path.0.iter().try_fold(root, |value, segment| child_mut(value, segment))
}

/// `root` without what `path` leads to, which must exist.
pub(crate) fn without(root: &Value, path: &KeyPath) -> Value {
    let mut rest = root.clone();
    match get_mut(&mut rest, &path.parent()) {
        Some(Value::Table(table)) => drop(table.remove(path.last())),
        Some(Value::Array(items)) => {
            if let Some(index) = path.last().parse().ok().filter(|i| *i < items.len()) {
                items.remove(index);
            }
        }
        _ => {}
    }
    rest
}

/// Every path below `base`, parents before children.
pub(crate) fn descendants(root: &Value, base: &KeyPath) -> Vec<KeyPath> {
    let segments: Vec<String> = match get(root, base) {
        Some(Value::Table(table)) => table.keys().cloned().collect(),
        Some(Value::Array(items)) => (0..items.len()).map(|i| i.to_string()).collect(),
        _ => Vec::new(),
    };
    segments
        .into_iter()
        .map(|segment| base.join(segment))
        .flat_map(|path| {
            let below = descendants(root, &path);
            std::iter::once(path).chain(below)
        })
        .collect()
}

/// The path of the first NaN or infinity in `root`.
pub(crate) fn first_non_finite(root: &Value) -> Option<KeyPath> {
    let not_finite = |value: &Value| value.as_float().is_some_and(|x| !x.is_finite());
    if not_finite(root) {
        return Some(KeyPath::default());
    }
    descendants(root, &KeyPath::default()).into_iter().find(|path| get(root, path).is_some_and(not_finite))
}

/// The path of the first array in `given` where `tree` holds a table.
pub(crate) fn first_array_for_table(given: &Value, tree: &Value) -> Option<KeyPath> {
    let is_one =
        |path: &KeyPath| get(given, path).is_some_and(Value::is_array) && get(tree, path).is_some_and(Value::is_table);
    descendants(given, &KeyPath::default()).into_iter().find(is_one)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree() -> Value {
        toml::from_str("a = 1\n[b]\nc = [1.0, { d = nan }]").unwrap()
    }

    #[test]
    fn numbers_index_arrays() {
        let path = "b.c.0".parse().unwrap();
        assert_eq!(get(&tree(), &path), Some(&Value::Float(1.0)));
        assert_eq!(get(&tree(), &"b.c.2".parse().unwrap()), None);
        assert_eq!(get(&tree(), &"a.x".parse().unwrap()), None);
    }

    #[test]
    fn descendants_come_after_their_parents() {
        let paths: Vec<_> = descendants(&tree(), &KeyPath::default()).iter().map(KeyPath::to_string).collect();
        assert_eq!(paths, ["a", "b", "b.c", "b.c.0", "b.c.1", "b.c.1.d"]);
    }

    #[test]
    fn a_non_finite_float_is_found_in_any_depth() {
        assert_eq!(first_non_finite(&tree()).unwrap().to_string(), "b.c.1.d");
        assert_eq!(first_non_finite(&without(&tree(), &"b.c.1".parse().unwrap())), None);
    }
}
