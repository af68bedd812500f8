//! Names of frames, and the poses that refer to them.

use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;

use roxmltree::{Node, NodeId};

use super::frame::Frame;
use super::xml::{child, refusal, required};
use crate::FieldError;
use crate::files::FileError;
use crate::files::error::quoted;

/// The longest chain of frames, each given in the next.
const LONGEST_CHAIN: usize = 64;

/// What is between the names of a scoped name: `a::b` is what the model `a` knows as `b`.
const SEPARATOR: &str = "::";

/// The frames of a document. A world or a model is a scope: its models, links, joints and frames know each other by name.
#[derive(Default)]
pub(super) struct Frames<'a, 'i> {
    /// The elements by scope and name.
    named: OnceCell<HashMap<(NodeId, &'a str), Node<'a, 'i>>>,
    /// Frames that were asked for by name, seen from their scopes: none is worked out twice, or scoped names that lead to
    /// scoped names could take for ever.
    known: RefCell<HashMap<NodeId, Frame>>,
}

/// A name, and who refers to it by which attribute or element.
#[derive(Clone, Copy)]
struct Reference<'a, 'i> {
    name: &'a str,
    field: &'static str,
    user: Node<'a, 'i>,
}

impl<'a, 'i: 'a> Frames<'a, 'i> {
    /// The frame of an element of a scope, which lies by default in `parent`, seen from the scope.
    pub(super) fn frame_of(&self, scope: Node<'a, 'i>, node: Node<'a, 'i>, parent: &Frame) -> Result<Frame, FileError> {
        self.resolve(scope, node, parent, 0)
    }

    fn resolve(
        &self,
        scope: Node<'a, 'i>,
        node: Node<'a, 'i>,
        parent: &Frame,
        depth: usize,
    ) -> Result<Frame, FileError> {
        let pose = child(node, "pose")?;
        let own = pose.map_or(Ok(Frame::identity()), Frame::parse)?;
        if let Some(frame) = pose.and_then(|pose| pose.attribute("frame")).filter(|frame| !frame.is_empty()) {
            let allowed = "empty: name the frame by relative_to";
            return Err(refusal(node, FieldError::new("pose frame", quoted(frame), allowed)));
        }
        let outer = match outer_name(node, pose)? {
            Some(reference) => self.find(scope, reference.name, reference, depth)?,
            None => *parent,
        };
        let placed = outer.then(&own);
        // The pose of a model is that of the frame by which it is placed.
        match attribute(node, "placement_frame").filter(|_| node.has_tag_name("model")) {
            Some(reference) => Ok(placed.then(&self.find(node, reference.name, reference, depth)?.inverse())),
            None => Ok(placed),
        }
    }

    /// The frame that a name of a scope, the whole or the end of a reference's, stands for, seen from the scope.
    fn find(
        &self,
        scope: Node<'a, 'i>,
        name: &str,
        reference: Reference<'a, 'i>,
        depth: usize,
    ) -> Result<Frame, FileError> {
        let refuse = |allowed: String| {
            let Reference { name, field, user } = reference;
            Err(refusal(user, FieldError::new(field, quoted(name), allowed)))
        };
        if name == own_name(scope) {
            return Ok(Frame::identity());
        }
        if depth >= LONGEST_CHAIN {
            return refuse(format!("no circle, and no chain of more than {LONGEST_CHAIN} frames"));
        }
        if let Some(node) = self.element(scope, name) {
            return self.known(scope, node, depth + 1);
        }
        let within = name.split_once(SEPARATOR).and_then(|(model, rest)| Some((self.element(scope, model)?, rest)));
        let Some((model, rest)) = within.filter(|(model, _)| model.has_tag_name("model")) else {
            let own = own_name(scope);
            return refuse(format!(
                "{own}, or a model, link, joint or frame beside it, or within a model there (a::b)"
            ));
        };
        let inner = self.find(model, rest, reference, depth + 1)?;
        Ok(self.known(scope, model, depth + 1)?.then(&inner))
    }

    fn known(&self, scope: Node<'a, 'i>, node: Node<'a, 'i>, depth: usize) -> Result<Frame, FileError> {
        if let Some(frame) = self.known.borrow().get(&node.id()) {
            return Ok(*frame);
        }
        let frame = self.resolve(scope, node, &Frame::identity(), depth)?;
        self.known.borrow_mut().insert(node.id(), frame);
        Ok(frame)
    }

    fn element(&self, scope: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
        const TAGS: [&str; 4] = ["model", "link", "joint", "frame"];
        let key = |n: &Node<'a, 'i>| Some((n.parent()?.id(), n.attribute("name")?));
        let all = || {
            let is_frame = |n: &Node<'_, '_>| n.tag_name().namespace().is_none() && TAGS.contains(&n.tag_name().name());
            let frames = scope.document().descendants().filter(is_frame);
            frames.filter_map(|n| Some((key(&n)?, n))).collect()
        };
        self.named.get_or_init(all).get(&(scope.id(), name)).copied()
    }
}

/// What a scope calls its own frame.
fn own_name(scope: Node<'_, '_>) -> &'static str {
    if scope.has_tag_name("model") { "__model__" } else { "world" }
}

/// What an element's pose is given in, unless it says nothing of it: what the pose or the frame names, or the child link of a
/// joint.
fn outer_name<'a, 'i: 'a>(
    node: Node<'a, 'i>,
    pose: Option<Node<'a, 'i>>,
) -> Result<Option<Reference<'a, 'i>>, FileError> {
    let relative_to =
        pose.and_then(|pose| attribute(pose, "relative_to")).map(|found| Reference { user: node, ..found });
    if relative_to.is_some() || !node.has_tag_name("joint") {
        let attached_to = attribute(node, "attached_to").filter(|_| node.has_tag_name("frame"));
        return Ok(relative_to.or(attached_to));
    }
    let name = required(node, "child")?.text().unwrap_or_default().trim();
    Ok(Some(Reference { name, field: "child", user: node }))
}

/// A name in an attribute, if there is one that is not empty.
fn attribute<'a, 'i: 'a>(node: Node<'a, 'i>, field: &'static str) -> Option<Reference<'a, 'i>> {
    let name = node.attribute(field).filter(|name| !name.is_empty())?;
    Some(Reference { name, field, user: node })
}
