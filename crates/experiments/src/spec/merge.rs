//! Laying one table over another: a spec file over its base.

use toml::{Table, Value};

/// Lays `over` on `base`: tables merge key by key, everything else is replaced.
///
/// A table that makes another choice than the base's replaces it whole, since the keys of one choice mean nothing to
/// another. Arrays are replaced whole.
pub(crate) fn merge(base: &mut Table, over: Table) {
    for (key, value) in over {
        match (base.get_mut(&key), value) {
            (Some(Value::Table(old)), Value::Table(new)) if !chooses_anew(old, &new) => {
                merge(old, new);
            }
            (_, value) => {
                base.insert(key, value);
            }
        }
    }
}

/// Keys of which a table holds one: `obstacles = { count = 12 }` or `{ density = 0.1 }`.
const ALTERNATIVES: [&str; 2] = ["count", "density"];

/// Whether `new` is another kind of thing than `old`: it names another `type`, a `preset`, or another alternative.
pub(crate) fn chooses_anew(old: &Table, new: &Table) -> bool {
    let alternative = |table: &Table| ALTERNATIVES.into_iter().find(|key| table.contains_key(*key));
    let changes_type = new.contains_key("type") && new.get("type") != old.get("type");
    // A preset says all that the table leaves out.
    changes_type
        || new.contains_key("preset")
        || matches!((alternative(old), alternative(new)), (Some(old), Some(new)) if old != new)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Base, over, and what comes of them.
    const CASES: &[(&str, &str, &str)] = &[
        ("a = 1\nb = 2", "b = 3\nc = 4", "a = 1\nb = 3\nc = 4"),
        ("[t]\na = 1\nb = 2", "[t]\nb = 3", "[t]\na = 1\nb = 3"),
        ("x = [1, 2]", "x = [3]", "x = [3]"),
        // The same type merges, another one replaces.
        ("r = { type = 'r', a = 1 }", "r = { type = 'r', b = 2 }", "r = { type = 'r', a = 1, b = 2 }"),
        ("r = { type = 'r', a = 1 }", "r = { type = 'q', b = 2 }", "r = { type = 'q', b = 2 }"),
        ("r = { type = 'r', a = 1 }", "r = { b = 2 }", "r = { type = 'r', a = 1, b = 2 }"),
        // The rule holds in any depth.
        (
            "[v]\nm = 1\nf = { type = 'disc', radius = 1 }",
            "[v]\nf = { type = 'box', length = 1 }",
            "[v]\nm = 1\nf = { type = 'box', length = 1 }",
        ),
        ("n = { count = 3 }", "n = { density = 0.1 }", "n = { density = 0.1 }"),
        ("n = { first = 1, count = 3 }", "n = { count = 4 }", "n = { first = 1, count = 4 }"),
        ("t = 1", "t = { a = 1 }", "t = { a = 1 }"),
        ("v = { a = 1, b = 2 }", "v = { preset = 'p', b = 3 }", "v = { preset = 'p', b = 3 }"),
    ];

    #[test]
    fn cases() {
        for (base, over, expected) in CASES {
            let mut merged: Table = toml::from_str(base).unwrap();
            merge(&mut merged, toml::from_str(over).unwrap());
            assert_eq!(merged, toml::from_str::<Table>(expected).unwrap(), "{base} + {over}");
        }
    }

    #[test]
    fn merging_over_itself_changes_nothing() {
        for (base, ..) in CASES {
            let table: Table = toml::from_str(base).unwrap();
            let mut merged = table.clone();
            merge(&mut merged, table.clone());
            assert_eq!(merged, table);
        }
    }
}
