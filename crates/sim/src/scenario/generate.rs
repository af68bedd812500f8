//! Random rooms by rejection: draw, and keep what satisfies the spec.

use std::f64::consts::{PI, TAU};

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::path_check::PathCheck;
use super::populate::populate;
use super::{GoalRule, Interval, Kinds, Quantity, RoomSpec, Scenario};
use crate::{Footprint, Obstacle, Point, Pose, Room, Shape, SimError, World};

/// How often an obstacle is tried in one layout.
const PLACE_TRIES: usize = 500;
/// How many layouts are tried.
const LAYOUT_TRIES: usize = 20;
/// How many pairs of start and goal are tried in one layout.
const PAIR_TRIES: usize = 50;

/// A scenario that satisfies `spec`, with its path checked, from one random stream for the layout, one
/// for the two ends and one for the crowd.
///
/// The room, the number of obstacles and their shapes are drawn once; only where they stand is drawn again
/// when they do not fit, or their crowd does not fit among them. Drawing all again would favour large rooms with few and small obstacles.
pub(super) fn scenario(
    spec: &RoomSpec,
    footprint: &Footprint,
    mut layout: impl RngExt,
    mut ends: impl RngExt,
    mut crowd: ChaCha8Rng,
) -> Result<Scenario, SimError> {
    let (layout, ends) = (&mut layout, &mut ends);
    let room = Room::new(spec.width.sample(layout), spec.height.sample(layout));
    let shapes = draw_shapes(spec, &room, layout);
    let rule = spec.goal_rule();
    let mut last_error = None;
    for _ in 0..LAYOUT_TRIES {
        let made = furnish(room, &shapes, spec.min_gap, layout).and_then(|world| {
            let (start, goal) = start_and_goal(&rule, &world, footprint, ends)?;
            let scenario = Scenario { world, start, goal, goal_rule: rule, crowd: None };
            populate(scenario, spec.crowd.as_ref(), footprint, &mut crowd)
        });
        match made {
            Ok(scenario) => return Ok(scenario),
            Err(error) => last_error = Some(error),
        }
    }
    Err(last_error.expect("LAYOUT_TRIES is above 0"))
}

/// The shapes of all obstacles of a room.
fn draw_shapes(spec: &RoomSpec, room: &Room, rng: &mut impl RngExt) -> Vec<Shape> {
    let n_obstacles = match spec.obstacles {
        Quantity::Count(count) => count,
        Quantity::Density(density) => (density.sample(rng) * room.width * room.height).round() as usize,
    };
    (0..n_obstacles).map(|_| draw_shape(&spec.kinds, &spec.obstacle_radius, rng)).collect()
}

/// A room in which all the shapes stand.
fn furnish(room: Room, shapes: &[Shape], min_gap: f64, rng: &mut impl RngExt) -> Result<World, SimError> {
    let mut world = World::empty(room, shapes.len())?;
    for (index, shape) in shapes.iter().enumerate() {
        let outline = Footprint::of_obstacle(shape);
        let mut draws = (0..PLACE_TRIES).map(|_| draw_place(&room, rng));
        let place = draws.find(|[x, y, yaw]| match shape {
            Shape::Disc { .. } => world.has_room(&outline, &Pose::translation(*x, *y), min_gap),
            _ => world.has_room(&outline, &Pose::new([*x, *y].into(), *yaw), min_gap),
        });
        let Some([x, y, yaw]) = place else {
            let (n, radius) = (shapes.len(), shape.circumradius());
            return Err(SimError::CannotPlace {
                what: format!("obstacle {} of {n} (radius {radius:.2} m)", index + 1),
                width: room.width,
                height: room.height,
                min_gap,
                tries: PLACE_TRIES,
            });
        };
        world.push(Obstacle { shape: shape.clone(), x, y, yaw });
    }
    Ok(world)
}

/// Position and yaw.
fn draw_place(room: &Room, rng: &mut impl RngExt) -> [f64; 3] {
    let Point { coords } = room.sample(rng);
    [coords.x, coords.y, rng.random_range(-PI..PI)]
}

/// A shape of a random kind whose circumscribed circle has a random radius.
pub(crate) fn draw_shape(kinds: &Kinds, radius: &Interval, rng: &mut impl RngExt) -> Shape {
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

/// Two places that a path joins, the first with a yaw.
pub(super) fn start_and_goal(
    rule: &GoalRule,
    world: &World,
    footprint: &Footprint,
    rng: &mut impl RngExt,
) -> Result<(Pose, Point), SimError> {
    let mut check = PathCheck::new(world, footprint, rule);
    for _ in 0..PAIR_TRIES {
        let ends = rule.place(world, footprint, rng).zip(rule.place(world, footprint, rng));
        let Some((start, goal)) = ends else { break };
        if nalgebra::distance(&start, &goal) >= rule.distance && check.joins(&start, &goal) {
            return Ok((Pose::new(start.coords, rng.random_range(-PI..PI)), goal));
        }
    }
    Err(rule.no_route(&world.room(), footprint, PAIR_TRIES))
}
