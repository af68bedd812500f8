//! The code in pages.

use std::fs;
use std::path::{Path, PathBuf};

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

/// A piece of code.
pub(crate) struct Code {
    /// File and line.
    pub(crate) place: String,
    pub(crate) kind: Kind,
    pub(crate) text: String,
}

#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A block: of this language behind a fence, of none where it is indented.
    Block(Option<String>),
    /// A few words in a sentence.
    Inline,
}

impl Code {
    /// Whether it is a block of this language, whatever else its fence says, as in `rust,no_run`.
    pub(crate) fn is_in(&self, language: &str) -> bool {
        matches!(&self.kind, Kind::Block(Some(info)) if info.split(',').next() == Some(language))
    }

    /// The same code, or a part of it, as text from somewhere else.
    pub(crate) fn of_block(place: &Path, text: String) -> Self {
        Self { place: place.display().to_string(), kind: Kind::Block(None), text }
    }
}

/// A file's path from the repository's root.
pub(crate) fn from_root(path: impl AsRef<Path>) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// The files with this ending in a folder of the repository, sorted.
pub(crate) fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(from_root(folder)).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries.filter(|path| path.extension().is_some_and(|found| found == ending)).collect();
    files.sort();
    files
}

/// README.md and the pages of docs/.
pub(crate) fn pages() -> Vec<PathBuf> {
    [vec![from_root("README.md")], files("docs", "md")].concat()
}

/// All code of a page, in its order.
pub(crate) fn of_page(page: &Path) -> Vec<Code> {
    let text = fs::read_to_string(page).unwrap();
    let name = page.file_name().unwrap().to_string_lossy();
    let place = |offset: usize| format!("{name}:{}", text[..offset].matches('\n').count() + 1);
    let (mut all, mut open) = (Vec::new(), None::<Code>);
    for (event, range) in Parser::new_ext(&text, Options::ENABLE_TABLES).into_offset_iter() {
        let start = |kind| Code { place: place(range.start), kind, text: String::new() };
        match (event, &mut open) {
            (Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(info))), _) => {
                open = Some(start(Kind::Block(Some(info.into_string()))));
            }
            (Event::Start(Tag::CodeBlock(CodeBlockKind::Indented)), _) => open = Some(start(Kind::Block(None))),
            (Event::Text(part), Some(code)) => code.text.push_str(&part),
            (Event::End(TagEnd::CodeBlock), _) => all.extend(open.take()),
            (Event::Code(words), _) => all.push(Code { text: words.into_string(), ..start(Kind::Inline) }),
            _ => {}
        }
    }
    all
}

/// All code of all pages.
pub(crate) fn of_pages() -> Vec<Code> {
    pages().iter().flat_map(|page| of_page(page)).collect()
}
