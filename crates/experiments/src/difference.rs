//! In what two values of a spec differ, in words.

use toml::Value;

/// Differences that are told; the others are counted.
const N_TOLD: usize = 4;
/// Characters of a value that are shown.
const WIDTH: usize = 60;

/// In what `other` differs from `own`, leaf by leaf: `agent.gamma is 0.95 there, 0.9 here`; empty if in nothing.
pub(crate) fn in_words(there: &Value, here: &Value) -> String {
    let mut leaves = Vec::new();
    compare("", Some(there), Some(here), &mut leaves);
    let more = leaves.len().saturating_sub(N_TOLD);
    leaves.truncate(N_TOLD);
    if more > 0 {
        leaves.push(format!("and {more} more"));
    }
    leaves.join("; ")
}

/// Adds a line for every leaf in which two values differ; `None` is absent.
fn compare(path: &str, there: Option<&Value>, here: Option<&Value>, leaves: &mut Vec<String>) {
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
        _ => leaves.push(format!("{path} is {} there, {} here", words(there), words(here))),
    }
}

fn words(value: Option<&Value>) -> String {
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
    fn long_values_are_cut() {
        let long = format!("a = {:?}", "x".repeat(100));
        assert!(told(&long, "a = 1").contains("xxx ... there, 1 here"));
    }
}
