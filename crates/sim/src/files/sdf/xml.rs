//! Elements, texts and numbers of an XML document, with their places.

use roxmltree::{Document, Node, ParsingOptions};

use crate::FieldError;
use crate::check::within;
use crate::files::error::quoted;
use crate::files::start_goal::checked;
use crate::files::{FileError, FileProblem};

/// The most elements, texts and comments: some 300 MB of tree.
const MOST_NODES: u32 = 4_000_000;

/// The most attributes of an element; the parser compares each with all others.
const MOST_ATTRIBUTES: usize = 256;

/// A document, without a document type: entities could make much of little.
pub(super) fn parse(text: &str) -> Result<Document<'_>, FileError> {
    check_tags(text)?;
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|e| match e {
        roxmltree::Error::DtdDetected => FileError::malformed(
            "",
            "SDF",
            "a document type (DTD) is not allowed: its entities could grow without bounds",
        ),
        roxmltree::Error::NodesLimitReached => {
            FileError::malformed("", "SDF", format!("more than {MOST_NODES} elements and texts"))
        }
        e => FileError::malformed("", "XML", e),
    })
}

/// Refuses elements with very many attributes before the parser sees them.
fn check_tags(text: &str) -> Result<(), FileError> {
    let mut rest = text;
    while let Some(begin) = rest.find('<') {
        rest = &rest[begin + 1..];
        let end = ["!--", "![CDATA["].iter().zip(["-->", "]]>"]).find(|(opening, _)| rest.starts_with(**opening));
        if let Some((_, closing)) = end {
            rest = rest.find(closing).map_or("", |end| &rest[end..]);
            continue;
        }
        let tag = &rest[..rest.find('<').unwrap_or(rest.len())];
        let n = tag.bytes().filter(|byte| *byte == b'=').count();
        if n > MOST_ATTRIBUTES {
            let row = text[..text.len() - rest.len()].matches('\n').count() + 1;
            let refusal = FieldError::new("attributes", n, format!("at most {MOST_ATTRIBUTES} in an element"));
            return Err(FileError::at(format!("line {row}"), refusal));
        }
        rest = &rest[tag.len()..];
    }
    Ok(())
}

/// The elements within, but for those of other namespaces.
pub(super) fn elements<'a, 'i: 'a>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(|child| child.is_element() && child.tag_name().namespace().is_none())
}

/// The element of a name, of which there must not be a second.
pub(super) fn child<'a, 'i: 'a>(node: Node<'a, 'i>, name: &str) -> Result<Option<Node<'a, 'i>>, FileError> {
    let mut found = elements(node).filter(|child| child.has_tag_name(name));
    let first = found.next();
    match found.next() {
        Some(second) => Err(refusal(second, FieldError::new(name, "a second one", "once in its element"))),
        None => Ok(first),
    }
}

/// The one element of a name, which must be there.
pub(super) fn required<'a, 'i: 'a>(node: Node<'a, 'i>, name: &str) -> Result<Node<'a, 'i>, FileError> {
    child(node, name)?.ok_or_else(|| refusal(node, FileProblem::Missing(name.into())))
}

/// The numbers of a text.
pub(super) fn numbers(node: Node<'_, '_>) -> Result<Vec<f64>, FileError> {
    let field = node.tag_name().name();
    let text: String = node.children().filter_map(|child| child.text().filter(|_| child.is_text())).collect();
    let number = |word: &str| match word.parse() {
        Ok(number) => checked(field, number),
        Err(_) => Err(FieldError::new(field, quoted(word), "a number")),
    };
    text.split_ascii_whitespace().map(number).collect::<Result<_, _>>().map_err(|e| refusal(node, e))
}

/// The `N` numbers of a text.
pub(super) fn exactly<const N: usize>(node: Node<'_, '_>) -> Result<[f64; N], FileError> {
    let found = numbers(node)?;
    let n = found.len();
    let field = node.tag_name().name();
    found.try_into().map_err(|_| refusal(node, FieldError::new(field, format!("{n} numbers"), format!("{N} numbers"))))
}

/// The sizes in an element of a name, metres, each from a micrometre to 1000 km.
pub(super) fn sizes<const N: usize>(node: Node<'_, '_>, name: &str) -> Result<[f64; N], FileError> {
    let element = required(node, name)?;
    let found = exactly::<N>(element)?;
    for size in found {
        within(name, size, 1e-6, 1e6).map_err(|e| refusal(element, e))?;
    }
    Ok(found)
}

/// A problem with its place.
pub(super) fn refusal(node: Node<'_, '_>, problem: impl Into<FileProblem>) -> FileError {
    let row = node.document().text_pos_at(node.range().start).row;
    let path = name_of(node);
    let place = if path.is_empty() { format!("line {row}") } else { format!("line {row}, {path}") };
    FileError::at(place, problem)
}

/// Where an element is: the names of the models, links and collisions around it.
pub(super) fn name_of(node: Node<'_, '_>) -> String {
    let mut names: Vec<_> = node
        .ancestors()
        .filter(|n| {
            ["model", "link", "joint", "collision", "frame", "include", "actor", "population"]
                .iter()
                .any(|t| n.has_tag_name(*t))
        })
        .map(|n| match n.attribute("name") {
            Some(name) => format!("{} {}", n.tag_name().name(), quoted(name)),
            None => n.tag_name().name().to_owned(),
        })
        .collect();
    names.reverse();
    names.join(", ")
}
