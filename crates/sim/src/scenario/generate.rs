//! Random rooms by rejection: draw, and keep what satisfies the spec.

use std::f64::consts::{PI, TAU};

use rand::RngExt;

use super::path_check::PathCheck;
use super::spec::no_route;
use super::{Interval, Kinds, Quantity, RoomSpec, Scenario};
use crate::{Footprint, Obstacle, Pose, Room, Shape, SimError, World};

/// How often an obstacle is tried in one layout.
const PLACE_TRIES: usize = 500;
/// How many layouts are tried.
const LAYOUT_TRIES: usize = 20;
/// How many pairs of start and goal are tried in one layout.
const PAIR_TRIES: usize = 50;

/// A scenario that satisfies `spec`, with its path checked.
pub(super) fn scenario(spec: &RoomSpec, footprint: &Footprint, rng: &mut impl RngExt) -> Result<Scenario, SimError> {
    let mut last_error = None;
    for _ in 0..LAYOUT_TRIES {
        let room = Room { width: spec.width.sample(rng), height: spec.height.sample(rng) };
        match furnish(spec, room, rng).and_then(|world| start_and_goal(spec, world, footprint, rng)) {
            Ok(scenario) => return Ok(scenario),
            Err(error) => last_error = Some(error),
        }
    }
    Err(last_error.expect("LAYOUT_TRIES is above 0"))
}

/// A room with all its obstacles.
fn furnish(spec: &RoomSpec, room: Room, rng: &mut impl RngExt) -> Result<World, SimError> {
    let n_obstacles = match spec.obstacles {
        Quantity::Count(count) => count,
        Quantity::Density(density) => (density.sample(rng) * room.width * room.height).round() as usize,
    };
    let mut world = World::new(room, Vec::new())?;
    for index in 0..n_obstacles {
        let shape = draw_shape(&spec.kinds, &spec.obstacle_radius, rng);
        let outline = Footprint::of_obstacle(&shape);
        let place = (0..PLACE_TRIES)
            .map(|_| draw_pose(&room, rng))
            .find(|pose| world.clearance(&outline, pose) >= spec.min_gap);
        let Some(pose) = place else {
            return Err(SimError::CannotPlace {
                what: format!("obstacle {} of {n_obstacles} (radius {:.2} m)", index + 1, shape.circumradius()),
                width: room.width,
                height: room.height,
                min_gap: spec.min_gap,
                tries: PLACE_TRIES,
            });
        };
        let (x, y) = (pose.translation.x, pose.translation.y);
        world.push(Obstacle { shape, x, y, yaw: pose.rotation.angle() });
    }
    Ok(world)
}

fn draw_pose(room: &Room, rng: &mut impl RngExt) -> Pose {
    let (x, y) = (rng.random_range(0.0..room.width), rng.random_range(0.0..room.height));
    Pose::new([x, y].into(), rng.random_range(-PI..PI))
}

/// A shape of a random kind whose circumscribed circle has a random radius.
fn draw_shape(kinds: &Kinds, radius: &Interval, rng: &mut impl RngExt) -> Shape {
    let radius = radius.sample(rng);
    let kind = rng.random_range(0.0..kinds.disc + kinds.r#box + kinds.polygon);
    if kind < kinds.disc {
        Shape::Disc { radius }
    } else if kind < kinds.disc + kinds.r#box {
        // The half-diagonal's angle: from one to four times as long as wide.
        let (half_width, half_length) = rng.random_range(0.25_f64.atan()..PI / 4.0).sin_cos();
        Shape::Box { length: 2.0 * radius * half_length, width: 2.0 * radius * half_width }
    } else {
        draw_polygon(radius, rng)
    }
}

/// Three to seven corners on a circle, at least a third of their mean spacing apart.
fn draw_polygon(radius: f64, rng: &mut impl RngExt) -> Shape {
    let n: usize = rng.random_range(3..=7);
    let spacings: Vec<f64> = (0..n).map(|_| rng.random_range(0.5..1.5)).collect();
    let scale = TAU / spacings.iter().sum::<f64>();
    let vertices = spacings
        .iter()
        .scan(0.0, |angle, spacing| {
            *angle += spacing * scale;
            let (sin, cos) = angle.sin_cos();
            Some([radius * cos, radius * sin])
        })
        .collect();
    Shape::Polygon { vertices }
}

fn start_and_goal(
    spec: &RoomSpec,
    world: World,
    footprint: &Footprint,
    rng: &mut impl RngExt,
) -> Result<Scenario, SimError> {
    let rule = spec.goal_rule();
    for _ in 0..PAIR_TRIES {
        let ends = rule.place(&world, footprint, rng).zip(rule.place(&world, footprint, rng));
        let Some((start, goal)) = ends else { break };
        let far_enough = nalgebra::distance(&start, &goal) >= rule.distance;
        if far_enough && PathCheck::new(&world, start, footprint, &rule).joins(&goal) {
            let start = Pose::new(start.coords, rng.random_range(-PI..PI));
            return Ok(Scenario { world, start, goal, goal_rule: rule });
        }
    }
    Err(no_route(&world.room(), &rule, footprint, PAIR_TRIES))
}
