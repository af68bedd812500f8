//! What the cells of a grid are: the values of their specs that are not the same in all of them.

use std::collections::BTreeMap;
use std::path::Path;

use toml::{Table, Value};

use super::Group;
use crate::difference::{Given, partings};
use crate::report::RunRow;
use crate::report::axes::fewest;
use crate::store::{Cell, Index, RunFolder, StoreError};

/// Longest text of a table that is shown whole, in characters, unless it has a type.
const MAX_TABLE: usize = 80;

/// The values that some axes decide together, and none of them alone.
#[derive(Debug, PartialEq)]
pub(crate) struct Settings {
    /// The axes.
    pub(crate) axes: Vec<String>,
    /// Their levels, one from each axis.
    pub(crate) levels: Vec<Vec<String>>,
    pub(crate) settings: Vec<Setting>,
}

/// A value of a spec.
#[derive(Debug, PartialEq)]
pub(crate) struct Setting {
    /// Its dotted path.
    pub(crate) path: String,
    /// One for each of the levels; `None` where the table around it is absent, or no run tells.
    pub(crate) values: Vec<Option<String>>,
}

/// The settings of the cells, as the specs of their complete runs have them: those that one axis decides, axis by axis, then those
/// that several do. None until every cell has a complete run.
///
/// # Errors
/// If the spec of a complete run cannot be read.
pub(super) fn settings(
    root: &Path,
    index: &Index,
    cells: &[Group],
    runs: &[RunRow],
) -> Result<Vec<Settings>, StoreError> {
    let (mut known, mut specs) = (Vec::new(), Vec::new());
    for (group, cell) in cells.iter().zip(&index.cells) {
        // Some of the cells do not tell which axis decides.
        let Some(run) = runs[group.runs.clone()].iter().find(|run| run.is_complete()) else { return Ok(Vec::new()) };
        known.push(&group.levels[..]);
        specs.push(spec(root, cell, run)?);
    }
    let axes: Vec<&str> = index.axes.iter().map(|axis| &axis.name[..]).collect();
    Ok(by_axes(&axes, &known, &specs))
}

/// The spec of a cell, from the folders of one of its runs.
fn spec(root: &Path, cell: &Cell, run: &RunRow) -> Result<Value, StoreError> {
    let folder = RunFolder::new(root, &run.train_id);
    let (mut spec, mut evaluate, mut worlds) = (folder.spec()?, Table::new(), Vec::new());
    for evaluation in &cell.evaluations {
        let mut rules = folder.evaluation(&evaluation.eval_id).spec()?;
        for key in ["n_episodes", "seed", "shield"] {
            if let Some(value) = rules.remove(key) {
                evaluate.insert(key.into(), value); // the same in all worlds
            }
        }
        worlds.push(Value::Table(rules));
    }
    evaluate.insert("worlds".into(), Value::Array(worlds));
    spec.insert("evaluate".into(), Value::Table(evaluate));
    Ok(Value::Table(spec))
}

/// The settings of cells, each given by its levels and its spec.
fn by_axes(axes: &[&str], cells: &[&[String]], specs: &[Value]) -> Vec<Settings> {
    let mut found: BTreeMap<(usize, Vec<usize>), Settings> = BTreeMap::new();
    for parting in partings(&specs.iter().collect::<Vec<_>>()) {
        let texts: Vec<Option<String>> = parting.given.iter().map(text).collect();
        let Some(those) = deciding(axes.len(), cells, &texts) else { continue };
        let mut levels: Vec<Vec<String>> = Vec::new();
        let mut values = Vec::new();
        for (cell, text) in cells.iter().zip(texts) {
            let level = chosen(cell, &those);
            if !levels.contains(&level) {
                levels.push(level);
                values.push(text);
            }
        }
        let names = chosen(axes, &those).into_iter().map(str::to_owned).collect();
        let settings = found.entry((those.len(), those));
        let settings = settings.or_insert_with(|| Settings { axes: names, levels, settings: Vec::new() });
        settings.settings.push(Setting { path: parting.path, values });
    }
    found.into_values().collect()
}

/// The fewest axes whose levels decide a value.
fn deciding(n_axes: usize, cells: &[&[String]], values: &[Option<String>]) -> Option<Vec<usize>> {
    fewest(n_axes, |axes| {
        let mut known = BTreeMap::new();
        let mut cells = cells.iter().zip(values);
        cells.all(|(cell, value)| *known.entry(chosen(cell, axes)).or_insert(value) == value)
    })
}

/// The items of a list at some places.
fn chosen<T: Clone>(list: &[T], places: &[usize]) -> Vec<T> {
    places.iter().map(|place| list[*place].clone()).collect()
}

/// A value in words: of a table with a type the type first, of a long one without only that it is there.
fn text(given: &Given<'_>) -> Option<String> {
    let value = match given {
        Given::Is(value) => value,
        Given::Absent => return Some("absent".to_owned()),
        Given::NoTable => return None,
    };
    let text = value.to_string();
    Some(match value {
        Value::Table(table) => match table.get("type") {
            Some(kind) => {
                let rest =
                    table.iter().filter(|(key, _)| *key != "type").map(|(key, value)| format!(", {key} = {value}"));
                format!("type = {kind}{}", rest.collect::<String>())
            }
            None if text.chars().count() > MAX_TABLE => "{ \u{2026} }".to_owned(),
            None => text,
        },
        _ => text,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Value {
        Value::Table(toml::from_str(text).unwrap())
    }

    #[test]
    fn values_stand_under_the_axes_that_decide_them() {
        let cells = [["P", "R"], ["P", "S"], ["H", "R"], ["H", "S"]].map(|cell| cell.map(str::to_owned));
        let specs = [
            value("n = 3\ngoal = \"end\"\nr = { type = \"r\" }"),
            value("n = 3\ngoal = \"end\"\nr = { type = \"s\", v = 1.2 }"),
            value("n = 1\ngoal = \"end\"\nr = { type = \"r\" }"),
            value("n = 1\ngoal = \"new\"\nr = { type = \"s\", v = 1.2 }"),
        ];
        let cells: Vec<&[String]> = cells.iter().map(|cell| &cell[..]).collect();
        let found = by_axes(&["reading", "reward"], &cells, &specs);
        let told: Vec<(String, String)> = found
            .iter()
            .flat_map(|settings| settings.settings.iter().map(|setting| (settings.axes.join(" "), setting)))
            .map(|(axes, Setting { path, values })| {
                let values: Vec<&str> = values.iter().map(|value| value.as_deref().unwrap_or("-")).collect();
                (axes, format!("{path}: {}", values.join(" | ")))
            })
            .collect();
        let expected = [
            ("reading", "n: 3 | 1"),
            ("reward", "r: type = \"r\" | type = \"s\", v = 1.2"),
            ("reading reward", "goal: \"end\" | \"end\" | \"end\" | \"new\""),
        ];
        assert_eq!(told, expected.map(|(axes, text)| (axes.to_owned(), text.to_owned())));
        assert_eq!(found[2].levels[3], ["H", "S"]);
        assert_eq!(by_axes(&["a"], &cells[..1], &specs[..1]), []);
    }

    #[test]
    fn long_tables_are_only_there() {
        let long = value(&format!("a = \"{}\"", "x".repeat(MAX_TABLE)));
        assert_eq!(text(&Given::Is(&long)).as_deref(), Some("{ \u{2026} }"));
        assert_eq!(text(&Given::Is(&value("a = 1"))).as_deref(), Some("{ a = 1 }"));
    }
}
