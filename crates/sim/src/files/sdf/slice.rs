//! Cross-sections of bodies at a height.

use std::f64::consts::TAU;

use nalgebra::{Point3, UnitQuaternion, Vector3};

use super::body::Body;
use super::frame::Frame;
use super::polygon::around;
use crate::{Obstacle, Point, Shape};

/// How many facets a round side gets where it is cut aslant.
const N_FACETS: usize = 64;

/// The thickness of a wall that is given as a plane, metres.
const SHEET: f64 = 0.01;

/// The obstacles that a body leaves in the plane z = `height`.
pub(super) fn slice(body: &Body, frame: &Frame, height: f64) -> Vec<Obstacle> {
    let origin = frame.origin();
    let above = height - origin.z;
    let heading = frame.vertical_heading();
    let one = |obstacle: Option<Obstacle>| Vec::from_iter(obstacle);
    match (body, heading) {
        (Body::Sphere { radius }, _) => one(disc(frame, disc_of_sphere(*radius, above))),
        (Body::Cylinder { radius, length }, Some(_)) => {
            one((above.abs() <= length / 2.0).then(|| disc(frame, Some(*radius))).flatten())
        }
        (Body::Capsule { radius, length }, Some(_)) => {
            let beyond = (above.abs() - length / 2.0).max(0.0);
            one(disc(frame, disc_of_sphere(*radius, beyond)))
        }
        (Body::Box { size: [length, width, tall] }, Some(yaw)) => one((above.abs() <= tall / 2.0).then(|| {
            let shape = Shape::Box { length: *length, width: *width };
            Obstacle { shape, x: origin.x, y: origin.y, yaw }
        })),
        (Body::Cylinder { radius, length }, None) => {
            one(around(prism(&ring(*radius), [-length / 2.0, length / 2.0]).cut(frame, height)))
        }
        (Body::Capsule { radius, length }, None) => one(around(capsule(*radius, *length, frame, height))),
        (Body::Cone { radius, length }, _) => one(around(cone(*radius, *length).cut(frame, height))),
        (Body::Box { size }, None) => one(around(cuboid(*size).cut(frame, height))),
        (Body::Extrusion { parts, height: tall }, _) => {
            parts.iter().filter_map(|part| extrusion(part, *tall, frame, height)).collect()
        }
        (Body::Plane { normal, size }, _) => {
            let is_ground = (frame.pose().rotation * normal.into_inner()).z.abs() > std::f64::consts::FRAC_1_SQRT_2;
            // Opposite to z is a plane in which any turn by half a circle will do.
            let turn = UnitQuaternion::rotation_between(&Vector3::z(), normal)
                .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), TAU / 2.0));
            let sheet = Body::Box { size: [size[0], size[1], SHEET] };
            if is_ground { Vec::new() } else { slice(&sheet, &frame.then(&Frame::turned(turn)), height) }
        }
    }
}

fn disc(frame: &Frame, radius: Option<f64>) -> Option<Obstacle> {
    let (origin, yaw) = (frame.origin(), frame.yaw().unwrap_or(0.0));
    radius.map(|radius| Obstacle { shape: Shape::Disc { radius }, x: origin.x, y: origin.y, yaw })
}

/// The radius of a sphere's cross-section so far above its centre.
fn disc_of_sphere(radius: f64, above: f64) -> Option<f64> {
    if above == 0.0 {
        return Some(radius);
    }
    // A NaN beside the sphere is no number above the least one.
    Some(((radius - above) * (radius + above)).sqrt()).filter(|radius| *radius >= 1e-6)
}

/// A part of a polyline: as it is given if it stands upright, so that its corners keep every bit.
fn extrusion(part: &[Point], tall: f64, frame: &Frame, height: f64) -> Option<Obstacle> {
    if let Some(yaw) = frame.yaw() {
        let origin = frame.origin();
        let above = height - origin.z;
        let shape = Shape::Polygon { vertices: part.iter().map(|p| [p.x, p.y]).collect() };
        if !(0.0..=tall).contains(&above) {
            return None;
        }
        if shape.check().is_ok() {
            return Some(Obstacle { shape, x: origin.x, y: origin.y, yaw });
        }
    }
    around(prism(part, [0.0, tall]).cut(frame, height))
}

/// A capsule is convex, so the hull of the cross-sections of its three parts is its own.
fn capsule(radius: f64, length: f64, frame: &Frame, height: f64) -> Vec<Point> {
    let mut points = prism(&ring(radius), [-length / 2.0, length / 2.0]).cut(frame, height);
    for end in [-length / 2.0, length / 2.0] {
        let center = frame.pose() * Point3::new(0.0, 0.0, end);
        if let Some(radius) = disc_of_sphere(radius, height - center.z) {
            points.extend(ring(radius).iter().map(|p| center.xy() + p.coords));
        }
    }
    points
}

/// A regular polygon around a disc, counter-clockwise.
fn ring(radius: f64) -> Vec<Point> {
    let outer = radius / (TAU / 2.0 / N_FACETS as f64).cos();
    let corner = |k| (k as f64 / N_FACETS as f64 * TAU).sin_cos();
    (0..N_FACETS).map(corner).map(|(sin, cos)| Point::new(outer * cos, outer * sin)).collect()
}

/// A convex solid by its edges.
struct Polyhedron {
    edges: Vec<[Point3<f64>; 2]>,
}

fn prism(outline: &[Point], [bottom, top]: [f64; 2]) -> Polyhedron {
    let mut edges = Vec::with_capacity(3 * outline.len());
    let raised = |p: &Point, z| Point3::new(p.x, p.y, z);
    for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        edges.push([raised(a, bottom), raised(b, bottom)]);
        edges.push([raised(a, top), raised(b, top)]);
        edges.push([raised(a, bottom), raised(a, top)]);
    }
    Polyhedron { edges }
}

fn cuboid([length, width, tall]: [f64; 3]) -> Polyhedron {
    let outline = Shape::Box { length, width }.vertices();
    prism(&outline, [-tall / 2.0, tall / 2.0])
}

/// A cone's tip is up.
fn cone(radius: f64, length: f64) -> Polyhedron {
    let base: Vec<_> = ring(radius).iter().map(|p| Point3::new(p.x, p.y, -length / 2.0)).collect();
    let tip = Point3::new(0.0, 0.0, length / 2.0);
    let next = base.iter().cycle().skip(1);
    Polyhedron { edges: base.iter().zip(next).flat_map(|(a, b)| [[*a, *b], [*a, tip]]).collect() }
}

impl Polyhedron {
    /// Where the edges meet the plane z = `height`: the corners of the cross-section, in no particular order.
    fn cut(&self, frame: &Frame, height: f64) -> Vec<Point> {
        let mut points = Vec::new();
        for [a, b] in &self.edges {
            let (a, b) = (frame.pose() * a, frame.pose() * b);
            let (above_a, above_b) = (a.z - height, b.z - height);
            if above_a == 0.0 {
                points.push(a.xy());
            }
            if above_b == 0.0 {
                points.push(b.xy());
            }
            if above_a * above_b < 0.0 {
                points.push(a.xy() + (b.xy() - a.xy()) * (above_a / (above_a - above_b)));
            }
        }
        points
    }
}
