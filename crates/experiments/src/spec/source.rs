//! Spec files as they were written: reading them, their bases, and the lines that hold their keys.

use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

use super::integers::{TOO_LARGE, first_too_large};
use super::merge::merge;
use super::{KeyPath, Place, SpecError};

/// One file's text and what it says.
#[derive(Debug, Clone)]
struct Source {
    path: PathBuf,
    text: String,
    table: Table,
}

/// A spec file followed by its base, its base's base, and so on.
#[derive(Debug, Clone)]
pub(crate) struct Sources(Vec<Source>);

impl Sources {
    /// Reads `path` and the bases it names.
    pub(crate) fn load(path: &Path) -> Result<Self, SpecError> {
        let first = Source::read(path, |problem| SpecError {
            place: Box::new(Place::File { file: path.to_owned(), line: None, part: None }),
            path: None,
            value: None,
            problem: format!("cannot read the spec: {problem}"),
        })?;
        let mut sources = Self(vec![first]);
        while let Some(base) = sources.next_base()? {
            sources.0.push(base);
        }
        Ok(sources)
    }

    /// The base that the last file names.
    fn next_base(&self) -> Result<Option<Source>, SpecError> {
        let last = &self.0[self.0.len() - 1];
        let Some(base) = last.table.get("base") else {
            return Ok(None);
        };
        let refuse = |problem: String| last.error("base", Some(base.to_string()), problem);
        let Value::String(name) = base else {
            return Err(refuse("must be a string: the path of a spec file, relative to this one".into()));
        };
        let path = last.path.parent().unwrap_or(Path::new("")).join(name);
        if self.0.iter().any(|source| same_file(&source.path, &path)) {
            let chain: Vec<_> = self.0.iter().map(|s| s.path.display().to_string()).collect();
            return Err(refuse(format!("is a cycle: {} -> {}", chain.join(" -> "), path.display())));
        }
        let unreadable = |problem| refuse(format!("cannot read the base {}: {problem}", path.display()));
        Source::read(&path, unreadable).map(Some)
    }

    /// All the files' tables, merged; `base` and the bases' names are dropped.
    pub(crate) fn merged(&self) -> Table {
        let mut merged = Table::new();
        for (index, source) in self.0.iter().enumerate().rev() {
            let mut table = source.table.clone();
            table.remove("base");
            if index > 0 {
                table.remove("name");
            }
            merge(&mut merged, table);
        }
        merged
    }

    /// The file and line that hold `path`, or else as much of it as any file holds; what a preset stands for is that file's.
    pub(crate) fn place(&self, path: &KeyPath) -> Place {
        let found = |source: &Source| source.lookup(path.segments());
        let mut best = (0, &self.0[0], None);
        for source in &self.0 {
            let (depth, line) = found(source);
            if depth > best.0 {
                best = (depth, source, line);
            }
            if source.names_preset_above(path) {
                break;
            }
        }
        Place::File { file: best.1.path.clone(), line: best.2, part: None }
    }
}

impl Source {
    /// Reads and parses; `refuse` makes the error of a file that cannot be read.
    fn read(path: &Path, refuse: impl FnOnce(String) -> SpecError) -> Result<Self, SpecError> {
        let text = std::fs::read_to_string(path).map_err(|error| refuse(error.to_string()))?;
        match text.parse::<Table>() {
            Ok(table) => Ok(Self { path: path.to_owned(), text, table }),
            Err(error) => {
                if let Some((key, number)) = first_too_large(&text) {
                    let source = Self { path: path.to_owned(), text, table: Table::new() };
                    let place = Sources(vec![source]).place(&key);
                    let problem = TOO_LARGE.into();
                    return Err(SpecError { place: Box::new(place), path: Some(key), value: Some(number), problem });
                }
                let line = error.span().map(|span| line_of(&text, span.start));
                let culprit = error.span().and_then(|span| text.get(span)).unwrap_or_default();
                let named = match error.message() {
                    "duplicate key" => {
                        format!("duplicate key `{culprit}`; levels, like all keys, need names of their own")
                    }
                    other => other.to_owned(),
                };
                Err(SpecError {
                    place: Box::new(Place::File { file: path.to_owned(), line, part: None }),
                    path: None,
                    value: None,
                    problem: format!("not valid TOML: {named}"),
                })
            }
        }
    }

    fn error(&self, key: &str, value: Option<String>, problem: String) -> SpecError {
        let path = KeyPath::new([key]);
        let (_, line) = self.lookup(path.segments());
        let place = Place::File { file: self.path.clone(), line, part: None };
        SpecError { place: Box::new(place), path: Some(path), value, problem }
    }

    /// Whether this file names a preset for a table that `path` leads through: what its bases say of that table is replaced.
    fn names_preset_above(&self, path: &KeyPath) -> bool {
        let tables = path.segments().iter().scan(Some(&self.table), |table, segment| {
            *table = table.and_then(|table| table.get(segment)?.as_table());
            *table
        });
        tables.into_iter().any(|table| table.contains_key("preset"))
    }

    /// How many of `segments` this file holds, and the line of the last one it does.
    fn lookup(&self, segments: &[String]) -> (usize, Option<usize>) {
        let Ok(root) = DeTable::parse(&self.text) else {
            return (0, None);
        };
        let (depth, offset) = descend(root.get_ref(), segments);
        (depth, offset.map(|offset| line_of(&self.text, offset)))
    }
}

/// How far `segments` lead into `table`, and the byte where the last key or element that exists begins.
fn descend(table: &DeTable<'_>, segments: &[String]) -> (usize, Option<usize>) {
    let Some((segment, rest)) = segments.split_first() else {
        return (0, None);
    };
    let Some((key, value)) = table.iter().find(|(key, _)| key.get_ref() == segment.as_str()) else {
        return (0, None);
    };
    let (depth, offset) = descend_value(value, rest);
    (depth + 1, offset.or(Some(key.span().start)))
}

/// The same, from a value.
fn descend_value(value: &Spanned<DeValue<'_>>, segments: &[String]) -> (usize, Option<usize>) {
    match (value.get_ref(), segments.split_first()) {
        (DeValue::Table(table), _) => descend(table, segments),
        (DeValue::Array(items), Some((index, rest))) => {
            let Some(item) = index.parse().ok().and_then(|index: usize| items.get(index)) else {
                return (0, None);
            };
            let (depth, offset) = descend_value(item, rest);
            (depth + 1, offset.or(Some(item.span().start)))
        }
        _ => (0, None),
    }
}

/// The line, counted from 1, that holds the byte `offset`.
fn line_of(text: &str, offset: usize) -> usize {
    text.bytes().take(offset).filter(|byte| *byte == b'\n').count() + 1
}

/// Whether both paths lead to one file.
fn same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}
