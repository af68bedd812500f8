//! In what several values of a spec differ.

use toml::Value;

/// A path at which several values differ, with what each of them has there.
#[derive(Debug, PartialEq)]
pub(crate) struct Parting<'v> {
    pub(crate) path: String,
    /// One per value.
    pub(crate) given: Vec<Given<'v>>,
}

/// What a value has at a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Given<'v> {
    Is(&'v Value),
    Absent,
    /// Not even the table that it would be in.
    NoTable,
}

/// Where values differ. A table that only some have stands for itself, and what is in it differs among those that have it;
/// tables of different `type` differ as a whole.
pub(crate) fn partings<'v>(values: &[&'v Value]) -> Vec<Parting<'v>> {
    let mut partings = Vec::new();
    let given: Vec<_> = values.iter().map(|value| Given::Is(value)).collect();
    compare("", &given, &mut partings);
    partings
}

/// Adds every path below `path` at which the values differ.
fn compare<'v>(path: &str, given: &[Given<'v>], partings: &mut Vec<Parting<'v>>) {
    let mut known = given.iter().filter(|given| **given != Given::NoTable);
    let first = known.next();
    if known.all(|given| Some(given) == first) {
        return;
    }
    let keys = keys(given);
    if keys.is_none() || given.contains(&Given::Absent) {
        partings.push(Parting { path: path.to_owned(), given: given.to_vec() });
    }
    for key in keys.unwrap_or_default() {
        let below: Vec<_> = given.iter().map(|given| given.below(&key)).collect();
        let path = if path.is_empty() { key } else { format!("{path}.{key}") };
        compare(&path, &below, partings);
    }
}

/// The keys of tables, or of lists of as many tables, that can be told apart by what is in them; `None` of all else.
fn keys(given: &[Given<'_>]) -> Option<Vec<String>> {
    let values = || given.iter().filter_map(|given| if let Given::Is(value) = given { Some(*value) } else { None });
    let first = values().next()?;
    if let Value::Array(list) = first {
        let is_alike = |value: &Value| {
            value.as_array().is_some_and(|other| other.len() == list.len() && other.iter().all(Value::is_table))
        };
        return values().all(is_alike).then(|| (0..list.len()).map(|index| index.to_string()).collect());
    }
    let mut keys: Vec<String> = Vec::new();
    for value in values() {
        let table = value.as_table().filter(|_| value.get("type") == first.get("type"))?;
        let added: Vec<_> = table.keys().filter(|key| !keys.contains(key)).cloned().collect();
        keys.extend(added);
    }
    Some(keys)
}

impl<'v> Given<'v> {
    fn below(self, key: &str) -> Self {
        let Self::Is(value) = self else { return Self::NoTable };
        let item = match value {
            Value::Array(list) => key.parse().ok().and_then(|index: usize| list.get(index)),
            value => value.get(key),
        };
        item.map_or(Self::Absent, Self::Is)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(specs: &[&str]) -> Vec<(String, Vec<String>)> {
        let values: Vec<Value> = specs.iter().map(|text| Value::Table(toml::from_str(text).unwrap())).collect();
        let text = |given: &Given<'_>| match given {
            Given::Is(value) => value.to_string(),
            Given::Absent => "absent".to_owned(),
            Given::NoTable => "-".to_owned(),
        };
        let partings = partings(&values.iter().collect::<Vec<_>>());
        partings.iter().map(|parting| (parting.path.clone(), parting.given.iter().map(text).collect())).collect()
    }

    fn expected(paths: &[(&str, &[&str])]) -> Vec<(String, Vec<String>)> {
        let texts = |given: &[&str]| given.iter().map(|text| (*text).to_owned()).collect();
        paths.iter().map(|(path, given)| ((*path).to_owned(), texts(given))).collect()
    }

    #[test]
    fn what_is_alike_is_not_told() {
        assert_eq!(told(&["a = 1\nb.c = [1, 2]", "a = 1\nb.c = [1, 2]", "a = 1\nb.c = [1, 2]"]), []);
        assert_eq!(told(&["a = 1\nb.c = 1", "a = 2\nb.c = 1"]), expected(&[("a", &["1", "2"])]));
        assert_eq!(told(&["a = 1"]), []);
    }

    #[test]
    fn tables_that_some_have_are_compared_among_those() {
        let found = told(&["agent = { n = 1, m = 5 }", "agent = { n = 2, m = 5 }", ""]);
        let whole = ("agent", &["{ n = 1, m = 5 }", "{ n = 2, m = 5 }", "absent"][..]);
        assert_eq!(found, expected(&[whole, ("agent.n", &["1", "2", "-"])]));
    }

    #[test]
    fn tables_of_two_types_differ_as_a_whole() {
        let terms = |first: &str| format!("r.terms = [{{ w = 1, r = {first} }}, {{ w = 2, r = {{ type = \"p\" }} }}]");
        let found = told(&[&terms("{ type = \"a\", x = 1 }"), &terms("{ type = \"b\" }")]);
        assert_eq!(found, expected(&[("r.terms.0.r", &["{ type = \"a\", x = 1 }", "{ type = \"b\" }"])]));
        let found = told(&[&terms("{ type = \"a\", x = 1 }"), &terms("{ type = \"a\", x = 2 }")]);
        assert_eq!(found, expected(&[("r.terms.0.r.x", &["1", "2"])]));
    }
}
