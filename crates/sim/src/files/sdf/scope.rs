//! Names of frames, and the poses that refer to them.

use std::cell::OnceCell;
use std::collections::HashMap;

use roxmltree::Node;

use super::frame::Frame;
use super::xml::{child, elements, refusal};
use crate::FieldError;
use crate::files::FileError;
use crate::files::error::quoted;

/// The longest chain of frames, each given in the next.
const LONGEST_CHAIN: usize = 64;

/// A world or a model: its models, links and frames know each other by name.
pub(super) struct Scope<'a, 'i> {
    pub(super) node: Node<'a, 'i>,
    named: OnceCell<HashMap<&'a str, Node<'a, 'i>>>,
}

impl<'a, 'i: 'a> Scope<'a, 'i> {
    pub(super) fn new(node: Node<'a, 'i>) -> Self {
        Self { node, named: OnceCell::new() }
    }

    /// The frame of a model, link or frame of this scope, or of an element that lies by default in `parent`, seen from
    /// the scope.
    pub(super) fn frame_of(&self, node: Node<'a, 'i>, parent: &Frame) -> Result<Frame, FileError> {
        self.resolve(node, parent, 0)
    }

    fn resolve(&self, node: Node<'a, 'i>, parent: &Frame, depth: usize) -> Result<Frame, FileError> {
        let pose = child(node, "pose")?;
        let own = pose.map_or(Ok(Frame::identity()), Frame::parse)?;
        if let Some(frame) = pose.and_then(|pose| pose.attribute("frame")).filter(|frame| !frame.is_empty()) {
            let allowed = "empty: name the frame by relative_to";
            return Err(refusal(node, FieldError::new("pose frame", quoted(frame), allowed)));
        }
        let relative_to = pose.and_then(|pose| pose.attribute("relative_to"));
        let attached_to = node.attribute("attached_to").filter(|_| node.has_tag_name("frame"));
        let outer = match relative_to.filter(|name| !name.is_empty()).or(attached_to.filter(|name| !name.is_empty())) {
            Some(name) => self.named(name, node, depth)?,
            None => *parent,
        };
        Ok(outer.then(&own))
    }

    /// The frame of a name that `user` refers to.
    fn named(&self, name: &str, user: Node<'a, 'i>, depth: usize) -> Result<Frame, FileError> {
        let own_name = if self.node.has_tag_name("model") { "__model__" } else { "world" };
        if name == own_name {
            return Ok(Frame::identity());
        }
        if depth >= LONGEST_CHAIN {
            let allowed = format!("no circle, and no chain of more than {LONGEST_CHAIN} frames");
            return Err(refusal(user, FieldError::new("relative_to", quoted(name), allowed)));
        }
        let Some(node) = self.names().get(name) else {
            let allowed = format!("{own_name}, or a model, link or frame beside it");
            return Err(refusal(user, FieldError::new("relative_to", quoted(name), allowed)));
        };
        self.resolve(*node, &Frame::identity(), depth + 1)
    }

    fn names(&self) -> &HashMap<&'a str, Node<'a, 'i>> {
        self.named.get_or_init(|| {
            let is_frame = |n: &Node<'_, '_>| ["model", "link", "frame"].iter().any(|tag| n.has_tag_name(*tag));
            elements(self.node).filter(is_frame).filter_map(|n| Some((n.attribute("name")?, n))).collect()
        })
    }
}
