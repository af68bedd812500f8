//! Crowds by hand.

use super::gait::Errand;
use super::*;
use crate::{Obstacle, Pose, Room, Shape, stream};

const ROOM: Room = Room::new(20.0, 20.0);

/// Discs of 0.3 m that go from place to place at 1 m/s and evade each other.
fn errands(ways: &[[[f64; 2]; 2]]) -> (World, Crowd) {
    let radius = 0.3;
    let mover = |[from, to]: &[[f64; 2]; 2]| {
        let (position, goal) = (Point::from(*from), Point::from(*to));
        Mover { position, velocity: (goal - position).normalize(), radius }
    };
    let obstacle = |[[x, y], _]: &[[f64; 2]; 2]| Obstacle { shape: Shape::Disc { radius }, x: *x, y: *y, yaw: 0.0 };
    let walk = |[_, to]: &[[f64; 2]; 2]| Walk { speed: 1.0, gait: Gait::Errand(Errand::to((*to).into(), 1e9)) };
    let mut world = World::new(ROOM, vec![]).unwrap();
    world.add_movers(ways.iter().map(obstacle).collect()).unwrap();
    let crowd = Crowd {
        motion: CrowdMotion::Reciprocal { horizon: 3.0, obstacle_horizon: 0.5 },
        regards_vehicle: true,
        movers: ways.iter().map(mover).collect(),
        walks: ways.iter().map(walk).collect(),
        rng: stream(0, "crowd", 0),
    };
    (world, crowd)
}

/// The least gap between any two while they go for `n` steps of 0.1 s.
fn least_gap(world: &mut World, crowd: &mut Crowd, n: usize, vehicle: Option<&Mover>) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..n {
        crowd.step(world, 0.1, vehicle);
        let all: Vec<_> = crowd.movers.iter().chain(vehicle).collect();
        for (i, a) in all.iter().enumerate() {
            for b in &all[..i] {
                least = least.min((a.position - b.position).norm() - a.radius - b.radius);
            }
        }
    }
    least
}

#[test]
fn what_is_free_to_go_goes_straight_at_its_speed() {
    let (mut world, mut crowd) = errands(&[[[4.0, 10.0], [16.0, 10.0]], [[4.0, 3.0], [16.0, 3.0]]]);
    for step in 1..=100 {
        crowd.step(&mut world, 0.1, None);
        assert_eq!(crowd.movers[0].position.y, 10.0);
        assert!((crowd.movers[1].position.x - 4.0 - 0.1 * f64::from(step)).abs() < 1e-9);
    }
}

#[test]
fn two_head_on_pass_each_other_alike() {
    let (mut world, mut crowd) = errands(&[[[4.0, 10.0], [16.0, 10.0]], [[16.0, 10.0], [4.0, 10.0]]]);
    for _ in 0..110 {
        assert!(least_gap(&mut world, &mut crowd, 1, None) > 0.01);
        let [a, b] = [0, 1].map(|i| crowd.movers[i].position);
        assert!(((a.coords + b.coords) / 2.0 - Vector2::new(10.0, 10.0)).norm() < 0.1, "by half a turn the same");
    }
    assert!(crowd.movers[0].position.x > 14.0 && crowd.movers[1].position.x < 6.0);
}

#[test]
fn four_that_cross_get_across() {
    let ways = [[4.0, 10.0], [10.0, 4.0], [16.0, 10.0], [10.0, 16.0]].map(|[x, y]| [[x, y], [20.0 - x, 20.0 - y]]);
    let (mut world, mut crowd) = errands(&ways);
    let mut arrived = [false; 4];
    let mut least = f64::INFINITY;
    for _ in 0..300 {
        least = least.min(least_gap(&mut world, &mut crowd, 1, None));
        for ((arrived, mover), [_, to]) in arrived.iter_mut().zip(&crowd.movers).zip(&ways) {
            *arrived |= (mover.position - Point::from(*to)).norm() < 0.4;
        }
    }
    assert_eq!(arrived, [true; 4]);
    assert!(least > 0.0, "{least}");
}

#[test]
fn a_vehicle_is_evaded_whether_it_stands_or_comes() {
    for velocity in [[0.0, 0.0], [-1.0, 0.0]] {
        let (mut world, mut crowd) = errands(&[[[4.0, 10.0], [16.0, 10.0]]]);
        let mut vehicle = Mover { position: Point::new(10.0, 10.0), velocity: velocity.into(), radius: 0.4 };
        for _ in 0..130 {
            assert!(least_gap(&mut world, &mut crowd, 1, Some(&vehicle)) > 0.0);
            vehicle.position += vehicle.velocity * 0.04;
        }
        assert!(crowd.movers[0].position.x > 14.0);
    }
}

#[test]
fn a_post_is_passed_and_a_wall_is_not_run_into() {
    let (world, mut crowd) = errands(&[[[4.0, 10.0], [16.0, 10.3]], [[4.0, 2.0], [-5.0, 2.0]]]);
    let post = Obstacle { shape: Shape::Disc { radius: 0.5 }, x: 10.0, y: 10.0, yaw: 0.0 };
    let movers = world.movers().to_vec();
    let mut world = World::new(ROOM, vec![post]).unwrap();
    world.add_movers(movers).unwrap();
    let mut farthest = 0.0_f64;
    for _ in 0..200 {
        crowd.step(&mut world, 0.1, None);
        farthest = farthest.max(crowd.movers[0].position.x);
        assert!((crowd.movers[0].position - Point::new(10.0, 10.0)).norm() > 0.8);
        assert!(crowd.movers[1].position.x > 0.3);
    }
    assert!(farthest > 15.0 && crowd.movers[1].position.x < 0.4);
}

#[test]
fn a_yaw_stays_the_same_to_the_last_bit() {
    let (_, mut crowd) = errands(&[[[4.0, 10.0], [16.0, 10.0]]]);
    let shape = Shape::Box { length: 0.4, width: 0.2 };
    let mut world = World::new(ROOM, vec![]).unwrap();
    world.add_movers(vec![Obstacle { shape, x: 4.0, y: 10.0, yaw: 0.3 }]).unwrap();
    crowd.step(&mut world, 0.1, None);
    assert_eq!(world.movers()[0].yaw, 0.3);
    world.set_pose(0, &Pose::new([5.0, 5.0].into(), 1.0)).unwrap();
    assert!((world.movers()[0].yaw - 1.0).abs() < 1e-12);
}
