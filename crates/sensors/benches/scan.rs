//! Time of one scan in a furnished room of 53 segments (4 walls, 49 edges) and 10 discs, against the same rays cast one by
//! one at the same shapes in parry2d's bounding-volume hierarchy (f32). `scan/36/default` is the scan of the default spec.

use std::f64::consts::{PI, TAU};
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use headway_sensors::{Lidar, LidarSpec};
use headway_sim::{
    Interval, Obstacle, Outline, Point, Pose, Quantity, Room, RoomSpec, Scenario, Shape, Surface, VehicleSpec, World,
    WorldSpec, stream,
};
use parry2d::math::Vector;
use parry2d::partitioning::{Bvh, BvhBuildStrategy};
use parry2d::query::{Ray, RayCast};
use parry2d::shape::{Ball, Segment};

/// 10 discs, 9 boxes, a triangle and two pentagons on a 5 x 5 lattice, the sensor in the free cell.
fn room() -> (World, Pose) {
    let regular = |n: usize, radius: f64| {
        let corner = |k: usize| (k as f64 / n as f64 * TAU).sin_cos();
        Shape::Polygon { vertices: (0..n).map(corner).map(|(y, x)| [radius * x, radius * y]).collect() }
    };
    let mut shapes: Vec<Shape> = (0..10).map(|k| Shape::Disc { radius: 0.2 + 0.03 * f64::from(k) }).collect();
    shapes.extend((0..9).map(|k| Shape::Box { length: 0.5 + 0.05 * f64::from(k), width: 0.4 }));
    shapes.extend([regular(3, 0.5), regular(5, 0.4), regular(5, 0.5)]);
    let cells = (0..25).map(|k| k * 7 % 25).filter(|cell| *cell != 12);
    let obstacles = shapes.into_iter().zip(cells).map(|(shape, cell)| {
        let (column, row) = (f64::from(cell % 5), f64::from(cell / 5));
        Obstacle { shape, x: 2.0 * column + 1.0, y: 2.0 * row + 1.0, yaw: f64::from(cell) }
    });
    let world = World::new(Room::new(10.0, 10.0), obstacles.collect()).expect("all fits");
    (world, Pose::new([5.1, 4.9].into(), 0.3))
}

/// The same surfaces in parry.
struct Rival {
    bvh: Bvh,
    segments: Vec<Segment>,
    discs: Vec<(Vector, Ball)>,
}

impl Rival {
    fn new(world: &World) -> Self {
        let vector = |p: &Point| Vector::new(p.x as f32, p.y as f32);
        let (mut segments, mut discs) = (Vec::new(), Vec::new());
        let obstacles = (0..world.obstacles().len()).map(Surface::Obstacle);
        for surface in (0..4).map(Surface::Wall).chain(obstacles) {
            match world.outline(surface) {
                Outline::Disc { center, radius } => discs.push((vector(&center), Ball::new(radius as f32))),
                Outline::Wall([a, b]) => segments.push(Segment::new(vector(&a), vector(&b))),
                Outline::Polygon(corners) => {
                    let next = corners.iter().cycle().skip(1);
                    segments.extend(corners.iter().zip(next).map(|(a, b)| Segment::new(vector(a), vector(b))));
                }
            }
        }
        assert_eq!((segments.len(), discs.len()), (53, 10));
        let boxes = segments.iter().map(Segment::local_aabb);
        let boxes: Vec<_> =
            boxes.chain(discs.iter().map(|(center, ball)| ball.local_aabb().translated(*center))).collect();
        Self { bvh: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes), segments, discs }
    }

    fn scan(&self, lidar: &Lidar, pose: &Pose, ranges: &mut [f32]) {
        let max_range = lidar.spec().max_range as f32;
        let origin = Vector::new(pose.translation.x as f32, pose.translation.y as f32);
        for (range, angle) in ranges.iter_mut().zip(lidar.beam_angles()) {
            let (sin, cos) = ((pose.rotation.angle() + angle) as f32).sin_cos();
            let ray = Ray::new(origin, Vector::new(cos, sin));
            let hit = self.bvh.cast_ray(&ray, max_range, |leaf, best| self.cast(leaf as usize, &ray, best));
            *range = hit.map_or(max_range, |(_, range)| range);
        }
    }

    fn cast(&self, leaf: usize, ray: &Ray, best: f32) -> Option<f32> {
        match self.segments.get(leaf) {
            Some(segment) => segment.cast_local_ray(ray, best, true),
            None => {
                let (center, ball) = &self.discs[leaf - self.segments.len()];
                ball.cast_local_ray(&Ray::new(ray.origin - *center, ray.dir), best, true)
            }
        }
    }
}

fn scan(c: &mut Criterion) {
    let (world, pose) = room();
    let rival = Rival::new(&world);
    let mut group = c.benchmark_group("scan");
    for (n_beams, field_of_view) in [(360, TAU), (1080, 1.5 * PI)] {
        let spec = LidarSpec { n_beams, field_of_view, max_range: 30.0, ..LidarSpec::default() };
        let lidar = spec.build().expect("valid");
        let (mut ours, mut theirs) = (vec![0.0; n_beams], vec![0.0; n_beams]);
        let mut rng = stream(0, "noise", 0);
        lidar.scan(&world, &pose, &mut rng, &mut ours);
        rival.scan(&lidar, &pose, &mut theirs);
        let n_off = ours.iter().zip(&theirs).filter(|(a, b)| (*a - *b).abs() > 1e-3).count();
        assert!(n_off <= 2, "{n_off} ranges differ by more than a millimetre");
        group.throughput(Throughput::Elements(n_beams as u64));
        group.bench_function(format!("{n_beams}/headway"), |b| {
            b.iter(|| lidar.scan(black_box(&world), black_box(&pose), &mut rng, &mut ours));
        });
        group.bench_function(format!("{n_beams}/parry_bvh"), |b| {
            b.iter(|| rival.scan(&lidar, black_box(&pose), &mut theirs));
        });
    }
    let scenario = scenario(RoomSpec::room_10x15());
    let lidar = LidarSpec::default().build().expect("valid");
    let (mut ranges, mut rng) = ([0.0; 36], stream(0, "noise", 0));
    group.throughput(Throughput::Elements(36));
    group.bench_function("36/default", |b| {
        b.iter(|| lidar.scan(black_box(&scenario.world), &scenario.start, &mut rng, &mut ranges));
    });
    group.finish();
}

fn scenario(room: RoomSpec) -> Scenario {
    let vehicle = VehicleSpec::default().build().expect("valid");
    let source = WorldSpec::Room(room).build(vehicle.footprint()).expect("valid");
    source.scenario(0, 0).expect("there is room")
}

/// Cost as beams grow in number, in the room of `scan/*`, and as obstacles do, with a range of 5 m and as dense as in the
/// default's small room.
fn scaling(c: &mut Criterion) {
    let mut scan = |name: String, spec: LidarSpec, world: &World, pose: &Pose| {
        let lidar = spec.build().expect("valid");
        let (mut ranges, mut rng) = (vec![0.0; spec.n_beams], stream(0, "noise", 0));
        c.bench_function(&name, |b| b.iter(|| lidar.scan(black_box(world), black_box(pose), &mut rng, &mut ranges)));
    };
    let (world, pose) = room();
    for n_beams in [36, 72, 180, 360, 720, 1080] {
        let spec = LidarSpec { n_beams, max_range: 30.0, ..LidarSpec::default() };
        scan(format!("scan_scaling/beams/{n_beams}"), spec, &world, &pose);
    }
    for n_obstacles in [10, 30, 100, 300, 1000] {
        let side = Interval::Fixed((n_obstacles as f64 / 0.08).sqrt());
        let obstacles = Quantity::Count(n_obstacles);
        let Scenario { world, start, .. } =
            scenario(RoomSpec { width: side, height: side, obstacles, ..RoomSpec::default() });
        let spec = LidarSpec { n_beams: 360, ..LidarSpec::default() };
        scan(format!("scan_scaling/obstacles/{n_obstacles}"), spec, &world, &start);
    }
}

criterion_group!(benches, scan, scaling);
criterion_main!(benches);
