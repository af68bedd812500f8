//! Whole numbers that TOML has no room for.

use toml::de::{DeTable, DeValue};

use super::KeyPath;

/// Said of them.
pub(crate) const TOO_LARGE: &str = "whole numbers reach from -2^63 to 2^63 - 1";

/// The first whole number in `text` that a TOML value cannot hold, and its path: the parser's error names neither.
pub(crate) fn first_too_large(text: &str) -> Option<(KeyPath, String)> {
    let table = DeTable::parse(text).ok()?;
    in_table(table.get_ref(), &KeyPath::default())
}

fn in_table(table: &DeTable<'_>, at: &KeyPath) -> Option<(KeyPath, String)> {
    table.iter().find_map(|(key, value)| in_value(value.get_ref(), at.join(key.get_ref().as_ref())))
}

fn in_value(value: &DeValue<'_>, at: KeyPath) -> Option<(KeyPath, String)> {
    match value {
        DeValue::Integer(number) => {
            let fits = i64::from_str_radix(number.as_str(), number.radix()).is_ok();
            (!fits).then(|| (at, number.to_string()))
        }
        DeValue::Array(items) => {
            items.iter().enumerate().find_map(|(index, item)| in_value(item.get_ref(), at.join(index.to_string())))
        }
        DeValue::Table(table) => in_table(table, &at),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn found_in_any_depth() {
        let found = |text| first_too_large(text).map(|(path, number)| format!("{path} = {number}"));
        assert_eq!(found("a = 1\nb = 9223372036854775807\nc = -9223372036854775808\nd = 1e300"), None);
        assert_eq!(found("a = 9223372036854775808").as_deref(), Some("a = 9223372036854775808"));
        assert_eq!(
            found("[a]\nb = [1, { c = 99999999999999999999 }]").as_deref(),
            Some("a.b.1.c = 99999999999999999999")
        );
        assert_eq!(found("a = 0xffffffffffffffff").as_deref(), Some("a = 0xffffffffffffffff"));
    }
}
