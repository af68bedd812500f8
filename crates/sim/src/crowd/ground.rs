//! What is in a mover's way.

use nalgebra::Vector2;

use super::Mover;
use crate::{Point, Room, Surface, World};

/// The least gap, metres, that a mover keeps from what it may not touch.
pub(super) const GAP: f64 = 1e-3;

/// The number of no mover.
const NOBODY: usize = usize::MAX;

/// Where a mover touches what is in its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    /// How far it gets, metres.
    pub(super) distance: f64,
    /// The unit vector from what is in the way towards the mover.
    pub(super) normal: Vector2<f64>,
}

/// One thing that may be in the way.
#[derive(Debug, Clone, Copy)]
pub(super) enum Thing<'a> {
    /// A wall by its number.
    Wall(usize),
    /// An obstacle that stands still, by its index.
    Solid(usize),
    /// Another mover, as the disc around it.
    Mover(&'a Mover),
    /// The vehicle, as the disc around it.
    Vehicle(&'a Mover),
}

/// A world as one of its movers meets it: movers are discs to each other.
pub(super) struct Ground<'a> {
    world: &'a World,
    movers: &'a [Mover],
    vehicle: Option<&'a Mover>,
    largest_radius: f64,
}

impl<'a> Ground<'a> {
    pub(super) fn new(world: &'a World, movers: &'a [Mover], vehicle: Option<&'a Mover>) -> Self {
        let largest_radius = movers.iter().map(|mover| mover.radius).fold(0.0, f64::max);
        Self { world, movers, vehicle, largest_radius }
    }

    /// What stands still.
    pub(super) fn without_movers(&self) -> Self {
        Self::new(self.world, &[], None)
    }

    pub(super) fn room(&self) -> Room {
        self.world.room()
    }

    /// Whether a point has `least` metres of room around it.
    pub(super) fn has_room_around(&self, point: &Point, least: f64) -> bool {
        let walls = (0..4).map(Thing::Wall);
        walls.chain(self.near(NOBODY, point, least)).all(|thing| self.away_from(&thing, point).0 >= least)
    }

    /// Whether a disc that stands free at `from` can be moved straight on to `to`.
    pub(super) fn is_free(&self, from: &Point, to: &Point, radius: f64) -> bool {
        self.first_contact(NOBODY, radius, from, to).is_none()
    }

    /// The obstacles and movers, but for the mover number `own`, and the vehicle, that may come within `reach` of a point,
    /// in an order that depends on nothing else.
    pub(super) fn near(&self, own: usize, point: &Point, reach: f64) -> impl Iterator<Item = Thing<'a>> {
        // The circle around a polygon's corners and that around its origin lie apart by two radii at most.
        let mut indices: Vec<usize> = self.world.obstacles_near(point, reach + 2.0 * self.largest_radius).collect();
        indices.sort_unstable();
        let (movers, first) = (self.movers, self.world.static_obstacles().len());
        let thing = move |index: usize| match index.checked_sub(first) {
            None => Some(Thing::Solid(index)),
            Some(number) if number == own => None,
            Some(number) => movers.get(number).map(Thing::Mover),
        };
        indices.into_iter().filter_map(thing).chain(self.vehicle.map(Thing::Vehicle))
    }

    /// The distance from a point to a thing, metres, and the unit vector from there to the point.
    pub(super) fn away_from(&self, thing: &Thing<'_>, point: &Point) -> (f64, Vector2<f64>) {
        const INWARD: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        match thing {
            Thing::Wall(number) => (self.world.room().to_walls(point)[*number], INWARD[*number].into()),
            Thing::Solid(index) => {
                let (_, normal) = length_and_unit(&(point - self.world.solids()[*index].nearest(point)));
                (self.world.distance_to(Surface::Obstacle(*index), point), normal)
            }
            Thing::Mover(disc) | Thing::Vehicle(disc) => {
                let (distance, normal) = length_and_unit(&(point - disc.position));
                (distance - disc.radius, normal)
            }
        }
    }

    /// Where the disc number `own` of a radius, moved along a straight line, first comes within [`GAP`] of anything; nothing
    /// stops it from moving away from what is nearer already.
    pub(super) fn first_contact(&self, own: usize, radius: f64, from: &Point, to: &Point) -> Option<Contact> {
        let (length, along) = length_and_unit(&(to - from));
        if length == 0.0 {
            return None;
        }
        let middle = nalgebra::center(from, to);
        let things = (0..4).map(Thing::Wall).chain(self.near(own, &middle, length / 2.0 + radius + 2.0 * GAP));
        let contacts = things.filter_map(|thing| self.contact(&thing, from, &along, radius));
        let first = contacts.min_by(|a, b| a.distance.total_cmp(&b.distance));
        first.filter(|contact| contact.distance < length)
    }

    /// How far a mover gets at a velocity.
    pub(super) fn end_of_way(&self, own: usize, mover: &Mover, velocity: &Vector2<f64>, dt: f64) -> Point {
        let end = mover.position + velocity * dt;
        match self.first_contact(own, mover.radius, &mover.position, &end) {
            None => end,
            Some(contact) => mover.position + velocity.normalize() * contact.distance,
        }
    }

    /// The contact with one thing on a ray.
    ///
    /// The distance to a convex thing is convex along a line: it never falls below its tangents, so Newton's steps come
    /// near the contact from before it, and ever faster.
    fn contact(&self, thing: &Thing<'_>, from: &Point, along: &Vector2<f64>, radius: f64) -> Option<Contact> {
        const STEPS: usize = 50;
        const ENOUGH: f64 = 1e-9;
        let mut distance = 0.0;
        let mut normal = Vector2::zeros();
        for _ in 0..STEPS {
            let (room, away) = self.away_from(thing, &(from + along * distance));
            let (room, rate) = (room - radius - GAP, along.dot(&away));
            if rate >= 0.0 {
                return None;
            }
            normal = away;
            if room <= ENOUGH {
                break;
            }
            distance -= room / rate;
        }
        Some(Contact { distance, normal })
    }
}

/// The length of a vector, and the vector of length 1 along it, or along x if it has none.
fn length_and_unit(vector: &Vector2<f64>) -> (f64, Vector2<f64>) {
    let length = vector.norm();
    if length > 0.0 { (length, vector / length) } else { (0.0, Vector2::x()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Obstacle, Room, Shape};

    #[test]
    fn contacts_by_hand() {
        let shape = Shape::Box { length: 2.0, width: 2.0 };
        let world = World::new(Room::new(10.0, 10.0), vec![Obstacle { shape, x: 6.0, y: 5.0, yaw: 0.0 }]).unwrap();
        let vehicle = Mover { position: Point::new(2.0, 8.0), velocity: Vector2::zeros(), radius: 0.5 };
        let ground = Ground::new(&world, &[], Some(&vehicle));
        let contact = |a: [f64; 2], b: [f64; 2]| ground.first_contact(0, 0.25, &a.into(), &b.into());
        let distance = |a, b| contact(a, b).unwrap().distance;
        assert!((distance([2.0, 5.0], [9.0, 5.0]) - (2.75 - GAP)).abs() < 1e-8); // the box
        assert!((distance([2.0, 5.0], [2.0, 9.0]) - (2.25 - GAP)).abs() < 1e-8); // the vehicle
        assert!((distance([2.0, 2.0], [2.0, -3.0]) - (1.75 - GAP)).abs() < 1e-8); // the wall below
        assert_eq!(contact([2.0, 2.0], [2.0, -3.0]).unwrap().normal, Vector2::y());
        assert_eq!(contact([2.0, 2.0], [2.0, 1.0]), None);
        assert_eq!(contact([3.0, 3.7], [9.0, 3.7]), None); // past the box, with 5 cm to spare
        assert_eq!(contact([4.7499, 5.0], [3.0, 5.0]), None); // away from what is too near
        assert_eq!(distance([4.7499, 5.0], [6.0, 5.0]), 0.0);
    }
}
