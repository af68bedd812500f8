//! Optimal reciprocal collision avoidance (ORCA).
//!
//! Van den Berg, Guy, Lin and Manocha, *Reciprocal n-body collision avoidance*, ISRR 2009 (Springer 2011): every mover takes
//! the velocity nearest to the one it wants among those that half-planes allow, one for each neighbour. Two that both do so
//! do not collide within the horizon. From the vehicle, which may be driven by anybody, no reciprocity is expected.

use nalgebra::{Rotation2, Vector2};

use super::Mover;
use super::ground::{GAP, Ground, Thing};
use super::program::{HalfPlane, nearest_allowed};

/// By how much movers are larger to each other than they are, metres: so that they do not stop each other.
const SKIN: f64 = 0.01;

/// By how much movers that are hindered want to turn to the right, radians: two that meet exactly head-on would slow down
/// for ever, each waiting for the other.
const KEEP_RIGHT: f64 = 0.1;

/// How far movers look ahead, seconds, and how far time goes in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Horizon {
    /// For other movers and the vehicle.
    pub(super) movers: f64,
    /// For walls and obstacles that stand still.
    pub(super) obstacles: f64,
    /// The time step.
    pub(super) dt: f64,
}

/// The velocity that the mover number `own` takes, of at most `speed` m/s: the wanted one, no faster than that, if it is
/// allowed, or else the nearest to it a little to the right.
///
/// `fastest` is the highest speed of whatever else moves, m/s.
pub(super) fn velocity(
    ground: &Ground<'_>,
    (own, mover): (usize, &Mover),
    (speed, fastest): (f64, f64),
    wanted: &Vector2<f64>,
    horizon: Horizon,
) -> Vector2<f64> {
    let reach = mover.radius + ((speed + fastest) * horizon.movers).max(speed * horizon.obstacles) + 2.0 * SKIN;
    let mut planes: Vec<HalfPlane> = (0..4).map(|wall| still(ground, &Thing::Wall(wall), mover, horizon)).collect();
    let mut soft = Vec::new();
    for thing in ground.near(own, &mover.position, reach) {
        match thing {
            Thing::Vehicle(vehicle) => soft.push(between(mover, vehicle, 1.0, horizon)),
            Thing::Mover(other) => soft.push(between(mover, other, 0.5, horizon)),
            thing => planes.push(still(ground, &thing, mover, horizon)),
        }
    }
    let n_hard = planes.len();
    planes.append(&mut soft);
    if planes.iter().all(|plane| plane.violation(wanted) <= 0.0) {
        return *wanted;
    }
    nearest_allowed(&planes, n_hard, speed, &(Rotation2::new(-KEEP_RIGHT) * wanted))
}

/// What a thing that stands still allows: no faster towards its nearest point than to be there after the horizon (section
/// 4.4 there: its half-plane is that of velocity 0, which is always allowed).
fn still(ground: &Ground<'_>, thing: &Thing<'_>, mover: &Mover, horizon: Horizon) -> HalfPlane {
    let (distance, normal) = ground.away_from(thing, &mover.position);
    let room = (distance - mover.radius - 2.0 * GAP).max(0.0);
    HalfPlane { normal, offset: -room / horizon.obstacles }
}

/// What another disc allows: the velocities beyond the tangent of the velocity obstacle (the truncated cone of relative
/// velocities that lead to a contact within the horizon) where it is nearest to the present relative velocity, after `share`
/// of the change that is needed. A contact already made is undone within the time step.
fn between(mover: &Mover, other: &Mover, share: f64, horizon: Horizon) -> HalfPlane {
    let to_other = other.position - mover.position;
    let relative = mover.velocity - other.velocity;
    let radius = mover.radius + other.radius + 2.0 * SKIN;
    let leg_squared = to_other.norm_squared() - radius * radius;
    let time = if leg_squared > 0.0 { horizon.movers } else { horizon.dt };
    // From the centre of the cone's round end.
    let from_center = relative - to_other / time;
    let along = from_center.dot(&to_other);
    let is_before_the_legs = along < 0.0 && along * along > radius * radius * from_center.norm_squared();
    let (normal, change) = if leg_squared <= 0.0 || is_before_the_legs {
        let length = from_center.norm();
        let normal = if length > 0.0 { from_center / length } else { Vector2::x() };
        (normal, radius / time - length)
    } else {
        let normal = leg_normal(&to_other, radius, leg_squared.sqrt(), to_other.perp(&from_center) > 0.0);
        (normal, -normal.dot(&relative))
    };
    HalfPlane { normal, offset: normal.dot(&mover.velocity) + share * change }
}

/// The outward normal of the left or right leg of the cone.
fn leg_normal(to_other: &Vector2<f64>, radius: f64, leg: f64, is_left: bool) -> Vector2<f64> {
    let side = if is_left { radius } else { -radius };
    // Along the leg: towards the other, turned by the angle whose sine is radius / distance.
    let tangent = Vector2::new(to_other.x * leg - to_other.y * side, to_other.x * side + to_other.y * leg);
    let outward = if is_left { Vector2::new(-tangent.y, tangent.x) } else { Vector2::new(tangent.y, -tangent.x) };
    outward / to_other.norm_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Point;

    const HORIZON: Horizon = Horizon { movers: 2.0, obstacles: 1.0, dt: 0.1 };

    fn mover(x: f64, y: f64, velocity: [f64; 2], radius: f64) -> Mover {
        Mover { position: Point::new(x, y), velocity: velocity.into(), radius: radius - SKIN }
    }

    #[test]
    fn half_planes_by_hand() {
        // Head-on, 4 m apart, radii 0.5, 1 m/s each: the relative velocity (2, 0) is the centre (4, 0) / 2 s of the round end,
        // whose radius is 0.5; the nearest of the cone's outline lies on a leg, whose sine is 1 / 4, at 2 / 4 = 0.5 m/s.
        let (a, b) = (mover(0.0, 0.0, [1.0, 0.0], 0.5), mover(4.0, 0.0, [-1.0, 0.0], 0.5));
        let [one, two] = [between(&a, &b, 0.5, HORIZON), between(&b, &a, 0.5, HORIZON)];
        assert!((one.violation(&a.velocity) - 0.25).abs() < 1e-12);
        assert!((one.normal.x + 0.25).abs() < 1e-12 && (one.normal.y + (1.0_f64 - 0.0625).sqrt()).abs() < 1e-12);
        // Reciprocal: the other's is the same, turned by half a turn.
        assert!((one.normal + two.normal).norm() < 1e-12 && (one.offset - two.offset).abs() < 1e-12);
        // Approached at 1 m/s from 4 m: 0.5 m/s too slow for the round end, at 2 - 0.5 = 1.5 m/s.
        let slow = between(&mover(0.0, 0.0, [1.0, 0.0], 0.5), &mover(4.0, 0.0, [0.0, 0.0], 0.5), 1.0, HORIZON);
        assert!((slow.normal + Vector2::x()).norm() < 1e-12 && (slow.offset + 1.5).abs() < 1e-12);
        // Overlapping by 0.2 m: apart at 2 m/s, to be free after 0.1 s; each does half.
        let overlapping = between(&mover(0.0, 0.0, [0.0, 0.0], 0.5), &mover(0.8, 0.0, [0.0, 0.0], 0.5), 0.5, HORIZON);
        assert!((overlapping.normal + Vector2::x()).norm() < 1e-12 && (overlapping.offset - 1.0).abs() < 1e-12);
    }
}
