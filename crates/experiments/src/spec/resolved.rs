//! A spec with all defaults filled in, whose values can be replaced.

use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::{Table, Value};

use super::error::in_short;
use super::merge::chooses_anew;
use super::typed::{Misfit, parse, unknown_key};
use super::{KeyPath, path};

/// A spec as an object and as the TOML tree that it serialises to: every default is in the tree.
#[derive(Debug, Clone)]
pub(crate) struct Resolved<T> {
    pub(crate) spec: T,
    pub(crate) tree: Value,
}

/// Why a tree is no spec: what does not fit, explained.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Refusal {
    pub(crate) path: KeyPath,
    pub(crate) value: Option<String>,
    pub(crate) problem: String,
}

impl Refusal {
    /// `problem` of the value at `path` in `tree`.
    pub(crate) fn new(tree: &Value, path: KeyPath, problem: String) -> Self {
        let value = path::get(tree, &path).and_then(shown);
        Self { path, value, problem }
    }

    fn of(misfit: Misfit, tree: &Value) -> Self {
        let problem = misfit.explain(tree);
        Self::new(tree, misfit.path, problem)
    }

    /// That of an array in `given` where `tree` holds a table: serde would take its items for the fields, in order.
    fn of_array(given: &Value, tree: &Value) -> Option<Self> {
        let path = path::first_array_for_table(given, tree)?;
        let example = if path.last() == "seeds" { "; seeds 3 and 4 are { first = 3, count = 2 }" } else { "" };
        Some(Self::new(given, path, format!("must be a table, not an array{example}")))
    }
}

/// A value in a message; a table is named by its path alone.
fn shown(value: &Value) -> Option<String> {
    (!value.is_table()).then(|| in_short(value))
}

impl<T: Serialize + DeserializeOwned + Default> Resolved<T> {
    /// A spec with its tree.
    pub(crate) fn of(spec: T) -> Result<Self, Refusal> {
        match Value::try_from(&spec) {
            Ok(tree) => Ok(Self { spec, tree }),
            Err(error) => {
                let problem = format!("cannot be written as TOML: {error}");
                Err(Refusal { path: KeyPath::default(), value: None, problem })
            }
        }
    }

    /// Parses `table` and fills in the defaults.
    pub(crate) fn new(table: Table) -> Result<Self, Refusal> {
        Self::from_tree(Value::Table(table))
    }

    fn from_tree(given: Value) -> Result<Self, Refusal> {
        if let Some(path) = path::first_non_finite(&given) {
            return Err(Refusal::new(&given, path, "must be a finite number".into()));
        }
        let spec: T = parse(&given).map_err(|misfit| {
            let default = Value::try_from(T::default()).ok();
            let array = default.and_then(|tree| Refusal::of_array(&given, &tree));
            array.unwrap_or_else(|| Refusal::of(misfit, &given))
        })?;
        let tree = Value::try_from(&spec).map_err(|error| {
            let problem = format!("cannot be written as TOML: {error}");
            Refusal::new(&given, KeyPath::default(), problem)
        })?;
        Refusal::of_array(&given, &tree).map_or(Ok(Self { spec, tree }), Err)
    }

    /// Replaces the value at `path`, which must exist.
    ///
    /// A `preset` stands for a table of that preset.
    ///
    /// A table without a `type`, put where a table is, stands for its entries: `agent = { target = "dqn" }` sets
    /// `agent.target` and leaves the rest of `agent` as it is. Another `type` alone stands for a table of that type with its
    /// defaults: the keys of one type mean nothing to another.
    pub(crate) fn set(&mut self, path: &KeyPath, value: Value) -> Result<(), Refusal> {
        match value {
            value if self.is_another_type(path, &value) => {
                self.replace(&path.parent(), Value::Table(Table::from_iter([(path.last().to_owned(), value)])))
            }
            Value::Table(entries) if self.stands_for_its_entries(path, &entries) => {
                entries.into_iter().try_for_each(|(key, value)| {
                    let refuse = |problem| Refusal { path: path.clone(), value: None, problem };
                    let further: KeyPath = key.parse().map_err(refuse)?;
                    self.set(&path.extend(&further), value)
                })
            }
            value => self.replace(path, value),
        }
    }

    fn stands_for_its_entries(&self, path: &KeyPath, entries: &Table) -> bool {
        let old = path::get(&self.tree, path).and_then(Value::as_table);
        // The keys of `randomize` are paths themselves.
        path.last() != "randomize"
            && old.is_some_and(|old| !entries.contains_key("type") && !chooses_anew(old, entries))
    }

    fn is_another_type(&self, path: &KeyPath, value: &Value) -> bool {
        let is_type = path.last() == "type" && path::get(&self.tree, path).is_some_and(|old| old != value);
        is_type || path.last() == "preset"
    }

    fn replace(&mut self, path: &KeyPath, value: Value) -> Result<(), Refusal> {
        self.check_way(path, &value)?;
        let mut tree = self.tree.clone();
        match path::get_mut(&mut tree, &path.parent()) {
            // An optional key that is not set is missing from the tree: parsing tells it from an unknown one.
            Some(Value::Table(table)) => drop(table.insert(path.last().into(), value.clone())),
            _ => *path::get_mut(&mut tree, path).ok_or_else(|| self.unknown(path, &value))? = value.clone(),
        }
        let next = Self::from_tree(tree)?;
        if path::get(&next.tree, path).is_none() {
            return Err(self.unknown(path, &value));
        }
        *self = next;
        Ok(())
    }

    /// Refuses a path whose holder does not exist.
    fn check_way(&self, path: &KeyPath, value: &Value) -> Result<(), Refusal> {
        let mut way = KeyPath::default();
        for segment in path.parent().segments() {
            way = way.join(segment);
            if path::get(&self.tree, &way).is_none() {
                return Err(Refusal { path: path.clone(), ..self.unknown(&way, value) });
            }
        }
        Ok(())
    }

    /// The refusal of a path that does not exist, although its parent does.
    fn unknown(&self, path: &KeyPath, value: &Value) -> Refusal {
        let (holder, key) = (path.parent(), path.last());
        let problem = match path::get(&self.tree, &holder) {
            Some(Value::Table(table)) => {
                let known: Vec<&String> = table.keys().collect();
                unknown_key(key, &holder, &known)
            }
            Some(Value::Array(items)) => match items.len() {
                0 => format!("no entry {key}: `{holder}` is empty"),
                n => format!("no entry {key}: `{holder}` has entries 0 to {}", n - 1),
            },
            _ => format!("`{holder}` is one value and has no keys"),
        };
        Refusal { path: path.clone(), value: shown(value), problem }
    }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
    enum Shape {
        Disc { radius: f64 },
        Box { length: f64, width: f64 },
        Ring(Ring),
    }

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    struct Ring {
        inner: f64,
    }

    impl Default for Ring {
        fn default() -> Self {
            Self { inner: 0.5 }
        }
    }

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    struct Small {
        speed: f64,
        count: usize,
        note: Option<String>,
        shapes: Vec<Shape>,
        inner: Inner,
    }

    #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    struct Inner {
        a: f64,
        b: f64,
    }

    impl Default for Small {
        fn default() -> Self {
            let shapes = vec![Shape::Disc { radius: 1.0 }, Shape::Box { length: 2.0, width: 3.0 }];
            Self { speed: 1.5, count: 3, note: None, shapes, inner: Inner { a: 1.0, b: 2.0 } }
        }
    }

    /// The default after one replacement.
    fn after(set: &str) -> Result<Small, Refusal> {
        let mut small: Resolved<Small> = Resolved::new(Table::new())?;
        let set: super::super::Assignment = set.parse().unwrap();
        small.set(&set.path, set.value).map(|()| small.spec)
    }

    #[test]
    fn a_value_at_a_path_is_replaced() {
        let default = Small::default;
        assert_eq!(after("speed=2"), Ok(Small { speed: 2.0, ..default() }));
        assert_eq!(after("shapes.0.radius=2").unwrap().shapes[0], Shape::Disc { radius: 2.0 });
        assert_eq!(after("inner.b=5"), Ok(Small { inner: Inner { a: 1.0, b: 5.0 }, ..default() }));
        let disc = Shape::Disc { radius: 0.5 };
        assert_eq!(after("shapes.1={ type = 'disc', radius = 0.5 }").unwrap().shapes[1], disc);
        assert_eq!(after("shapes=[]").unwrap().shapes, []);
    }

    #[test]
    fn a_table_without_a_type_stands_for_its_entries() {
        assert_eq!(after("inner={ b = 5 }").unwrap().inner, Inner { a: 1.0, b: 5.0 });
    }

    #[test]
    fn another_type_alone_stands_for_a_table_of_that_type() {
        assert_eq!(after("shapes.0.type=ring").unwrap().shapes[0], Shape::Ring(Ring { inner: 0.5 }));
        assert_eq!(after("shapes.0.type=disc").unwrap(), Small::default(), "the same type changes nothing");
        let refusal = after("shapes.0.type=box").unwrap_err();
        assert_eq!(
            (refusal.path.to_string(), refusal.problem),
            ("shapes.0".into(), "the key `length` is missing".into())
        );
    }

    #[test]
    fn an_optional_key_exists_although_it_is_not_set() {
        assert_eq!(after("note=hello").unwrap().note.as_deref(), Some("hello"));
    }

    #[test]
    fn refusals_name_the_path_and_what_exists() {
        for (set, expected) in [
            ("sped=1", "sped: unknown key `sped`; did you mean `speed`?"),
            ("inner.c=1", "inner.c: unknown key `c`. Keys of `inner`: `a`, `b`"),
            ("iner.a=1", "iner.a: unknown key `iner`; did you mean `inner`?"),
            ("shapes.2.radius=1", "shapes.2.radius: no entry 2: `shapes` has entries 0 to 1"),
            ("shapes.x=1", "shapes.x: no entry x: `shapes` has entries 0 to 1"),
            ("speed.x=1", "speed.x: `speed` is one value and has no keys"),
            ("speed=fast", "speed: must be a number"),
            ("speed=nan", "speed: must be a finite number"),
            ("count=-1", "count: must be a whole number, 0 or above"),
            ("count=1.5", "count: must be a whole number, 0 or above"),
            ("count=[]", "count: must be a whole number, 0 or above, not an array"),
            ("inner=1", "inner: must be a table"),
            // Serde takes a sequence for the fields of a struct, in order.
            ("inner=[]", "inner: must be a table, not an array"),
            ("inner=[3.0]", "inner: must be a table, not an array"),
            ("inner=['x', 1, 2]", "inner: must be a table, not an array"),
            ("shapes.0=['disc', 1.0]", "shapes.0: must be a table, not an array"),
            ("shapes=[['ring', 0.1]]", "shapes.0: must be a table, not an array"),
            ("speed=.9", "speed: must be a number; write 0.9"),
            ("speed=1.", "speed: must be a number; write 1.0"),
            ("speed='2'", "speed: must be a number; write 2.0"),
            ("count=1e3", "count: must be a whole number, 0 or above; write 1000"),
            ("count=+.5", "count: must be a whole number, 0 or above"),
            ("count=18446744073709551615", "count: must be a whole number, 0 or above; the greatest is 2^63 - 1"),
            ("shapes.0.radius=x", "shapes.0.radius: must be a number"),
            ("shapes.1.widht=1", "shapes.1.widht: unknown key `widht`; did you mean `width`?"),
            ("shapes.1.type=bax", "shapes.1.type: unknown type; did you mean `box`? Known: `disc`, `box`, `ring`"),
            ("shapes.1={ type = 'box', length = 1 }", "shapes.1: the key `width` is missing"),
            (
                "shapes=[{ type = 'disc', radius = 1 }, { type = 'disc', radius = inf }]",
                "shapes.1.radius: must be a fin",
            ),
        ] {
            let refusal = after(set).unwrap_err();
            let text = format!("{}: {}", refusal.path, refusal.problem);
            assert!(text.starts_with(expected), "{set}\n  gives    {text}\n  expected {expected}");
        }
    }

    #[test]
    fn of_two_equal_keys_the_misplaced_one_is_named() {
        // serde's own path ends at the array: `radius` is right in the first entry and wrong in the second.
        let set = "shapes=[{ type = 'disc', radius = 1 }, { type = 'box', length = 1, width = 1, radius = 1 }]";
        assert_eq!(after(set).unwrap_err().path.to_string(), "shapes.1.radius");
    }

    #[test]
    fn of_two_equal_mistakes_the_first_one_is_named() {
        let set = "shapes=[{ type = 'disc', radius = 1 }, { type = 'disc', radus = 1 }, { type = 'disc', radus = 1 }]";
        assert_eq!(after(set).unwrap_err().path.to_string(), "shapes.1.radus");
        let set =
            "shapes=[{ type = 'disc', radius = 1 }, { type = 'disc', radius = 'x' }, { type = 'disc', radius = 'x' }]";
        assert_eq!(after(set).unwrap_err().path.to_string(), "shapes.1.radius");
        assert_eq!(
            after("shapes=[{ type = 'disk' }, { type = 'disk' }]").unwrap_err().path.to_string(),
            "shapes.0.type"
        );
    }
}
