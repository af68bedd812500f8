//! Time to map a room and to plan a way through it, from the world itself and from scans, and to choose a command.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use headway_planning::{
    Controller, CostmapSpec, DwaSpec, GridMap, Planned, PurePursuit, RegulatedPursuitSpec, ScanMapSpec,
    ScanPlannerSpec, Sensed, ShieldSpec, VfhSpec, plan,
};
use headway_sim::{Command, Obstacle, Point, Pose, Room, Shape, Twist, VehicleSpec, World, WorldSpec, stream};

fn routes(c: &mut Criterion) {
    let vehicle = VehicleSpec::default().build().expect("valid");
    for (name, spec) in [("10x15", WorldSpec::Room10x15 {}), ("25x25", WorldSpec::Room25x25 {})] {
        let source = spec.build(vehicle.footprint()).expect("valid");
        let scenarios: Vec<_> = (0..16).map(|index| source.scenario(0, index).expect("there is room")).collect();
        let map = |index: usize| GridMap::from_world(&scenarios[index].world, 0.1, 0.25);
        let maps: Vec<_> = (0..16).map(map).collect();
        let mut index = 0;
        c.bench_function(&format!("grid_map/{name}"), |b| {
            b.iter(|| {
                index = (index + 1) % 16;
                map(black_box(index))
            });
        });
        c.bench_function(&format!("plan/{name}"), |b| {
            b.iter(|| {
                index = (index + 1) % 16;
                let start: Point = scenarios[index].start.translation.vector.into();
                plan(&maps[index], &start, &scenarios[index].goal)
            });
        });
    }
}

/// One command of each driver, at 1 m/s in a full room with 720 beams all round.
fn drivers(c: &mut Criterion) {
    let vehicle = VehicleSpec::default().build().expect("valid");
    let source = WorldSpec::Room10x15 {}.build(vehicle.footprint()).expect("valid");
    let beam_angles: Vec<f64> = (0..720).map(|k| f64::from(k) / 720.0 * std::f64::consts::TAU).collect();
    let looks: Vec<_> = (0..16)
        .map(|index| {
            let scenario = source.scenario(0, index).expect("there is room");
            let origin = Point::from(scenario.start.translation.vector);
            let beam = |angle: &f64| {
                let direction = scenario.start.rotation * Point::new(angle.cos(), angle.sin()).coords;
                scenario.world.cast_ray(&origin, &direction, 10.0) as f32
            };
            (scenario.start, scenario.goal, beam_angles.iter().map(beam).collect::<Vec<_>>())
        })
        .collect();
    let pursuit = RegulatedPursuitSpec::default().build().expect("valid");
    let vfh = VfhSpec::default().build().expect("valid");
    let drivers: [(&str, Box<dyn Controller>); 4] = [
        ("pure_pursuit", Box::new(PurePursuit::default())),
        ("regulated_pursuit", Box::new(pursuit)),
        ("vfh", Box::new(vfh)),
        ("shield", Box::new(ShieldSpec::default().build(PurePursuit::default()).expect("valid"))),
    ];
    for (name, mut driver) in drivers {
        let mut index = 0;
        c.bench_function(&format!("command/{name}/720"), |b| {
            b.iter(|| {
                index = (index + 1) % 16;
                let (pose, goal, scan) = &looks[index];
                driver.command(black_box(&Sensed {
                    vehicle: vehicle.spec(),
                    scan,
                    beam_angles: &beam_angles,
                    max_range: 10.0,
                    pose: *pose,
                    twist: Twist::new(1.0, 0.0, 0.0),
                    goal: *goal,
                    route: None,
                    last_command: Command::default(),
                    movers: &[],
                }))
            });
        });
    }
}

/// 720 beams over 270 degrees, and what they measure on a straight drive among thin posts.
struct Drive {
    vehicle: VehicleSpec,
    angles: Vec<f64>,
    poses: Vec<Pose>,
    scans: Vec<Vec<f32>>,
    goal: Point,
}

impl Drive {
    fn new() -> Self {
        use headway_sim::rand::RngExt;
        let mut rng = stream(0, "posts", 0);
        let post = |_| {
            let (x, y): (f64, f64) = (rng.random_range(0.5..11.5), rng.random_range(0.5..9.5));
            let shape = Shape::Disc { radius: 0.075 };
            ((y - 5.0).abs() > 0.6).then_some(Obstacle { shape, x, y, yaw: 0.0 })
        };
        let posts = (0..150).filter_map(post).collect();
        let world = World::new(Room::new(12.0, 10.0), posts).expect("valid");
        let angles: Vec<_> = (0..720).map(|k| (f64::from(k) / 719.0 - 0.5) * 1.5 * std::f64::consts::PI).collect();
        let poses: Vec<_> = (0..100).map(|k| Pose::new([1.0 + 0.025 * f64::from(k), 5.0].into(), 0.1)).collect();
        let scan = |pose: &Pose| {
            let origin = pose.translation.vector.into();
            let cast = |angle: &f64| {
                let direction = pose.rotation * Point::new(angle.cos(), angle.sin()).coords;
                world.cast_ray(&origin, &direction, 30.0) as f32
            };
            angles.iter().map(cast).collect()
        };
        let scans = poses.iter().map(scan).collect();
        let footprint = Shape::Box { length: 0.42, width: 0.33 };
        let vehicle = VehicleSpec { footprint, control_period: 0.05, max_acceleration: 10.0, ..VehicleSpec::default() };
        Self { vehicle, angles, poses, scans, goal: Point::new(11.0, 5.0) }
    }

    fn sensed(&self, k: usize) -> Sensed<'_> {
        Sensed {
            vehicle: &self.vehicle,
            scan: &self.scans[k % 100],
            beam_angles: &self.angles,
            max_range: 30.0,
            pose: self.poses[k % 100],
            twist: Twist::new(0.5, 0.0, 0.0),
            goal: self.goal,
            route: None,
            last_command: Command::default(),
            movers: &[],
        }
    }
}

fn from_scans(c: &mut Criterion) {
    let drive = Drive::new();
    let mut k = 0;
    let mut next = || {
        k += 1;
        drive.sensed(k)
    };
    let mut map = ScanMapSpec::default().build().expect("valid");
    c.bench_function("scan_map/720", |b| b.iter(|| map.update(&next())));
    let mut costmap = CostmapSpec::default().build().expect("valid");
    c.bench_function("costmap/720", |b| b.iter(|| costmap.update(&next())));
    for (name, replan_period) in [("always", 0.0), ("each_second", 1.0)] {
        let spec = ScanPlannerSpec { replan_period, ..ScanPlannerSpec::default() };
        let mut driver = Planned::new(spec.build().expect("valid"), PurePursuit::default());
        c.bench_function(&format!("scan_planner/{name}"), |b| b.iter(|| driver.command(&next())));
    }
    let mut dwa = DwaSpec::default().build().expect("valid");
    c.bench_function("dwa/command", |b| b.iter(|| dwa.command(&next())));
}

criterion_group!(benches, routes, drivers, from_scans);
criterion_main!(benches);
