//! A planar lidar.

use std::f64::consts::{FRAC_PI_2, TAU};

use headway_sim::check::{fraction, non_negative, positive, within};
use headway_sim::{FieldError, Point, Pose, World};
use nalgebra::Vector2;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use crate::beams::{Beams, LANES};
use crate::grazing::sine;
use crate::kernel::paint;

/// A planar lidar at the vehicle's origin, as data.
///
/// Where a beam meets nothing within `max_range`, and where it is lost, the scan holds `max_range`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LidarSpec {
    /// Beams a scan, at most 100 000.
    pub n_beams: usize,
    /// Angle covered, radians, at most a full turn; see [`beam_angles`].
    pub field_of_view: f64,
    /// Nearest range it reports, metres; what is nearer is reported as this.
    pub min_range: f64,
    /// Farthest range it reports, metres; what is farther, or a lost beam, is reported as this.
    pub max_range: f64,
    /// Standard deviation of a range, metres.
    pub noise: f64,
    /// Probability that a beam is lost.
    pub dropout: f64,
    /// Angle between a beam and a surface below which nothing comes back, so that the beam is lost, radians, from 0 to pi/2;
    /// 0 for surfaces that always reflect.
    pub grazing_angle: f64,
}

impl Default for LidarSpec {
    fn default() -> Self {
        Self {
            n_beams: 36,
            field_of_view: TAU,
            min_range: 0.0,
            max_range: 5.0,
            noise: 0.0,
            dropout: 0.0,
            grazing_angle: 0.0,
        }
    }
}

impl LidarSpec {
    /// Checks the numbers and builds the lidar.
    ///
    /// # Errors
    /// Names the field, its value and what is allowed.
    pub fn build(&self) -> Result<Lidar, FieldError> {
        within("n_beams", self.n_beams as f64, 1.0, 1e5)?;
        positive("field_of_view", self.field_of_view)?;
        if self.field_of_view > TAU + 1e-9 {
            return Err(FieldError::new("field_of_view", self.field_of_view, "at most a full turn, 2 pi = 6.2832"));
        }
        non_negative("min_range", self.min_range)?;
        positive("max_range", self.max_range)?;
        if self.max_range <= self.min_range {
            let allowed = format!("more than min_range = {}", self.min_range);
            return Err(FieldError::new("max_range", self.max_range, allowed));
        }
        non_negative("noise", self.noise)?;
        fraction("dropout", self.dropout)?;
        within("grazing_angle", self.grazing_angle, 0.0, FRAC_PI_2)?;
        let beam_angles = beam_angles(self.n_beams, self.field_of_view);
        let beams = Beams::new(&beam_angles, is_full_turn(self.field_of_view));
        Ok(Lidar { spec: self.clone(), beam_angles, beams })
    }
}

/// The directions of a scan's beams in the vehicle's frame, radians, from right to left.
///
/// A field of view of a full turn is divided into `n_beams` equal parts that start behind the vehicle, at
/// `-pi`, which is not repeated at `pi`. A smaller one has a beam on both of its ends. A single beam looks
/// ahead.
///
/// ```
/// use headway_sensors::beam_angles;
/// use std::f64::consts::{FRAC_PI_2, PI, TAU};
/// assert_eq!(beam_angles(4, TAU), [-PI, -FRAC_PI_2, 0.0, FRAC_PI_2]);
/// assert_eq!(beam_angles(3, PI), [-FRAC_PI_2, 0.0, FRAC_PI_2]);
/// assert_eq!(beam_angles(1, PI), [0.0]);
/// ```
#[must_use]
pub fn beam_angles(n_beams: usize, field_of_view: f64) -> Vec<f64> {
    if n_beams == 1 {
        return vec![0.0];
    }
    let n_gaps = if is_full_turn(field_of_view) { n_beams } else { n_beams - 1 };
    // (2 k - n_gaps) / (2 n_gaps) of the view: exactly 0 in the middle, and symmetric around it.
    let share = |k: usize| (2.0 * k as f64 - n_gaps as f64) / (2.0 * n_gaps as f64);
    (0..n_beams).map(|k| share(k) * field_of_view).collect()
}

fn is_full_turn(field_of_view: f64) -> bool {
    field_of_view > TAU - 1e-9
}

/// A checked lidar.
#[derive(Debug, Clone)]
pub struct Lidar {
    spec: LidarSpec,
    beam_angles: Vec<f64>,
    beams: Beams,
}

impl Lidar {
    /// The data it was built from.
    #[must_use]
    pub fn spec(&self) -> &LidarSpec {
        &self.spec
    }

    /// The beams' directions in the vehicle's frame, radians; see [`beam_angles`].
    #[must_use]
    pub fn beam_angles(&self) -> &[f64] {
        &self.beam_angles
    }

    /// Whether the beams go all the way round, so that the last one's neighbour is the first.
    #[must_use]
    pub fn is_full_turn(&self) -> bool {
        is_full_turn(self.spec.field_of_view)
    }

    /// Measures from `pose`: one range in metres per beam into `ranges`, shape `[n_beams]`.
    ///
    /// A range is the distance to the first surface, within 1 mm of the exact one, plus Gaussian noise, clamped to the range
    /// limits; a beam is lost with the dropout's probability. Random numbers are drawn only for noise or dropout above 0.
    ///
    /// # Panics
    /// If `ranges` does not hold one number per beam.
    pub fn scan(&self, world: &World, pose: &Pose, rng: &mut impl RngExt, ranges: &mut [f32]) {
        assert_eq!(ranges.len(), self.beam_angles.len(), "one range per beam");
        match self.beams.n_blocks() {
            0..=4 => self.measure(world, pose, &mut [[0.0; LANES]; 4], ranges),
            5..=32 => self.measure(world, pose, &mut [[0.0; LANES]; 32], ranges),
            33..=256 => self.measure(world, pose, &mut [[0.0; LANES]; 256], ranges),
            n => self.measure(world, pose, &mut vec![[0.0; LANES]; n], ranges),
        }
        if self.spec.grazing_angle > 0.0 {
            self.lose_grazing(world, pose, ranges);
        }
        if self.spec.noise > 0.0 || self.spec.dropout > 0.0 {
            self.disturb(rng, ranges);
        }
    }

    /// The ranges without noise, by way of inverse ranges in `scratch`, which has a block for every block of beams or more.
    fn measure(&self, world: &World, pose: &Pose, scratch: &mut [[f32; LANES]], ranges: &mut [f32]) {
        let inverse = &mut scratch[..self.beams.n_blocks()];
        paint(&self.beams, world, pose, self.spec.max_range, inverse);
        let (min_range, max_range) = (self.spec.min_range as f32, self.spec.max_range as f32);
        for (range, inverse) in ranges.iter_mut().zip(inverse.as_flattened()) {
            *range = (1.0 / inverse).clamp(min_range, max_range);
        }
    }

    /// Loses the beams that met something at too small an angle.
    fn lose_grazing(&self, world: &World, pose: &Pose, ranges: &mut [f32]) {
        let (least, max_range) = (self.spec.grazing_angle.sin(), self.spec.max_range as f32);
        for (range, angle) in ranges.iter_mut().zip(&self.beam_angles) {
            if *range < max_range {
                let direction = pose.rotation * Vector2::new(angle.cos(), angle.sin());
                let end = Point::from(pose.translation.vector + direction * f64::from(*range));
                if sine(world, &end, &direction) < least {
                    *range = max_range;
                }
            }
        }
    }

    /// Adds noise to the beams that met something, and loses some.
    fn disturb(&self, rng: &mut impl RngExt, ranges: &mut [f32]) {
        let (min_range, max_range) = (self.spec.min_range as f32, self.spec.max_range as f32);
        for range in ranges {
            if *range < max_range && self.spec.noise > 0.0 {
                let deviation: f64 = StandardNormal.sample(rng);
                *range = (*range + (self.spec.noise * deviation) as f32).clamp(min_range, max_range);
            }
            if self.spec.dropout > 0.0 && rng.random_bool(self.spec.dropout) {
                *range = max_range;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headway_sim::{Obstacle, Room, Shape, VehicleSpec, WorldSpec, stream};
    use proptest::prelude::*;

    fn scan(lidar: &Lidar, world: &World, pose: &Pose) -> Vec<f32> {
        let mut ranges = vec![0.0; lidar.beam_angles().len()];
        lidar.scan(world, pose, &mut stream(3, "noise", 0), &mut ranges);
        ranges
    }

    /// A hall whose walls are out of sight, with a few solids around its middle, turned by `yaw` around it
    /// and moved by `(dx, dy)`.
    fn hall(solids: &[(f64, f64, f64)], yaw: f64, dx: f64, dy: f64) -> World {
        let around = Pose::new([100.0 + dx, 100.0 + dy].into(), yaw);
        let place = |&(x, y, size): &(f64, f64, f64)| {
            let at = around * Point::new(x, y);
            let shape = if size > 0.5 { Shape::Box { length: size, width: 0.3 } } else { Shape::Disc { radius: size } };
            Obstacle { shape, x: at.x, y: at.y, yaw }
        };
        let room = Room::new(200.0, 200.0);
        World::new(room, solids.iter().map(place).collect()).unwrap()
    }

    proptest! {
        #[test]
        fn scans_do_not_depend_on_where_the_whole_scene_is_nor_how_it_is_turned(
            solids in prop::collection::vec((-4.0..4.0, -4.0..4.0, 0.1..1.0), 0..6),
            yaw in -3.0..3.0, dx in -50.0..50.0, dy in -50.0..50.0,
        ) {
            let lidar = LidarSpec::default().build().unwrap();
            let before = scan(&lidar, &hall(&solids, 0.0, 0.0, 0.0), &Pose::translation(100.0, 100.0));
            let moved = Pose::new([100.0 + dx, 100.0 + dy].into(), yaw);
            let after = scan(&lidar, &hall(&solids, yaw, dx, dy), &moved);
            for (a, b) in before.iter().zip(&after) {
                // A beam that grazes may just hit or just miss after rounding.
                prop_assert!((a - b).abs() < 1e-4 || a.max(*b) > 1.0 + a.min(*b), "{a} but {b}");
            }
            let n_differing = before.iter().zip(&after).filter(|(a, b)| (*a - *b).abs() > 1e-4).count();
            prop_assert!(n_differing <= 1);
        }

        #[test]
        fn ranges_stay_within_the_limits(seed in 0..500_u64, noise in 0.0..0.5, dropout in 0.0..0.5) {
            let spec = LidarSpec { noise, dropout, min_range: 0.1, ..LidarSpec::default() };
            let vehicle = VehicleSpec::default().build().unwrap();
            let source = WorldSpec::default().build(vehicle.footprint()).unwrap();
            let scenario = source.scenario(seed, 0).unwrap();
            let ranges = scan(&spec.build().unwrap(), &scenario.world, &scenario.start);
            prop_assert!(ranges.iter().all(|r| (0.1..=5.0).contains(r)));
        }
    }

    #[test]
    fn noise_and_dropout_have_their_sizes() {
        let world = World::new(Room::new(10.0, 10.0), vec![]).unwrap();
        let spec = LidarSpec { n_beams: 20_000, noise: 0.1, dropout: 0.25, max_range: 50.0, ..LidarSpec::default() };
        let clean = LidarSpec { noise: 0.0, dropout: 0.0, ..spec.clone() };
        let pose = Pose::translation(5.0, 5.0);
        let [noisy, clean] = [spec, clean].map(|s| scan(&s.build().unwrap(), &world, &pose));
        let errors: Vec<f64> =
            noisy.iter().zip(&clean).filter(|(r, _)| **r < 50.0).map(|(a, b)| f64::from(a - b)).collect();
        let lost = 1.0 - errors.len() as f64 / 20_000.0;
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        let deviation = (errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / errors.len() as f64).sqrt();
        assert!((lost - 0.25).abs() < 0.015, "{lost}");
        assert!(mean.abs() < 0.004 && (deviation - 0.1).abs() < 0.003, "{mean} {deviation}");
    }

    /// Beams along a wall are lost beyond the distance at which they meet it at the grazing angle.
    #[test]
    fn grazing_beams_are_lost() {
        let room = Room::new(40.0, 2.0);
        let disc = Obstacle { shape: Shape::Disc { radius: 0.5 }, x: 25.0, y: 1.0, yaw: 0.0 };
        let square = Obstacle { shape: Shape::Box { length: 0.6, width: 0.6 }, x: 17.0, y: 1.0, yaw: 0.6 };
        let world = World::new(room, vec![disc, square]).unwrap();
        let spec = LidarSpec { n_beams: 3600, max_range: 30.0, ..LidarSpec::default() };
        let grazing = LidarSpec { grazing_angle: 0.25, ..spec.clone() };
        let pose = Pose::new([20.0, 1.0].into(), 0.1);
        let [all, seen] = [spec, grazing].map(|spec| (scan(&spec.build().unwrap(), &world, &pose), spec));
        let angles = seen.1.build().unwrap();
        for ((clean, range), angle) in all.0.iter().zip(&seen.0).zip(angles.beam_angles()) {
            let world_angle = angle + 0.1;
            let end = Point::new(20.0, 1.0) + Vector2::new(world_angle.cos(), world_angle.sin()) * f64::from(*clean);
            // The sine of the angle to each surface by its own formula: walls along x, the disc, the square's four sides.
            let sine = if end.y < 0.01 || end.y > 1.99 {
                world_angle.sin().abs()
            } else if end.x > 24.0 && end.x < 26.0 {
                let across = (Point::new(25.0, 1.0) - Point::new(20.0, 1.0))
                    .perp(&Vector2::new(world_angle.cos(), world_angle.sin()));
                (1.0 - (across / 0.5).powi(2)).max(0.0).sqrt()
            } else {
                let local = Pose::new([17.0, 1.0].into(), 0.6).inverse_transform_point(&end);
                let turned = world_angle - 0.6;
                if local.x.abs() > local.y.abs() { turned.cos().abs() } else { turned.sin().abs() }
            };
            if (sine - 0.25_f64.sin()).abs() > 0.02 {
                assert_eq!(*range == 30.0, sine < 0.25_f64.sin(), "{end} {sine}");
            }
        }
        assert!(seen.0.iter().filter(|range| **range == 30.0).count() > 300);
    }

    #[test]
    fn refusals_name_the_field() {
        let refused = |spec: LidarSpec| spec.build().unwrap_err().to_string();
        let backwards = LidarSpec { min_range: 6.0, ..LidarSpec::default() };
        assert_eq!(refused(backwards), "max_range = 5: must be more than min_range = 6");
        let lossy = LidarSpec { dropout: 1.5, ..LidarSpec::default() };
        assert_eq!(refused(lossy), "dropout = 1.5: must be from 0 to 1");
        let wide = LidarSpec { field_of_view: 7.0, ..LidarSpec::default() };
        assert_eq!(refused(wide), "field_of_view = 7: must be at most a full turn, 2 pi = 6.2832");
    }
}
