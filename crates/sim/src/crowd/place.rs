//! Where a crowd is at first.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::gait::Walk;
use super::ground::Ground;
use super::{Crowd, CrowdSpec, Mover};
use crate::scenario::draw_shape;
use crate::{Interval, Obstacle, Point, Shape, SimError, World};

/// How often a mover is tried.
const TRIES: usize = 500;

impl CrowdSpec {
    /// Places a crowd at random in a world, whose movers it becomes; the world must have none.
    ///
    /// Nobody comes nearer than `min_gap` to the discs `keep_free`, each a centre and a radius in metres. All that is random,
    /// now and in steps, comes from `rng`, of which the crowd keeps a copy.
    ///
    /// # Errors
    /// Names a field that is not allowed, or the mover that found no place; the world is then as before.
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
        let (movers, obstacles) = self.draw_places(world, keep_free, shapes, rng)?;
        let mut crowd = Crowd {
            motion: self.motion.clone(),
            regards_vehicle: self.regards_vehicle(),
            walks: self.draw_walks(world, &movers, rng),
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

    /// The movers, at rest, and the obstacles that they are.
    fn draw_places(
        &self,
        world: &World,
        keep_free: &[(Point, f64)],
        shapes: Vec<Shape>,
        rng: &mut ChaCha8Rng,
    ) -> Result<(Vec<Mover>, Vec<Obstacle>), SimError> {
        let (room, n) = (world.room(), shapes.len());
        let (mut movers, mut obstacles): (Vec<Mover>, Vec<Obstacle>) = Default::default();
        for shape in shapes {
            let radius = shape.circumradius();
            let apart = |point: &Point, (center, other): (Point, f64)| {
                nalgebra::distance(point, &center) >= radius + other + self.min_gap
            };
            let is_free = |point: &Point| {
                let mut discs = movers.iter().map(|m| (m.position, m.radius)).chain(keep_free.iter().copied());
                discs.all(|disc| apart(point, disc)) && world.has_room_around(point, radius + self.min_gap)
            };
            let Some(position) = (0..TRIES).map(|_| room.sample(rng)).find(is_free) else {
                return Err(SimError::CannotPlace {
                    what: format!("mover {} of {n} (radius {radius:.2} m)", movers.len() + 1),
                    width: room.width,
                    height: room.height,
                    min_gap: self.min_gap,
                    tries: TRIES,
                });
            };
            movers.push(Mover { position, velocity: nalgebra::Vector2::zeros(), radius });
            let yaw = rng.random_range(-std::f64::consts::PI..std::f64::consts::PI);
            obstacles.push(Obstacle { shape, x: position.x, y: position.y, yaw });
        }
        Ok((movers, obstacles))
    }

    fn draw_walks(&self, world: &World, movers: &[Mover], rng: &mut ChaCha8Rng) -> Vec<Walk> {
        let ground = Ground::new(world, &[], None);
        let mut walk = |mover| {
            let speed = self.speed.sample(rng);
            Walk::new(&self.motion, speed, mover, &ground, rng)
        };
        movers.iter().map(&mut walk).collect()
    }
}
