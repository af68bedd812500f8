//! From a document to a world.

use nalgebra::Vector2;
use roxmltree::{Document, Node};

use super::body::{Body, Geometry, parse};
use super::frame::Frame;
use super::scope::Frames;
use super::slice::slice;
use super::write::{NAMESPACE, SCENARIO, WALL};
use super::xml::{elements, name_of, numbers, refusal};
use super::{SdfSpec, Unsupported};
use crate::files::error::quoted;
use crate::files::{FileError, FileProblem, WorldFile, start_goal};
use crate::{FieldError, Obstacle, Point, Pose, Room, Shape, World};

/// The most obstacles of a world.
const MOST_OBSTACLES: usize = 100_000;

/// The most corners of all polylines' parts together: cutting outlines into parts takes its time.
const MOST_CORNERS: usize = 100_000;

/// How deep models may be nested.
const DEEPEST: usize = 32;

/// How many things that cannot be represented are listed.
const MOST_LISTED: usize = 1000;

pub(super) fn read(document: &Document<'_>, spec: &SdfSpec) -> Result<WorldFile, FileError> {
    let root = document.root_element();
    check_root(root)?;
    let world = the_world(root)?;
    let mut reader = Reader {
        spec,
        frames: Frames::default(),
        obstacles: Vec::new(),
        n_corners: 0,
        unsupported: Vec::new(),
        n_unlisted: 0,
    };
    reader.models(world, &Frame::identity(), 0)?;
    reader.finish(world)
}

fn check_root(root: Node<'_, '_>) -> Result<(), FileError> {
    if !root.has_tag_name("sdf") {
        let allowed = "<sdf>, the root of an SDF document";
        return Err(refusal(root, FieldError::new("root", quoted(root.tag_name().name()), allowed)));
    }
    let version = root.attribute("version").unwrap_or_default();
    let minor = version.strip_prefix("1.").and_then(|minor| minor.parse::<u32>().ok());
    if !minor.is_some_and(|minor| (4..=12).contains(&minor)) {
        return Err(refusal(root, FieldError::new("version", quoted(version), "from 1.4 to 1.12")));
    }
    Ok(())
}

/// The one world, or the root if there are models only.
fn the_world<'a, 'i: 'a>(root: Node<'a, 'i>) -> Result<Node<'a, 'i>, FileError> {
    let mut worlds = elements(root).filter(|child| child.has_tag_name("world"));
    match (worlds.next(), worlds.next()) {
        (Some(world), None) => Ok(world),
        (Some(_), Some(second)) => {
            let n = 2 + worlds.count();
            Err(refusal(second, FieldError::new("world", format!("{n} worlds"), "one world in a file")))
        }
        (None, _) if elements(root).any(|child| child.has_tag_name("model")) => Ok(root),
        (None, _) => Err(refusal(root, FileProblem::Missing("world".into()))),
    }
}

struct Reader<'s, 'a, 'i> {
    spec: &'s SdfSpec,
    frames: Frames<'a, 'i>,
    obstacles: Vec<Obstacle>,
    n_corners: usize,
    unsupported: Vec<String>,
    n_unlisted: usize,
}

impl<'a, 'i: 'a> Reader<'_, 'a, 'i> {
    /// The models of a world or a model whose frame is `outer`.
    fn models(&mut self, scope: Node<'a, 'i>, outer: &Frame, depth: usize) -> Result<(), FileError> {
        for element in elements(scope) {
            match element.tag_name().name() {
                "model" if is_wall(element) => {}
                "model" => self.model(element, scope, outer, depth)?,
                "include" | "actor" | "population" => self.leave_out(element, referred(element)),
                "link" if depth > 0 => self.link(element, scope, outer)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn model(&mut self, node: Node<'a, 'i>, scope: Node<'a, 'i>, outer: &Frame, depth: usize) -> Result<(), FileError> {
        if depth == DEEPEST {
            let allowed = format!("at most {DEEPEST} models within each other");
            return Err(refusal(node, FieldError::new("nesting", depth + 1, allowed)));
        }
        let frame = outer.then(&self.frames.frame_of(scope, node, &Frame::identity())?);
        self.models(node, &frame, depth + 1)
    }

    fn link(&mut self, link: Node<'a, 'i>, scope: Node<'a, 'i>, model: &Frame) -> Result<(), FileError> {
        let frame = self.frames.frame_of(scope, link, &Frame::identity())?;
        for collision in elements(link).filter(|child| child.has_tag_name("collision")) {
            match parse(collision)? {
                Geometry::Empty => {}
                Geometry::Unsupported(what) => self.leave_out(collision, what),
                Geometry::Body(body) => {
                    self.count_corners(&body, collision)?;
                    let place = model.then(&self.frames.frame_of(scope, collision, &frame)?);
                    for obstacle in slice(&body, &place, self.spec.slice_height) {
                        self.push(obstacle, collision)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn count_corners(&mut self, body: &Body, node: Node<'_, '_>) -> Result<(), FileError> {
        if let Body::Extrusion { parts, .. } = body {
            self.n_corners += parts.iter().map(Vec::len).sum::<usize>();
        }
        if self.n_corners > MOST_CORNERS {
            let allowed = format!("at most {MOST_CORNERS} corners of convex parts in all");
            return Err(refusal(node, FieldError::new("polylines", format!("{} corners", self.n_corners), allowed)));
        }
        Ok(())
    }

    fn push(&mut self, obstacle: Obstacle, node: Node<'_, '_>) -> Result<(), FileError> {
        if self.obstacles.len() == MOST_OBSTACLES {
            let allowed = format!("at most {MOST_OBSTACLES}");
            return Err(refusal(node, FieldError::new("obstacles", format!("more than {MOST_OBSTACLES}"), allowed)));
        }
        obstacle.shape.check().map_err(|e| refusal(node, e))?;
        self.obstacles.push(obstacle);
        Ok(())
    }

    fn leave_out(&mut self, node: Node<'_, '_>, what: String) {
        if self.unsupported.len() == MOST_LISTED {
            self.n_unlisted += 1;
            return;
        }
        let (name, what) = (name_of(node), if what.is_empty() { what } else { format!(": {what}") });
        self.unsupported.push(format!("{name}{what}"));
    }

    fn finish(mut self, node: Node<'_, '_>) -> Result<WorldFile, FileError> {
        if self.n_unlisted > 0 {
            self.unsupported.push(format!("and {} more", self.n_unlisted));
        }
        if self.spec.unsupported == Unsupported::Refuse && !self.unsupported.is_empty() {
            return Err(FileError::at("", FileProblem::Unsupported(self.unsupported)));
        }
        let Ours { room, start, goal } = Ours::parse(node)?;
        let ends = start.map(|start| start.translation.vector.into()).into_iter().chain(goal);
        let room = room.unwrap_or_else(|| room_around(&self.obstacles, ends, self.spec.margin));
        let world = World::new(room, self.obstacles).map_err(|e| FileError::at("room", e))?;
        let name = node.attribute("name").unwrap_or_default().to_owned();
        Ok(WorldFile { name, world, start, goal, unsupported: self.unsupported })
    }
}

/// What an element that stands for others refers to.
fn referred(element: Node<'_, '_>) -> String {
    let uri = elements(element).find(|child| child.has_tag_name("uri")).and_then(|uri| uri.text());
    uri.map(|uri| quoted(uri.trim())).unwrap_or_default()
}

/// Whether a model is one of the room's walls, written for others to see.
fn is_wall(model: Node<'_, '_>) -> bool {
    model.children().any(|child| child.has_tag_name((NAMESPACE, WALL)))
}

/// What our own files say besides.
#[derive(Default)]
struct Ours {
    room: Option<Room>,
    start: Option<Pose>,
    goal: Option<Point>,
}

impl Ours {
    fn parse(world: Node<'_, '_>) -> Result<Self, FileError> {
        let mut ours = Self::default();
        let Some(scenario) = world.children().find(|child| child.has_tag_name((NAMESPACE, SCENARIO))) else {
            return Ok(ours);
        };
        for node in scenario.children().filter(Node::is_element) {
            let found = numbers(node)?;
            match (node.tag_name().name(), &found[..]) {
                ("room", &[x, y, width, height]) => ours.room = Some(Room { x, y, width, height }),
                ("start", found) => ours.start = Some(start_goal::start(found).map_err(|e| refusal(node, e))?),
                ("goal", found) => ours.goal = Some(start_goal::goal(found).map_err(|e| refusal(node, e))?),
                (name, _) => {
                    let allowed = "a room (x, y, width, height), a start or a goal";
                    return Err(refusal(node, FieldError::new(name, format!("{} numbers", found.len()), allowed)));
                }
            }
        }
        Ok(ours)
    }
}

/// The box around all obstacles and points, grown by a margin.
fn room_around(obstacles: &[Obstacle], points: impl Iterator<Item = Point>, margin: f64) -> Room {
    let nowhere = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
    let around = |(low, high): (Vector2<f64>, Vector2<f64>), (point, radius): (Point, f64)| {
        (low.inf(&point.coords.add_scalar(-radius)), high.sup(&point.coords.add_scalar(radius)))
    };
    let bounds = obstacles.iter().flat_map(extremes).chain(points.map(|point| (point, 0.0))).fold(nowhere, around);
    let (low, high) = if bounds.0.x > bounds.1.x { (Vector2::zeros(), Vector2::zeros()) } else { bounds };
    // Rounding must not put what stands at the edge outside.
    let margin = margin.max(1e-15 * low.amax().max(high.amax()));
    let (low, size) = (low.add_scalar(-margin), (high - low).add_scalar(2.0 * margin));
    Room { x: low.x, y: low.y, width: size.x, height: size.y }
}

/// Discs, of no size for corners, whose box is the obstacle's.
fn extremes(obstacle: &Obstacle) -> Vec<(Point, f64)> {
    match &obstacle.shape {
        Shape::Disc { radius } => vec![(Point::new(obstacle.x, obstacle.y), *radius)],
        shape => shape.vertices().iter().map(|vertex| (obstacle.pose() * vertex, 0.0)).collect(),
    }
}
