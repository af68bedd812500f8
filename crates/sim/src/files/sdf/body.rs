//! Geometries in three dimensions, as files give them.

use nalgebra::{Unit, Vector3};
use roxmltree::Node;

use super::solid_parts;
use super::xml::{child, elements, exactly, refusal, required, sizes};
use crate::files::error::quoted;
use crate::files::{FileError, FileProblem};
use crate::{FieldError, Point};

/// The most corners of a polyline.
const MOST_CORNERS: usize = 500;

/// A solid in its own frame; what is long is so along z.
#[derive(Debug, Clone)]
pub(super) enum Body {
    Sphere {
        radius: f64,
    },
    Cylinder {
        radius: f64,
        length: f64,
    },
    Capsule {
        radius: f64,
        length: f64,
    },
    Cone {
        radius: f64,
        length: f64,
    },
    Box {
        size: [f64; 3],
    },
    /// Convex outlines, counter-clockwise, from z = 0 up.
    Extrusion {
        parts: Vec<Vec<Point>>,
        height: f64,
    },
    Plane {
        normal: Unit<Vector3<f64>>,
        size: [f64; 2],
    },
}

/// What a `<geometry>` says.
pub(super) enum Geometry {
    Body(Body),
    Empty,
    /// What it is, in words.
    Unsupported(String),
}

/// Reads the one geometry of a collision, which has one shape, or several polylines.
pub(super) fn parse(collision: Node<'_, '_>) -> Result<Geometry, FileError> {
    let geometry = required(collision, "geometry")?;
    let mut shapes = elements(geometry);
    let Some(shape) = shapes.next() else {
        return Err(refusal(geometry, FileProblem::Missing("a shape of the geometry".into())));
    };
    let is_polyline = |shape: &Node<'_, '_>| shape.has_tag_name("polyline");
    if let Some(second) = shapes.find(|second| !(is_polyline(&shape) && is_polyline(second))) {
        let names = [shape, second].map(|shape| quoted(shape.tag_name().name())).join(" and ");
        return Err(refusal(second, FieldError::new("geometry", names, "one shape")));
    }
    let round = || Ok::<_, FileError>((sizes::<1>(shape, "radius")?[0], sizes::<1>(shape, "length")?[0]));
    let body = match shape.tag_name().name() {
        "empty" => return Ok(Geometry::Empty),
        "sphere" => Body::Sphere { radius: sizes::<1>(shape, "radius")?[0] },
        "cylinder" => round().map(|(radius, length)| Body::Cylinder { radius, length })?,
        "capsule" => round().map(|(radius, length)| Body::Capsule { radius, length })?,
        "cone" => round().map(|(radius, length)| Body::Cone { radius, length })?,
        "box" => Body::Box { size: sizes(shape, "size")? },
        "plane" => plane(shape)?,
        "polyline" if elements(geometry).count() == 1 => extrusion(shape)?,
        "polyline" => return Ok(Geometry::Unsupported("polylines with holes".into())),
        other => return in_words(other, shape).map(Geometry::Unsupported),
    };
    Ok(Geometry::Body(body))
}

/// A geometry by its kind and the file it refers to.
fn in_words(kind: &str, shape: Node<'_, '_>) -> Result<String, FileError> {
    let kind = quoted(kind);
    let kind = kind.trim_matches('\'');
    Ok(match child(shape, "uri")?.and_then(|uri| uri.text()) {
        Some(uri) => format!("{kind} {}", quoted(uri.trim())),
        None => kind.to_owned(),
    })
}

fn plane(shape: Node<'_, '_>) -> Result<Body, FileError> {
    let normal = child(shape, "normal")?.map_or(Ok([0.0, 0.0, 1.0]), exactly::<3>)?;
    let size = if child(shape, "size")?.is_some() { sizes(shape, "size")? } else { [1.0; 2] };
    let Some(normal) = Unit::try_new(Vector3::from(normal), 1e-9) else {
        return Err(refusal(shape, FieldError::new("normal", "0 0 0", "a direction, other than 0")));
    };
    Ok(Body::Plane { normal, size })
}

fn extrusion(shape: Node<'_, '_>) -> Result<Body, FileError> {
    let [height] = sizes(shape, "height")?;
    let points = elements(shape).filter(|element| element.has_tag_name("point"));
    let mut corners = Vec::new();
    for point in points {
        if corners.len() == MOST_CORNERS {
            let allowed = format!("at most {MOST_CORNERS} points");
            return Err(refusal(
                shape,
                FieldError::new("polyline", format!("more than {MOST_CORNERS} points"), allowed),
            ));
        }
        corners.push(Point::from(exactly::<2>(point)?));
    }
    let n = corners.len();
    let parts = solid_parts::convex(corners)
        .map_err(|allowed| refusal(shape, FieldError::new("polyline", format!("{n} points"), allowed)))?;
    Ok(Body::Extrusion { parts, height })
}
