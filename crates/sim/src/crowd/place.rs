//! Where a crowd is at first.

use std::f64::consts::PI;

use nalgebra::Vector2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::gait::Walk;
use super::ground::Ground;
use super::{Crowd, CrowdSpec, Mover, loops};
use crate::scenario::draw_shape;
use crate::{Interval, Obstacle, Point, Shape, SimError, World};

/// How often a mover is tried in one arrangement.
const TRIES: usize = 500;

/// How many arrangements of all movers are tried: those placed first can leave no place for the last.
const ARRANGEMENTS: usize = 20;

/// Where a mover is at first.
struct Begin {
    position: Point,
    /// On a given loop: the point that it goes to.
    next: usize,
    yaw: f64,
}

impl CrowdSpec {
    /// Places a crowd at random in a world, whose movers it becomes; the world must have none.
    ///
    /// Nobody comes nearer than `min_gap` to the discs `keep_free`, each a centre and a radius in metres. All that is random,
    /// now and in steps, comes from `rng`, of which the crowd keeps a copy.
    ///
    /// # Errors
    /// Names a field that is not allowed, a given loop that something stands on, or the mover that found no place; the world
    /// is then as before.
    ///
    /// # Panics
    /// If the world has movers.
    ///
    /// ```
    /// use headway_sim::{CrowdSpec, Interval, Point, Room, World, stream};
    /// let mut world = World::new(Room::new(10.0, 10.0), vec![])?;
    /// let spec = CrowdSpec { n_movers: Interval::Fixed(3.0), ..CrowdSpec::default() };
    /// let mut crowd = spec.build(&mut world, &[(Point::new(2.0, 2.0), 0.25)], &mut stream(7, "crowd", 0))?;
    /// assert_eq!((crowd.movers().len(), world.movers().len()), (3, 3));
    /// crowd.step(&mut world, 0.2, None);
    /// assert_eq!(crowd.movers()[0].position.x, world.movers()[0].x);
    /// # Ok::<(), headway_sim::SimError>(())
    /// ```
    pub fn build(
        &self,
        world: &mut World,
        keep_free: &[(Point, f64)],
        rng: &mut ChaCha8Rng,
    ) -> Result<Crowd, SimError> {
        self.check()?;
        assert!(world.movers().is_empty(), "the world has movers");
        let shapes = self.draw_shapes(rng);
        self.motion.check_loops_in(world, &shapes)?;
        let begins = self.draw_arrangement(world, keep_free, &shapes, rng)?;
        let (movers, obstacles) = appear(shapes, &begins);
        let mut crowd = Crowd {
            motion: self.motion.clone(),
            regards_vehicle: self.regards_vehicle(),
            walks: self.draw_walks(world, &movers, &begins, rng),
            movers,
            rng: rng.clone(),
        };
        for (mover, walk) in crowd.movers.iter_mut().zip(&crowd.walks) {
            mover.velocity = walk.wanted(&mover.position, 0.0);
        }
        world.add_movers(obstacles)?;
        Ok(crowd)
    }

    fn draw_shapes(&self, rng: &mut ChaCha8Rng) -> Vec<Shape> {
        let n_movers = match self.n_movers {
            Interval::Fixed(n) => n as usize,
            Interval::Range([low, high]) => rng.random_range(low as usize..=high as usize),
        };
        (0..n_movers).map(|_| draw_shape(&self.kinds, &self.radius, rng)).collect()
    }

    /// Where all movers are at first: of several arrangements, the first that works out.
    fn draw_arrangement(
        &self,
        world: &World,
        keep_free: &[(Point, f64)],
        shapes: &[Shape],
        rng: &mut ChaCha8Rng,
    ) -> Result<Vec<Begin>, SimError> {
        let mut drawn = self.draw_begins(world, keep_free, shapes, rng);
        for _ in 1..ARRANGEMENTS {
            if drawn.is_ok() {
                break;
            }
            drawn = self.draw_begins(world, keep_free, shapes, rng);
        }
        drawn
    }

    fn draw_begins(
        &self,
        world: &World,
        keep_free: &[(Point, f64)],
        shapes: &[Shape],
        rng: &mut ChaCha8Rng,
    ) -> Result<Vec<Begin>, SimError> {
        let room = world.room();
        let mut taken = keep_free.to_vec();
        let mut begins = Vec::with_capacity(shapes.len());
        for (own, shape) in shapes.iter().enumerate() {
            let radius = shape.circumradius();
            let is_free = |(point, _): &(Point, usize)| {
                let apart =
                    |(center, other): &(Point, f64)| nalgebra::distance(point, center) >= radius + other + self.min_gap;
                taken.iter().all(apart) && world.has_room_around(point, radius + self.min_gap)
            };
            let mut draws = (0..TRIES).map(|n_tried| match self.motion.loop_of(own) {
                Some(points) => loops::draw_begin(points, n_tried, rng),
                None => (room.sample(rng), 0),
            });
            let Some((position, next)) = draws.find(is_free) else {
                return Err(SimError::CannotPlace {
                    what: format!("mover {} of {} (radius {radius:.2} m)", own + 1, shapes.len()),
                    width: room.width,
                    height: room.height,
                    min_gap: self.min_gap,
                    tries: TRIES,
                });
            };
            taken.push((position, radius));
            begins.push(Begin { position, next, yaw: rng.random_range(-PI..PI) });
        }
        Ok(begins)
    }

    fn draw_walks(&self, world: &World, movers: &[Mover], begins: &[Begin], rng: &mut ChaCha8Rng) -> Vec<Walk> {
        let ground = Ground::new(world, &[], None);
        let walk = |(own, mover): (usize, &Mover)| {
            let speed = self.speed.sample(rng);
            match self.motion.loop_of(own) {
                Some(points) => Walk::round(speed, points, begins[own].next),
                None => Walk::new(&self.motion, speed, mover, &ground, rng),
            }
        };
        movers.iter().enumerate().map(walk).collect()
    }
}

/// The movers, at rest, and the obstacles that they are.
fn appear(shapes: Vec<Shape>, begins: &[Begin]) -> (Vec<Mover>, Vec<Obstacle>) {
    let appear = |(shape, begin): (Shape, &Begin)| {
        let Begin { position, yaw, .. } = *begin;
        let mover = Mover { position, velocity: Vector2::zeros(), radius: shape.circumradius() };
        (mover, Obstacle { shape, x: position.x, y: position.y, yaw })
    };
    shapes.into_iter().zip(begins).map(appear).unzip()
}
