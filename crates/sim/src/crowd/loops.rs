//! Loops of waypoints that the spec gives.

use rand::RngExt;

use super::CrowdMotion;
use super::ground::{GAP, Ground};
use crate::check::within;
use crate::{FieldError, Point, Shape, World};

/// The most loops, and the most points of one.
const MOST: usize = 1000;

/// How far from the origin a point may lie, metres.
const FARTHEST: f64 = 1e6;

/// Checks the numbers of loops.
pub(super) fn check(loops: &[Vec<[f64; 2]>]) -> Result<(), FieldError> {
    if loops.len() > MOST {
        return Err(FieldError::new("loops", format!("{} loops", loops.len()), format!("at most {MOST}")));
    }
    for (i, points) in loops.iter().enumerate() {
        let n = points.len();
        if !(2..=MOST).contains(&n) {
            return Err(FieldError::new(format!("loops.{i}"), format!("{n} points"), format!("from 2 to {MOST}")));
        }
        for (k, point) in points.iter().enumerate() {
            let place = format!("loops.{i}.{k}");
            point.iter().try_for_each(|x| within(&place, *x, -FARTHEST, FARTHEST))?;
            if *point == points[(k + n - 1) % n] {
                let allowed = "another place than the point before: a loop closes by itself";
                return Err(FieldError::new(place, format!("{point:?}"), allowed));
            }
        }
    }
    Ok(())
}

impl CrowdMotion {
    /// The loop of the mover number `own`, where loops are given: they are shared in turn.
    pub(super) fn loop_of(&self, own: usize) -> Option<&[[f64; 2]]> {
        match self {
            Self::Waypoints { loops, .. } if !loops.is_empty() => Some(&loops[own % loops.len()]),
            _ => None,
        }
    }

    /// Refuses loops on which the largest of their movers would meet what stands still.
    pub(super) fn check_loops_in(&self, world: &World, shapes: &[Shape]) -> Result<(), FieldError> {
        let Self::Waypoints { loops, .. } = self else { return Ok(()) };
        let ground = Ground::new(world, &[], None);
        for (i, points) in loops.iter().enumerate() {
            let radii = shapes.iter().skip(i).step_by(loops.len()).map(Shape::circumradius);
            let Some(radius) = radii.reduce(f64::max) else { continue };
            for (k, [from, to]) in legs(points).enumerate() {
                let is_free = ground.has_room_around(&from, radius + GAP) && ground.is_free(&from, &to, radius + GAP);
                if !is_free {
                    let allowed =
                        format!("a place from which a way free for a radius of {radius:.3} m leads to the next");
                    return Err(FieldError::new(format!("motion.loops.{i}.{k}"), format!("{:?}", points[k]), allowed));
                }
            }
        }
        Ok(())
    }
}

/// Where a mover may begin on its loop, and the number of the point that it goes to: at the first point, or, if it was tried
/// already, anywhere.
pub(super) fn draw_begin(points: &[[f64; 2]], n_tried: usize, rng: &mut impl RngExt) -> (Point, usize) {
    let begin = (Point::from(points[0]), 1);
    if n_tried == 0 {
        return begin;
    }
    let length = |[from, to]: [Point; 2]| (to - from).norm();
    let mut left = rng.random_range(0.0..legs(points).map(length).sum());
    for (k, leg) in legs(points).enumerate() {
        let [from, to] = leg;
        if left < length(leg) {
            return (from + (to - from) * (left / length(leg)), (k + 1) % points.len());
        }
        left -= length(leg);
    }
    begin
}

/// The ways from each point to the next, the last one back to the first.
fn legs(points: &[[f64; 2]]) -> impl Iterator<Item = [Point; 2]> {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(from, to)| [Point::from(*from), Point::from(*to)])
}
