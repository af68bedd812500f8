//! Time of a vehicle's control period, of collision tests and distances against parry's, of distances as obstacles grow in
//! number, of making a scenario, and of a crowd's step.
//!
//! All questions are asked at 64 places among 12 discs and 12 boxes. `collision/24` asks whether a round vehicle touches
//! anything, `collision_of_box/24` the same of a box; the rival `parry_bvh` asks parry2d's bounding-volume hierarchy (f64)
//! for the boxes that the vehicle's box meets, and parry's intersection test for the shapes in them. `clearance/24` asks
//! for the distance to whatever is nearest, as a vehicle's step and rewards need it, and parry for its best leaf by distance.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use headway_sim::rand::RngExt;
use headway_sim::{
    BarnSpec, Command, CrowdMotion, CrowdSpec, Footprint, Interval, Kinds, Obstacle, Pose, Quantity, RoomSpec,
    Scenario, Shape, VehicleSpec, VehicleState, World, WorldSpec, stream,
};
use parry2d::bounding_volume::{Aabb, BoundingVolume};
use parry2d::math::{Pose as ParryPose, Vector};
use parry2d::partitioning::{Bvh, BvhBuildStrategy};
use parry2d::query::{distance, intersection_test};
use parry2d::shape::{Ball, SharedShape};

fn footprint() -> Footprint {
    VehicleSpec::default().build().expect("the default is valid").footprint().clone()
}

/// A room of obstacles as dense as the default's small room: 0.08 a square metre.
fn scenario(n_obstacles: usize, kinds: Kinds) -> Scenario {
    let side = (n_obstacles as f64 / 0.08).sqrt().max(5.0);
    let [width, height] = [side; 2].map(Interval::Fixed);
    let room = RoomSpec { width, height, obstacles: Quantity::Count(n_obstacles), kinds, ..RoomSpec::default() };
    let source = WorldSpec::Room(room).build(&footprint()).expect("there is room");
    source.scenario(0, 0).expect("there is room")
}

/// Poses all over a room.
fn places(world: &World) -> Vec<Pose> {
    let (room, mut rng) = (world.room(), stream(0, "places", 0));
    let mut along = |extent: f64| rng.random_range(0.5..extent - 0.5);
    (0..64).map(|_| Pose::new([along(room.width), along(room.height)].into(), 0.3)).collect()
}

fn step(c: &mut Criterion) {
    let vehicle = VehicleSpec::default().build().expect("the default is valid");
    let source = WorldSpec::default().build(vehicle.footprint()).expect("the default is valid");
    let scenario = source.scenario(0, 0).expect("the default has room");
    c.bench_function("vehicle_step", |b| {
        let mut state = VehicleState::at_rest(scenario.start);
        let mut speed = 0.5;
        b.iter(|| {
            speed = 1.5 - speed; // never at rest, and always in change
            let motion = vehicle.step(&scenario.world, &mut state, black_box(Command::new(speed, 0.5)));
            if motion.collided {
                state = VehicleState::at_rest(scenario.start);
            }
            motion.distance
        });
    });
    let barn = WorldSpec::Barn(BarnSpec::default());
    for (name, spec) in [("10x15", WorldSpec::Room10x15 {}), ("25x25", WorldSpec::Room25x25 {}), ("barn", barn)] {
        let source = spec.build(vehicle.footprint()).expect("the default is valid");
        let mut index = 0;
        c.bench_function(&format!("scenario/{name}"), |b| {
            b.iter(|| {
                index += 1;
                source.scenario(1, index).expect("the default has room")
            });
        });
    }
}

/// The obstacles in parry.
struct Rival {
    bvh: Bvh,
    shapes: Vec<(ParryPose, SharedShape)>,
}

impl Rival {
    fn new(obstacles: &[Obstacle]) -> Self {
        let shape = |obstacle: &Obstacle| match obstacle.shape {
            Shape::Disc { radius } => SharedShape::ball(radius),
            Shape::Box { length, width } => SharedShape::cuboid(length / 2.0, width / 2.0),
            Shape::Polygon { .. } => unreachable!("discs and boxes only"),
        };
        let pose = |o: &Obstacle| ParryPose::new(Vector::new(o.x, o.y), o.yaw);
        let shapes: Vec<_> = obstacles.iter().map(|obstacle| (pose(obstacle), shape(obstacle))).collect();
        let boxes: Vec<_> = shapes.iter().map(|(pose, shape)| shape.compute_aabb(pose)).collect();
        Self { bvh: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes), shapes }
    }

    fn collides(&self, room: [f64; 2], shape: &dyn parry2d::shape::Shape, pose: &ParryPose) -> bool {
        let bounds = shape.compute_aabb(pose);
        let in_room = bounds.mins.x > 0.0 && bounds.mins.y > 0.0 && bounds.maxs.x < room[0] && bounds.maxs.y < room[1];
        let touches = |leaf: u32| {
            let (other_pose, other) = &self.shapes[leaf as usize];
            intersection_test(pose, shape, other_pose, &**other).expect("parry knows these shapes").intersecting
        };
        !in_room || self.bvh.leaves(|node| node.aabb().intersects(&bounds)).any(touches)
    }

    fn clearance(&self, room: [f64; 2], shape: &dyn parry2d::shape::Shape, pose: &ParryPose) -> f64 {
        let bounds = shape.compute_aabb(pose);
        let to_walls = bounds.mins.min(Vector::new(room[0], room[1]) - bounds.maxs).min_element();
        let to_box = |other: &Aabb| (bounds.mins - other.maxs).max(other.mins - bounds.maxs).max(Vector::ZERO).length();
        let to_shape = |leaf: u32| {
            let (other_pose, other) = &self.shapes[leaf as usize];
            distance(pose, shape, other_pose, &**other).expect("parry knows these shapes").distance
        };
        let nearest = self.bvh.find_best(f64::MAX, |node, _| to_box(&node.aabb()), |leaf, _| Some(to_shape(leaf)));
        nearest.map_or(to_walls, |(_, distance)| distance.min(to_walls))
    }
}

/// A vehicle's name in ids, its outline, and the same in parry.
fn vehicles() -> [(&'static str, Footprint, SharedShape); 2] {
    let jackal = Footprint::new(&Shape::Box { length: 0.46, width: 0.42 }).expect("it is valid");
    [("", footprint(), SharedShape::new(Ball::new(0.25))), ("_of_box", jackal, SharedShape::cuboid(0.23, 0.21))]
}

fn collision(c: &mut Criterion) {
    let world = scenario(24, Kinds { disc: 1.0, r#box: 1.0, polygon: 0.0 }).world;
    let rival = Rival::new(world.obstacles());
    let (places, room) = (places(&world), [world.room().width, world.room().height]);
    let to_parry = |p: &Pose| ParryPose::new(Vector::new(p.translation.x, p.translation.y), p.rotation.angle());
    let their_places: Vec<_> = places.iter().map(to_parry).collect();
    for (suffix, footprint, shape) in vehicles() {
        let ours = || places.iter().filter(|pose| world.collides(&footprint, pose)).count();
        let theirs = || their_places.iter().filter(|pose| rival.collides(room, &*shape, pose)).count();
        assert!(ours() > 0 && ours() == theirs(), "both say the same");
        let mut group = c.benchmark_group(format!("collision{suffix}/24"));
        group.throughput(Throughput::Elements(places.len() as u64));
        group.bench_function("headway", |b| b.iter(ours));
        group.bench_function("parry_bvh", |b| b.iter(theirs));
        group.finish();
    }
    for (suffix, footprint, shape) in vehicles() {
        let ours = || places.iter().map(|pose| world.clearance(&footprint, pose).max(0.0)).sum::<f64>();
        let theirs = || their_places.iter().map(|pose| rival.clearance(room, &*shape, pose).max(0.0)).sum::<f64>();
        assert!((ours() - theirs()).abs() < 1e-6, "both say the same");
        let mut group = c.benchmark_group(format!("clearance{suffix}/24"));
        group.throughput(Throughput::Elements(places.len() as u64));
        group.bench_function("headway", |b| b.iter(ours));
        group.bench_function("parry_bvh", |b| b.iter(theirs));
        group.finish();
    }
}

fn obstacles(c: &mut Criterion) {
    let mut group = c.benchmark_group("clearance/obstacles");
    for n in [10, 30, 100, 300, 1000] {
        let world = scenario(n, Kinds::default()).world;
        let (places, footprint) = (places(&world), footprint());
        group.throughput(Throughput::Elements(places.len() as u64));
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter(|| places.iter().map(|pose| world.clearance(&footprint, black_box(pose))).sum::<f64>());
        });
    }
    group.finish();
}

/// Ten movers among 12 discs, by every rule.
fn crowds(c: &mut Criterion) {
    let mut group = c.benchmark_group("crowd_step");
    for (name, motion) in [
        ("waypoints", CrowdMotion::default()),
        ("random_walk", CrowdMotion::RandomWalk { turning: 0.3 }),
        ("reciprocal", CrowdMotion::Reciprocal { horizon: 2.0, obstacle_horizon: 0.5 }),
    ] {
        let mut world = scenario(12, Kinds::default()).world;
        let spec = CrowdSpec { n_movers: Interval::Fixed(10.0), motion, ..CrowdSpec::default() };
        let mut crowd = spec.build(&mut world, &[], &mut stream(0, "crowd", 0)).expect("there is room");
        group.bench_function(name, |b| b.iter(|| crowd.step(&mut world, black_box(0.2), None)));
    }
    group.finish();
}

criterion_group!(benches, step, collision, obstacles, crowds);
criterion_main!(benches);
