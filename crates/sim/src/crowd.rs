//! Obstacles that move: people, carts, other robots.
//!
//! A [`CrowdSpec`] becomes a [`Crowd`] in a [`World`], and every [`Crowd::step`] moves the world's movers. One moves after the
//! other, each only as far as the way is free, so that none ever overlaps another one or what stands still.

mod gait;
mod ground;
mod loops;
mod orca;
mod place;
mod program;
mod spec;
#[cfg(test)]
mod tests;
mod tour;

use nalgebra::Vector2;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::{FieldError, Point, World};
use gait::{Gait, Walk};
use ground::Ground;
use orca::Horizon;

pub use spec::{CrowdMotion, CrowdSpec};

/// Something that moves, as the disc around it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Mover {
    /// Its centre, metres.
    pub position: Point,
    /// m/s in the world's frame: the mean over the last step or, before the first, where it is going to go.
    pub velocity: Vector2<f64>,
    /// Metres.
    pub radius: f64,
}

/// The movers of a world and all that decides how they go on, random stream included.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Crowd {
    motion: CrowdMotion,
    regards_vehicle: bool,
    movers: Vec<Mover>,
    /// Of each mover.
    walks: Vec<Walk>,
    rng: ChaCha8Rng,
}

impl Crowd {
    /// The movers, in the order of [`World::movers`].
    #[must_use]
    pub fn movers(&self) -> &[Mover] {
        &self.movers
    }

    /// The highest speed of any of them, m/s.
    pub(crate) fn fastest(&self) -> f64 {
        self.walks.iter().map(|walk| walk.speed).fold(0.0, f64::max)
    }

    /// Whether movers regard the vehicle; see [`CrowdSpec::avoids_vehicle`].
    #[must_use]
    pub fn regards_vehicle(&self) -> bool {
        self.regards_vehicle
    }

    /// Moves the world's movers on by `dt` seconds, none by more than its speed allows; by nothing unless `dt` is a finite
    /// number above 0.
    ///
    /// The vehicle is where it is before the step, as the disc around it; `None` if there is none to regard.
    ///
    /// # Panics
    /// If the world's movers are not this crowd's ([`Self::check`]).
    pub fn step(&mut self, world: &mut World, dt: f64, vehicle: Option<&Mover>) {
        assert_eq!(world.movers().len(), self.movers.len(), "a crowd steps in its own world");
        if !(dt > 0.0 && dt.is_finite()) {
            return;
        }
        let vehicle = vehicle.filter(|_| self.regards_vehicle);
        let velocities = self.reciprocal_velocities(world, dt, vehicle);
        let first = world.static_obstacles().len();
        for own in 0..self.movers.len() {
            let end = self.advance(own, world, dt, vehicle, &velocities);
            let mover = &mut self.movers[own];
            mover.velocity = (end - mover.position) / dt;
            mover.position = end;
            let yaw = world.movers()[own].yaw;
            world.set_place(first + own, [end.x, end.y, yaw]).expect("a mover keeps off the walls");
        }
    }

    /// Where a mover gets to in a step.
    fn advance(
        &mut self,
        own: usize,
        world: &World,
        dt: f64,
        vehicle: Option<&Mover>,
        velocities: &[Vector2<f64>],
    ) -> Point {
        let (mover, ground) = (&self.movers[own], Ground::new(world, &self.movers, vehicle));
        let Walk { speed, gait } = &mut self.walks[own];
        match gait {
            Gait::Tour(tour) => tour.walk(own, mover, *speed * dt, &ground),
            Gait::Random { heading } => {
                let CrowdMotion::RandomWalk { turning } = self.motion else { return mover.position };
                gait::stroll(heading, (own, mover), (*speed * dt, turning * dt.sqrt()), &ground, &mut self.rng)
            }
            Gait::Errand(errand) => {
                errand.go_on(*speed, mover, dt, &ground, &mut self.rng);
                ground.end_of_way(own, mover, &velocities[own], dt)
            }
        }
    }

    /// The velocities that reciprocal movers choose, all at the same time; none for others.
    fn reciprocal_velocities(&self, world: &World, dt: f64, vehicle: Option<&Mover>) -> Vec<Vector2<f64>> {
        let CrowdMotion::Reciprocal { horizon, obstacle_horizon } = self.motion else { return Vec::new() };
        let horizon = Horizon { movers: horizon, obstacles: obstacle_horizon, dt };
        let ground = Ground::new(world, &self.movers, vehicle);
        let fastest = self.fastest();
        let velocity = |own: (usize, &Mover), walk: &Walk| {
            let wanted = walk.wanted(&own.1.position, dt);
            orca::velocity(&ground, own, (walk.speed, fastest), &wanted, horizon)
        };
        self.movers.iter().enumerate().zip(&self.walks).map(|(own, walk)| velocity(own, walk)).collect()
    }

    /// Checks that the movers of a world are this crowd's.
    ///
    /// # Errors
    /// Says what differs.
    pub fn check(&self, world: &World) -> Result<(), FieldError> {
        let (n, allowed) = (self.movers.len(), "the movers of the world");
        if world.movers().len() != n || self.walks.len() != n {
            return Err(FieldError::new("movers.len", n, format!("as many as {allowed}, {}", world.movers().len())));
        }
        for (i, (mover, obstacle)) in self.movers.iter().zip(world.movers()).enumerate() {
            let is_same = mover.position == Point::new(obstacle.x, obstacle.y)
                && mover.radius == obstacle.shape.circumradius()
                && self.walks[i].suits(&self.motion);
            if !is_same {
                return Err(FieldError::new(format!("movers.{i}"), format!("{mover:?}"), format!("one of {allowed}")));
            }
        }
        Ok(())
    }
}
