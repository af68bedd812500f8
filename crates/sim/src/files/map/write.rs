//! Worlds for map_server.

use std::fmt::Write;

use nalgebra::Vector2;

use super::cells::Cells;
use crate::check::within;
use crate::files::start_goal::start_numbers;
use crate::files::{FileError, WorldFile};
use crate::{FieldError, Outline, Point, Room, Surface, World};

/// How far an obstacle may reach into a cell, as a share of its side, before it counts: rounding at its edge does not.
const TOLERANCE: f64 = 1e-6;

/// The most cells of a map that is written.
const MOST_CELLS: f64 = 6.4e7;

/// A map of map_server.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MapFiles {
    /// What says where the picture lies, how large its cells are and what its colours mean.
    pub yaml: String,
    /// The picture, a binary PGM: occupied cells are black, others almost white (254).
    pub pgm: Vec<u8>,
}

/// A map of a world in cells of `resolution` metres, with its picture under the name `image`.
///
/// A cell is occupied if an obstacle covers any of it or if it reaches out of the room, so that what is free on the map
/// is free in the world, but for its movers, which are not written. [`parse_map`](super::parse_map) reads back boxes whose map is the same, cell by cell. Start
/// and goal stand in a key of our own, `headway`, which ROS passes over.
///
/// # Errors
/// If the resolution is not from 0.1 mm to 1 km, or makes more than 64 million cells.
///
/// ```
/// use headway_sim::files::{WorldFile, to_map};
/// use headway_sim::{Room, World};
/// let world = World::new(Room::new(3.0, 2.0), vec![])?;
/// let file = WorldFile { name: "hall".into(), world, start: None, goal: None, unsupported: vec![] };
/// let map = to_map(&file, 1.0, "hall.pgm")?;
/// assert_eq!(map.pgm, b"P5\n3 2\n255\n\xfe\xfe\xfe\xfe\xfe\xfe");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_map(file: &WorldFile, resolution: f64, image: &str) -> Result<MapFiles, FileError> {
    let cells = raster(&file.world, resolution).map_err(|e| FileError::at("", e))?;
    let mut pgm = format!("P5\n{} {}\n255\n", cells.n_columns, cells.n_rows).into_bytes();
    for row in (0..cells.n_rows).rev() {
        pgm.extend(cells.row(row).iter().map(|occupied| if *occupied { 0 } else { 254 }));
    }
    let room = file.world.room();
    // JSON's strings are YAML's too.
    let image: String =
        image.chars().map(|c| if c == '"' || c == '\\' { format!("\\{c}") } else { c.to_string() }).collect();
    let mut yaml = format!(
        "image: \"{image}\"\nmode: trinary\nresolution: {resolution}\norigin: [{}, {}, 0]\nnegate: 0\noccupied_thresh: 0.65\n\
         free_thresh: 0.196\n",
        room.x, room.y
    );
    if file.start.is_some() || file.goal.is_some() {
        yaml.push_str("headway:\n");
    }
    if let Some(start) = &file.start {
        let _ = writeln!(yaml, "  start: {:?}", start_numbers(start));
    }
    if let Some(goal) = &file.goal {
        let _ = writeln!(yaml, "  goal: {:?}", [goal.x, goal.y]);
    }
    Ok(MapFiles { yaml, pgm })
}

fn raster(world: &World, resolution: f64) -> Result<Cells, FieldError> {
    within("resolution", resolution, 1e-4, 1e3)?;
    let Room { x, y, width, height } = world.room();
    let n = |extent: f64| (extent / resolution - TOLERANCE).ceil().max(1.0);
    if n(width) * n(height) > MOST_CELLS {
        let allowed = format!("one that makes at most {MOST_CELLS} cells of a {width} x {height} m room");
        return Err(FieldError::new("resolution", resolution, allowed));
    }
    let mut cells = Cells::empty(n(width) as usize, n(height) as usize);
    occupy_edge(&mut cells, [width / resolution, height / resolution]);
    for index in 0..world.static_obstacles().len() {
        occupy(&mut cells, &world.outline(Surface::Obstacle(index)), &Point::new(x, y), resolution);
    }
    Ok(cells)
}

/// Occupies the cells that an obstacle covers any of, on a map with its lower left corner at `corner`.
fn occupy(cells: &mut Cells, outline: &Outline<'_>, corner: &Point, resolution: f64) {
    let (low, high) = bounds(outline);
    let range = |low: f64, high: f64, n: usize| {
        let cell = |along: f64| (along / resolution).clamp(0.0, n as f64) as usize;
        cell(low)..(cell(high) + 1).min(n)
    };
    for row in range(low.y - corner.y, high.y - corner.y, cells.n_rows) {
        for column in range(low.x - corner.x, high.x - corner.x, cells.n_columns) {
            let center = corner + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) * resolution;
            if covers(outline, &center, resolution / 2.0) {
                cells.occupy(column, row);
            }
        }
    }
}

/// Whether a convex outline covers any of the upright square of `half` the side around a point: no axis parts them.
fn covers(outline: &Outline<'_>, center: &Point, half: f64) -> bool {
    let tolerance = 2.0 * half * TOLERANCE;
    match outline {
        Outline::Disc { center: middle, radius } => {
            let beside = (middle - center).abs().add_scalar(-half).map(|beside| beside.max(0.0));
            beside.norm() < radius - tolerance
        }
        Outline::Polygon(vertices) => {
            let (low, high) = bounds(outline);
            let is_beside =
                |k: usize| high[k] - (center[k] - half) <= tolerance || center[k] + half - low[k] <= tolerance;
            let edges = vertices.iter().zip(vertices.iter().cycle().skip(1));
            let mut sides = edges.map(|(a, b)| (a, Vector2::new(b.y - a.y, a.x - b.x).normalize()));
            let is_outside = |(a, normal): (&Point, Vector2<f64>)| {
                normal.dot(&(center - a)) - half * (normal.x.abs() + normal.y.abs()) >= -tolerance
            };
            !is_beside(0) && !is_beside(1) && !sides.any(is_outside)
        }
        Outline::Wall(_) => false,
    }
}

/// Occupies the cells that reach out of a room of so many cells, a number that need not be whole.
fn occupy_edge(cells: &mut Cells, [width, height]: [f64; 2]) {
    let is_out = |k: usize, extent: f64| (k + 1) as f64 > extent + TOLERANCE;
    let (column, row) = (cells.n_columns - 1, cells.n_rows - 1);
    if is_out(column, width) {
        (0..cells.n_rows).for_each(|row| cells.occupy(column, row));
    }
    if is_out(row, height) {
        (0..cells.n_columns).for_each(|column| cells.occupy(column, row));
    }
}

/// The upright box around an outline.
fn bounds(outline: &Outline<'_>) -> (Point, Point) {
    match outline {
        Outline::Disc { center, radius } => (center.map(|x| x - radius), center.map(|x| x + radius)),
        Outline::Polygon(corners) => box_of(corners),
        Outline::Wall(ends) => box_of(ends),
    }
}

fn box_of(corners: &[Point]) -> (Point, Point) {
    let first = (corners[0], corners[0]);
    corners.iter().fold(first, |(low, high), p| (low.inf(p), high.sup(p)))
}
