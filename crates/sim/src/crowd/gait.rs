//! How a mover chooses its way, and the part of its state that this takes.

use nalgebra::Vector2;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use super::ground::Ground;
use super::tour::Tour;
use super::{CrowdMotion, Mover};
use crate::Point;

/// A mover's state beside place and velocity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Walk {
    /// The highest speed, m/s.
    pub(super) speed: f64,
    pub(super) gait: Gait,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) enum Gait {
    Tour(Tour),
    /// The direction of motion, radians.
    Random {
        heading: f64,
    },
    Errand(Errand),
}

/// A place to go to, and the time for it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Errand {
    goal: Point,
    /// Seconds until it is given up.
    patience: f64,
}

/// How often a point is drawn.
pub(super) const TRIES: usize = 50;

impl Walk {
    /// A mover's first state.
    pub(super) fn new(
        motion: &CrowdMotion,
        speed: f64,
        mover: &Mover,
        ground: &Ground<'_>,
        rng: &mut impl RngExt,
    ) -> Self {
        use std::f64::consts::PI;
        let gait = match *motion {
            CrowdMotion::Waypoints { n_points, .. } => Gait::Tour(Tour::new(n_points, mover, ground, rng)),
            CrowdMotion::RandomWalk { .. } => Gait::Random { heading: rng.random_range(-PI..PI) },
            CrowdMotion::Reciprocal { .. } => Gait::Errand(Errand::new(speed, mover, ground, rng)),
        };
        Self { speed, gait }
    }

    /// The first state of a mover on a given loop, on the way to one of its points.
    pub(super) fn round(speed: f64, points: &[[f64; 2]], next: usize) -> Self {
        Self { speed, gait: Gait::Tour(Tour::round(points, next)) }
    }

    /// Whether this is a walk by a rule, with the places that it needs.
    pub(super) fn suits(&self, motion: &CrowdMotion) -> bool {
        match (&self.gait, motion) {
            (Gait::Tour(tour), CrowdMotion::Waypoints { .. }) => tour.has_next(),
            (Gait::Random { .. }, CrowdMotion::RandomWalk { .. }) => true,
            (Gait::Errand(_), CrowdMotion::Reciprocal { .. }) => true,
            _ => false,
        }
    }

    /// The velocity at which it would go if nothing were in the way, m/s.
    pub(super) fn wanted(&self, position: &Point, dt: f64) -> Vector2<f64> {
        let towards = |goal: &Point| {
            let to = goal - position;
            let length = to.norm();
            if length > 0.0 { to * (self.speed.min(length / dt) / length) } else { Vector2::zeros() }
        };
        match &self.gait {
            Gait::Tour(tour) => towards(&tour.next()),
            Gait::Random { heading } => Vector2::new(heading.cos(), heading.sin()) * self.speed,
            Gait::Errand(errand) => towards(&errand.goal),
        }
    }
}

/// A random walk's step: the heading diffuses, a Wiener process of `turning` rad/sqrt(s), and is mirrored where something is in
/// the way. The end of the step.
pub(super) fn stroll(
    heading: &mut f64,
    (own, mover): (usize, &Mover),
    (length, turn): (f64, f64),
    ground: &Ground<'_>,
    rng: &mut impl RngExt,
) -> Point {
    let normal: f64 = StandardNormal.sample(rng);
    *heading = crate::wrap(*heading + turn * normal);
    let ahead = Vector2::new(heading.cos(), heading.sin());
    let end = mover.position + ahead * length;
    match ground.first_contact(own, mover.radius, &mover.position, &end) {
        None => end,
        Some(contact) => {
            let mirrored = ahead - contact.normal * (2.0 * ahead.dot(&contact.normal));
            *heading = mirrored.y.atan2(mirrored.x);
            mover.position + ahead * contact.distance
        }
    }
}

impl Errand {
    /// To a given place, for as many seconds.
    #[cfg(test)]
    pub(super) fn to(goal: Point, patience: f64) -> Self {
        Self { goal, patience }
    }

    /// A free place, if possible one to which the straight way is free of what stands still.
    fn new(speed: f64, mover: &Mover, ground: &Ground<'_>, rng: &mut impl RngExt) -> Self {
        const MARGIN: f64 = 0.1;
        let still = ground.without_movers();
        let mut goal = mover.position;
        for _ in 0..TRIES {
            let point = still.room().sample(rng);
            if !still.has_room_around(&point, mover.radius + MARGIN) {
                continue;
            }
            let is_free = still.is_free(&mover.position, &point, mover.radius);
            if is_free || goal == mover.position {
                goal = point;
            }
            if is_free {
                break;
            }
        }
        let patience = 2.0 + 2.0 * (goal - mover.position).norm() / speed.max(1e-3);
        Self { goal, patience }
    }

    /// Goes for a step; a new errand where the place is reached or time is out.
    pub(super) fn go_on(&mut self, speed: f64, mover: &Mover, dt: f64, ground: &Ground<'_>, rng: &mut impl RngExt) {
        self.patience -= dt;
        let is_there = (self.goal - mover.position).norm() <= mover.radius;
        if is_there || self.patience <= 0.0 {
            *self = Self::new(speed, mover, ground, rng);
        }
    }
}
