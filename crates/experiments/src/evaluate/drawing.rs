//! Drives as pictures need them.

use std::ops::Range;

use headway_env::{Mdp, Navigator};
use headway_sim::{Point, Room, Scenario, Surface, World};

use crate::Error;
use crate::episode::Outcome;
use crate::plot::{Outline, PathSample, Track, Trajectory};

/// A drive in a scenario as a picture needs it; `drive` shows every state of it and tells how it ended.
pub(crate) fn draw(
    mdp: &Mdp,
    scenario: &Scenario,
    title: String,
    drive: impl FnOnce(&mut dyn FnMut(&Navigator)) -> Result<Outcome, Error>,
) -> Result<Trajectory, Error> {
    let (mut samples, mut t) = (Vec::new(), 0.0);
    let (still, moving) = (still(&scenario.world), moving(&scenario.world));
    let mut movers: Vec<Track> = outlines(&scenario.world, moving.clone()).map(Track::new).collect();
    let outcome = drive(&mut |vehicle| {
        t += vehicle.step_duration();
        let (pose, twist) = (vehicle.vehicle().pose, vehicle.vehicle().twist);
        let (x, y) = (pose.translation.x, pose.translation.y);
        samples.push(PathSample { t, x, y, yaw: pose.rotation.angle(), speed: twist.x });
        let world = &vehicle.scenario().world;
        for ((track, mover), outline) in movers.iter_mut().zip(world.movers()).zip(outlines(world, moving.clone())) {
            track.places.push([mover.x, mover.y]);
            track.last = outline;
        }
    })?;
    let obstacles: Vec<Outline> = outlines(&scenario.world, still).collect();
    let ends = [scenario.start.translation.vector.into(), scenario.goal];
    let view = view(&scenario.world.room(), &obstacles, &movers, ends);
    Ok(Trajectory {
        title,
        x: view.x,
        y: view.y,
        width: view.width,
        height: view.height,
        obstacles,
        movers,
        goal: [scenario.goal.x, scenario.goal.y],
        reach_radius: mdp.reach_radius(),
        footprint_radius: mdp.vehicle().footprint().circumradius(),
        samples,
        outcome,
    })
}

/// The part of a room that is shown: all of it, or where most of it is empty, what stands or moves in it, the ends of the way,
/// and a metre around.
fn view(room: &Room, obstacles: &[Outline], movers: &[Track], ends: [Point; 2]) -> Room {
    const MARGIN: f64 = 1.0;
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let mut hold = |point: [f64; 2], radius: f64| {
        for axis in 0..2 {
            low[axis] = low[axis].min(point[axis] - radius);
            high[axis] = high[axis].max(point[axis] + radius);
        }
    };
    ends.iter().for_each(|end| hold([end.x, end.y], 0.0));
    movers.iter().flat_map(|track| &track.places).for_each(|place| hold(*place, 0.0));
    for obstacle in obstacles.iter().chain(movers.iter().flat_map(|track| [&track.first, &track.last])) {
        match obstacle {
            Outline::Disc { x, y, radius } => hold([*x, *y], *radius),
            Outline::Polygon { points } => points.iter().for_each(|point| hold(*point, 0.0)),
        }
    }
    let (x, y) = ((low[0] - MARGIN).max(room.x), (low[1] - MARGIN).max(room.y));
    let right = (high[0] + MARGIN).min(room.x + room.width);
    let above = (high[1] + MARGIN).min(room.y + room.height);
    let part = Room { x, y, width: right - x, height: above - y };
    if part.width * part.height < 0.5 * room.width * room.height { part } else { *room }
}

/// The obstacles of a world that stand still.
fn still(world: &World) -> Range<usize> {
    0..world.static_obstacles().len()
}

/// Those that move.
fn moving(world: &World) -> Range<usize> {
    world.static_obstacles().len()..world.obstacles().len()
}

fn outlines(world: &World, which: Range<usize>) -> impl Iterator<Item = Outline> {
    which.map(Surface::Obstacle).filter_map(|surface| match world.outline(surface) {
        headway_sim::Outline::Disc { center, radius } => Some(Outline::Disc { x: center.x, y: center.y, radius }),
        headway_sim::Outline::Polygon(corners) => {
            Some(Outline::Polygon { points: corners.iter().map(|corner| [corner.x, corner.y]).collect() })
        }
        headway_sim::Outline::Wall(_) => None,
    })
}
