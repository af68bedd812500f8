//! In what two values of a spec differ, in words, and in what several do.

mod several;

pub(crate) use several::{Given, partings};

use std::collections::BTreeMap;

use toml::Value;

/// Differences that are told; the others are counted.
const N_TOLD: usize = 4;
/// Characters of a value that are shown.
const WIDTH: usize = 60;

/// A leaf in which two values differ; `None` is absent.
struct Leaf<'v> {
    path: String,
    there: Option<&'v Value>,
    here: Option<&'v Value>,
}

/// In what `here` differs from `there`, leaf by leaf: `agent.gamma is 0.95 there, 0.9 here`; empty if in nothing.
pub(crate) fn in_words(there: &Value, here: &Value) -> String {
    let leaves = leaves(there, here);
    let told = leaves.iter().take(N_TOLD);
    let mut told: Vec<String> = told
        .map(|Leaf { path, there, here }| format!("{path} is {} there, {} here", words(*there), words(*here)))
        .collect();
    if leaves.len() > N_TOLD {
        told.push(format!("and {} more", leaves.len() - N_TOLD));
    }
    told.join("; ")
}

/// What `here` has where it differs from `there`, by dotted paths; `None` where it has nothing.
pub(crate) fn changes(there: &Value, here: &Value) -> BTreeMap<String, Option<Value>> {
    leaves(there, here).into_iter().map(|leaf| (leaf.path, leaf.here.cloned())).collect()
}

fn leaves<'v>(there: &'v Value, here: &'v Value) -> Vec<Leaf<'v>> {
    let mut leaves = Vec::new();
    compare("", Some(there), Some(here), &mut leaves);
    leaves
}

/// Adds every leaf in which two values differ.
fn compare<'v>(path: &str, there: Option<&'v Value>, here: Option<&'v Value>, leaves: &mut Vec<Leaf<'v>>) {
    let join = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match (there, here) {
        (Some(there), Some(here)) if there == here => {}
        (Some(Value::Table(there)), Some(Value::Table(here))) => {
            let added = here.keys().filter(|key| !there.contains_key(*key));
            for key in there.keys().chain(added) {
                compare(&join(key), there.get(key), here.get(key), leaves);
            }
        }
        (Some(Value::Array(there)), Some(Value::Array(here))) if there.len() == here.len() => {
            for (index, (there, here)) in there.iter().zip(here).enumerate() {
                compare(&join(&index.to_string()), Some(there), Some(here), leaves);
            }
        }
        _ => leaves.push(Leaf { path: path.to_owned(), there, here }),
    }
}

/// A value in as many characters as there is room for.
pub(crate) fn words(value: Option<&Value>) -> String {
    let text = value.map_or_else(|| "absent".to_owned(), ToString::to_string);
    let mut shown: String = text.chars().take(WIDTH).collect();
    if shown.len() < text.len() {
        shown.push_str(" ...");
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(there: &str, here: &str) -> String {
        let value = |text: &str| Value::Table(toml::from_str(text).unwrap());
        in_words(&value(there), &value(here))
    }

    #[test]
    fn leaves_are_told_by_path() {
        assert_eq!(told("a = 1\nb.c = [1, 2]", "a = 1\nb.c = [1, 2]"), "");
        assert_eq!(told("a = 1\nb.c = [1, 2]", "a = 1\nb.c = [1, 3]"), "b.c.1 is 2 there, 3 here");
        assert_eq!(told("b.c = [1, 2]", "b.c = [1]"), "b.c is [1, 2] there, [1] here");
        assert_eq!(
            told("r.type = \"r\"\nr.x = 1.5", "r.type = \"sum\"\nr.y = 2"),
            "r.type is \"r\" there, \"sum\" here; r.x is 1.5 there, absent here; r.y is absent there, 2 here"
        );
        assert!(told("a=1\nb=1\nc=1\nd=1\ne=1\nf=1", "a=2\nb=2\nc=2\nd=2\ne=2\nf=2").ends_with("; and 2 more"));
    }

    #[test]
    fn changes_hold_what_is_new() {
        let value = |text: &str| Value::Table(toml::from_str(text).unwrap());
        let changes = changes(&value("a.b = 1\nc = 2\nd = 3"), &value("a.b = 5\nc = 2\ne = 4"));
        let expected = [("a.b", Some(5)), ("d", None), ("e", Some(4))];
        assert_eq!(changes, expected.map(|(path, new)| (path.to_owned(), new.map(Value::Integer))).into());
    }

    #[test]
    fn long_values_are_cut() {
        let long = format!("a = {:?}", "x".repeat(100));
        assert!(told(&long, "a = 1").contains("xxx ... there, 1 here"));
    }
}
