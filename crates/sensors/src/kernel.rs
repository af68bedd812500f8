//! The scan kernel: paints obstacles onto all beams at once. The one module of the crate with unsafe code.
//!
//! *Inverse ranges.* Along a straight edge, `1 / range` is linear in the beam's direction, and so needs no division; the
//! nearest of several things is the greatest of their inverses; and a room's walls, seen from within, need no test of where
//! they end. Each edge or disc is taken to the sensor's frame and touches only the blocks of beams that may see it.
//!
//! The arithmetic is the same on every machine: the loops are written for the compiler to vectorise, with no fused
//! multiply-add, so that scans are equal bit for bit whatever vector instructions there are.
#![allow(unsafe_code, reason = "functions for wider vectors may be called only where the processor has them")]

use headway_sim::{Outline, Point, Pose, Surface, World};
use nalgebra::Vector2;

use crate::beams::{Beams, LANES};

/// Inverse ranges in 1/m, in blocks as the beams: the greatest of 0 and those of all surfaces in sight.
///
/// The pose must lie in the room and outside of all obstacles.
pub(crate) fn paint(beams: &Beams, world: &World, pose: &Pose, max_range: f64, inverse: &mut [[f32; LANES]]) {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: the processor has AVX-512F.
            return unsafe { paint_avx512(beams, world, pose, max_range, inverse) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { paint_avx2(beams, world, pose, max_range, inverse) };
        }
    }
    paint_portable(beams, world, pose, max_range, inverse);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn paint_avx512(beams: &Beams, world: &World, pose: &Pose, max_range: f64, inverse: &mut [[f32; LANES]]) {
    paint_portable(beams, world, pose, max_range, inverse);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn paint_avx2(beams: &Beams, world: &World, pose: &Pose, max_range: f64, inverse: &mut [[f32; LANES]]) {
    paint_portable(beams, world, pose, max_range, inverse);
}

#[inline(always)]
fn paint_portable(beams: &Beams, world: &World, pose: &Pose, max_range: f64, inverse: &mut [[f32; LANES]]) {
    paint_walls(beams, world, pose, inverse);
    for index in world.obstacles_near(&Point::from(pose.translation.vector), max_range) {
        match world.outline(Surface::Obstacle(index)) {
            Outline::Disc { center, radius } => paint_disc(beams, &to_sensor(pose, &center), radius, inverse),
            Outline::Polygon(corners) => paint_polygon(beams, corners, pose, max_range, inverse),
            Outline::Wall(_) => {}
        }
    }
}

/// A point in the sensor's frame, metres.
#[inline(always)]
fn to_sensor(pose: &Pose, point: &Point) -> Vector2<f64> {
    pose.rotation.inverse() * (point.coords - pose.translation.vector)
}

/// The walls: `1 / range` to a wall at distance `h` is the cosine of the beam's angle to its normal, over `h`; of all four
/// walls, the greatest.
#[inline(always)]
fn paint_walls(beams: &Beams, world: &World, pose: &Pose, inverse: &mut [[f32; LANES]]) {
    let room = world.room();
    let [left, below, right, above] = room.to_walls(&Point::from(pose.translation.vector));
    let (sin, cos) = (pose.rotation.im, pose.rotation.re);
    // Normals towards the walls of least and greatest x and y in the sensor's frame, over the distances.
    let toward = |h: f64, normal: [f64; 2]| {
        let h = h.max(1e-6);
        [((cos * normal[0] + sin * normal[1]) / h) as f32, ((cos * normal[1] - sin * normal[0]) / h) as f32]
    };
    let [a, b] = [toward(left, [-1.0, 0.0]), toward(right, [1.0, 0.0])];
    let [c, d] = [toward(below, [0.0, -1.0]), toward(above, [0.0, 1.0])];
    for ((out, cos), sin) in inverse.iter_mut().zip(&beams.cos).zip(&beams.sin) {
        for lane in 0..LANES {
            let along = |n: [f32; 2]| n[0] * cos[lane] + n[1] * sin[lane];
            out[lane] = greater(greater(along(a), along(b)), greater(along(c), along(d)));
        }
    }
}

/// A disc: with its centre `b` along and `s` beside the beam, `1 / range = (b + sqrt(r^2 - s^2)) / (d^2 - r^2)`.
#[inline(always)]
fn paint_disc(beams: &Beams, center: &Vector2<f64>, radius: f64, inverse: &mut [[f32; LANES]]) {
    let squared = center.norm_squared();
    let scale = (1.0 / (squared - radius * radius).max(1e-9)) as f32;
    let (x, y, r_squared) = (center.x as f32, center.y as f32, (radius * radius) as f32);
    for run in beams.around([x, y], squared.sqrt() as f32, radius as f32) {
        for block in run {
            let (out, cos, sin) = (&mut inverse[block], &beams.cos[block], &beams.sin[block]);
            for lane in 0..LANES {
                let along = x * cos[lane] + y * sin[lane];
                let beside = x * sin[lane] - y * cos[lane];
                let half_chord_squared = r_squared - beside * beside;
                let value = (along + greater(half_chord_squared, 0.0).sqrt()) * scale;
                let hit = half_chord_squared >= 0.0 && along > 0.0;
                out[lane] = greater(out[lane], if hit { value } else { 0.0 });
            }
        }
    }
}

/// A convex polygon: those of its edges that face the sensor.
#[inline(always)]
fn paint_polygon(beams: &Beams, corners: &[Point], pose: &Pose, max_range: f64, inverse: &mut [[f32; LANES]]) {
    let mut from = to_sensor(pose, &corners[corners.len() - 1]);
    for corner in corners {
        let to = to_sensor(pose, corner);
        paint_edge(beams, &to, &from, max_range, inverse);
        from = to;
    }
}

/// An edge from its right end to its left one, as seen from in front of it: with `w = left x right` (cross products),
/// `1 / range = u x (left - right) / w` for the beam `u`, where `right x u >= 0` and `left x u < 0`. The end that two edges
/// share gives both the same numbers, so that no beam passes between them.
#[inline(always)]
fn paint_edge(beams: &Beams, right: &Vector2<f64>, left: &Vector2<f64>, max_range: f64, inverse: &mut [[f32; LANES]]) {
    let area = right.perp(left);
    let along = left - right;
    if area <= 0.0 || area * area > max_range * max_range * along.norm_squared() {
        return; // seen from behind, or its line is out of range
    }
    let slope = [(along.x / area) as f32, (along.y / area) as f32];
    let (right, left) = ([right.x as f32, right.y as f32], [left.x as f32, left.y as f32]);
    for run in beams.between(right, left) {
        for block in run {
            let (out, cos, sin) = (&mut inverse[block], &beams.cos[block], &beams.sin[block]);
            for lane in 0..LANES {
                let (u, v) = (cos[lane], sin[lane]);
                let is_left_of_right = right[0] * v - right[1] * u >= 0.0;
                let is_right_of_left = left[0] * v - left[1] * u < 0.0;
                let value = u * slope[1] - v * slope[0];
                let hit = is_left_of_right & is_right_of_left;
                out[lane] = greater(out[lane], if hit { value } else { 0.0 });
            }
        }
    }
}

/// The greater of two numbers that are none of them NaN, in one instruction.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam_angles;
    use headway_sim::{Kinds, RoomSpec, Scenario, VehicleSpec, WorldSpec};
    use std::f64::consts::TAU;

    #[test]
    fn scans_do_not_depend_on_the_vector_instructions() {
        let room = RoomSpec { kinds: Kinds { disc: 1.0, r#box: 1.0, polygon: 1.0 }, ..RoomSpec::default() };
        let vehicle = VehicleSpec::default().build().unwrap();
        let source = WorldSpec::Room(room).build(vehicle.footprint()).unwrap();
        let beams = Beams::new(&beam_angles(360, TAU), true);
        let mut painted = vec![[0.0; LANES]; beams.n_blocks()];
        let mut plain = painted.clone();
        for index in 0..50 {
            let scenario = source.scenario(8, index).unwrap();
            let Scenario { world, start, .. } = &scenario;
            paint_portable(&beams, world, start, 30.0, &mut plain);
            paint(&beams, world, start, 30.0, &mut painted);
            assert_eq!(painted, plain);
            #[cfg(target_arch = "x86_64")]
            if is_x86_feature_detected!("avx2") {
                // SAFETY: the processor has AVX2.
                unsafe { paint_avx2(&beams, world, start, 30.0, &mut painted) };
                assert_eq!(painted, plain);
            }
        }
    }
}
