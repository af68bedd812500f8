//! Worlds for Gazebo.

use std::fmt::Write;

use crate::files::WorldFile;
use crate::files::start_goal::start_numbers;
use crate::{Obstacle, Room, Shape};

/// The namespace of what only we read.
pub(super) const NAMESPACE: &str = "https://headway.rs/sdf/1";
/// The element that holds room, start and goal.
pub(super) const SCENARIO: &str = "scenario";
/// The element that marks a model as one of the room's walls.
pub(super) const WALL: &str = "wall";

/// How high obstacles and walls are written, metres: from the ground up.
const TALL: f64 = 2.0;

/// How thick walls are written, metres: outside of the room.
const THICK: f64 = 0.1;

/// An SDF 1.7 document of a world: obstacles and walls as static models of 2 m in height on a ground plane, and room,
/// start and goal in elements of a namespace of our own, which Gazebo passes over.
///
/// [`parse_sdf`](super::parse_sdf) reads it back bit for bit, at any slice height from 0 to 2 m; the walls are
/// recognised and not doubled. Movers are not written, as nothing would move them there, nor is the list of what is
/// unsupported.
///
/// ```
/// use headway_sim::files::{SdfSpec, WorldFile, parse_sdf, to_sdf};
/// use headway_sim::{Room, World};
/// let world = World::new(Room { x: 0.1, y: -0.3, width: 10.0, height: 15.0 }, vec![])?;
/// let file = WorldFile { name: "hall".into(), world, start: None, goal: None, unsupported: vec![] };
/// assert_eq!(parse_sdf(to_sdf(&file).as_bytes(), &SdfSpec::default())?.world.room(), file.world.room());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn to_sdf(file: &WorldFile) -> String {
    let mut sdf = String::from("<?xml version=\"1.0\"?>\n");
    let name = escaped(&file.name);
    let _ = writeln!(sdf, "<sdf version=\"1.7\" xmlns:headway=\"{NAMESPACE}\">\n  <world name=\"{name}\">");
    scenario(&mut sdf, file);
    model(&mut sdf, "ground_plane", "0 0 0 0 0 0", "<plane><normal>0 0 1</normal><size>100 100</size></plane>", "");
    for (index, wall) in walls(&file.world.room()).iter().enumerate() {
        obstacle(&mut sdf, &format!("wall_{index}"), wall, &format!("<headway:{WALL}/>"));
    }
    for (index, it) in file.world.static_obstacles().iter().enumerate() {
        obstacle(&mut sdf, &format!("obstacle_{index}"), it, "");
    }
    sdf.push_str("  </world>\n</sdf>\n");
    sdf
}

fn scenario(sdf: &mut String, file: &WorldFile) {
    let Room { x, y, width, height } = file.world.room();
    let start = file.start.as_ref().map(|start| ("start", start_numbers(start).to_vec()));
    let goal = file.goal.map(|goal| ("goal", vec![goal.x, goal.y]));
    let _ = writeln!(sdf, "    <headway:{SCENARIO}>");
    for (name, numbers) in [("room", vec![x, y, width, height])].into_iter().chain(start).chain(goal) {
        let numbers: Vec<_> = numbers.iter().map(f64::to_string).collect();
        let _ = writeln!(sdf, "      <headway:{name}>{}</headway:{name}>", numbers.join(" "));
    }
    let _ = writeln!(sdf, "    </headway:{SCENARIO}>");
}

/// The four walls as boxes around the room.
fn walls(room: &Room) -> [Obstacle; 4] {
    let Room { x, y, width, height } = *room;
    let (middle_x, middle_y, out) = (x + width / 2.0, y + height / 2.0, THICK / 2.0);
    let wall = |x, y, length, width| Obstacle { shape: Shape::Box { length, width }, x, y, yaw: 0.0 };
    [
        wall(x - out, middle_y, THICK, height + 2.0 * THICK),
        wall(middle_x, y - out, width + 2.0 * THICK, THICK),
        wall(x + width + out, middle_y, THICK, height + 2.0 * THICK),
        wall(middle_x, y + height + out, width + 2.0 * THICK, THICK),
    ]
}

fn obstacle(sdf: &mut String, name: &str, obstacle: &Obstacle, extra: &str) {
    // A polyline stands on its origin, all else is around it.
    let z = if matches!(obstacle.shape, Shape::Polygon { .. }) { 0.0 } else { TALL / 2.0 };
    let geometry = match &obstacle.shape {
        Shape::Disc { radius } => format!("<cylinder><radius>{radius}</radius><length>{TALL}</length></cylinder>"),
        Shape::Box { length, width } => format!("<box><size>{length} {width} {TALL}</size></box>"),
        Shape::Polygon { vertices } => {
            let points: String = vertices.iter().map(|[x, y]| format!("<point>{x} {y}</point>")).collect();
            format!("<polyline>{points}<height>{TALL}</height></polyline>")
        }
    };
    model(sdf, name, &format!("{} {} {z} 0 0 {}", obstacle.x, obstacle.y, obstacle.yaw), &geometry, extra);
}

fn model(sdf: &mut String, name: &str, pose: &str, geometry: &str, extra: &str) {
    let _ = write!(
        sdf,
        "    <model name=\"{name}\">{extra}\n      <static>true</static>\n      <pose>{pose}</pose>\n      <link name=\"link\">\n        \
         <collision name=\"collision\"><geometry>{geometry}</geometry></collision>\n        \
         <visual name=\"visual\"><geometry>{geometry}</geometry></visual>\n      </link>\n    </model>\n"
    );
}

/// A text as it may stand in an attribute; what XML cannot hold becomes a space.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&apos;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
