//! Observations: what is perceived, as the numbers that a network reads.

use headway_planning::Sensed;
use headway_sensors::Lidar;
use headway_sim::Vehicle;
use headway_sim::nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// How observations are encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ObservationSpec {
    /// How a lidar range becomes a number.
    pub encoding: ScanEncoding,
    /// Whether scenes with the goal on the right are shown as in a mirror, so that it always lies on the
    /// left; actions are mirrored back. Halves what there is to learn.
    pub mirror: bool,
}

impl Default for ObservationSpec {
    fn default() -> Self {
        Self { encoding: ScanEncoding::Clearance, mirror: true }
    }
}

/// How a range `r` in metres becomes a number in [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ScanEncoding {
    /// `r / max_range`.
    Linear,
    /// `1 - sqrt(r / max_range)`.
    Root,
    /// `0.25 / (c + 0.25)` with the clearance `c = max(0, r - e)`, where `e` is the footprint's extent
    /// towards the beam: 1 at contact, half at 25 cm.
    Clearance,
}

/// Whether an observation shows the scene as it is or as in a mirror.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Side {
    /// As it is.
    #[default]
    AsSeen,
    /// Left and right exchanged.
    Mirrored,
}

/// The checked encoding: a pure function from [`Sensed`] to `n_beams + 6` numbers.
///
/// | entry | is | range |
/// |---|---|---|
/// | `0..n_beams` | the encoded ranges, right to left | [0, 1] |
/// | `n_beams` | `d / (d + 3)` for the distance `d` to the goal in metres | [0, 1) |
/// | `+ 1` | cosine of the goal's bearing | [-1, 1] |
/// | `+ 2` | sine of the goal's bearing, positive on the left | [-1, 1] |
/// | `+ 3` | `min(d, 2) / 2` | [0, 1] |
/// | `+ 4` | speed / highest speed | [-1, 1] |
/// | `+ 5` | yaw rate / highest yaw rate, positive to the left | [-1, 1] |
#[derive(Debug, Clone)]
pub struct Encoder {
    spec: ObservationSpec,
    min_range: f32,
    max_range: f32,
    /// The footprint's extent towards each beam, metres.
    extents: Vec<f32>,
    is_full_turn: bool,
    max_speed: f64,
    max_yaw_rate: f64,
}

impl Encoder {
    /// Entries behind the ranges.
    const N_OTHERS: usize = 6;
    /// Distance at which half of the first distance entry is used up, metres.
    pub const FAR: f64 = 3.0;
    /// Distance from which on the second distance entry is 1, metres.
    pub const NEAR: f64 = 2.0;
    /// Clearance encoded as a half, metres.
    pub const HALF_CLEARANCE: f32 = 0.25;

    /// The encoding of a lidar's scans on a vehicle.
    #[must_use]
    pub fn new(spec: ObservationSpec, lidar: &Lidar, vehicle: &Vehicle) -> Self {
        let limits = vehicle.spec();
        Self {
            spec,
            min_range: lidar.spec().min_range as f32,
            max_range: lidar.spec().max_range as f32,
            extents: lidar.beam_angles().iter().map(|angle| vehicle.footprint().extent(*angle) as f32).collect(),
            is_full_turn: lidar.is_full_turn(),
            max_speed: limits.max_speed.max(limits.max_reverse_speed),
            max_yaw_rate: limits.max_yaw_rate,
        }
    }

    /// Numbers in an observation.
    #[must_use]
    pub fn obs_dim(&self) -> usize {
        self.extents.len() + Self::N_OTHERS
    }

    /// From which side a scene is shown.
    #[must_use]
    pub fn side(&self, sensed: &Sensed<'_>) -> Side {
        if self.spec.mirror && sensed.to_goal().y < 0.0 { Side::Mirrored } else { Side::AsSeen }
    }

    /// Encodes what is sensed into `obs`, shape `[obs_dim]`, and says from which side it is shown.
    ///
    /// Ranges are clamped to the lidar's limits; one that is not finite counts as no return, as in scans of real robots.
    ///
    /// # Panics
    /// If `obs` or the scan has another length.
    pub fn encode(&self, sensed: &Sensed<'_>, obs: &mut [f32]) -> Side {
        let n_beams = self.extents.len();
        assert_eq!(sensed.scan.len(), n_beams, "one range per beam");
        let to_goal = sensed.to_goal();
        let distance = to_goal.norm();
        // At the goal itself every bearing is right: straight ahead.
        let ahead = if distance > 0.0 { to_goal / distance } else { Vector2::x() };
        let side = self.side(sensed);
        let (ranges, others) = obs.split_at_mut(n_beams);
        self.encode_ranges(sensed.scan, ranges);
        if side == Side::Mirrored {
            // The first beam of a full turn looks straight behind, and is its own mirror image.
            ranges[usize::from(self.is_full_turn)..].reverse();
        }
        let left = if side == Side::Mirrored { -1.0 } else { 1.0 };
        let entries = [
            distance / (distance + Self::FAR),
            ahead.x,
            left * ahead.y,
            distance.min(Self::NEAR) / Self::NEAR,
            sensed.twist.x / self.max_speed,
            left * sensed.twist.z / self.max_yaw_rate,
        ];
        others.copy_from_slice(&entries.map(|entry| entry as f32));
        side
    }

    fn encode_ranges(&self, scan: &[f32], out: &mut [f32]) {
        let seen = |range: f32| {
            if range.is_finite() { range.clamp(self.min_range, self.max_range) } else { self.max_range }
        };
        let ranges = out.iter_mut().zip(scan).zip(&self.extents);
        match self.spec.encoding {
            ScanEncoding::Linear => ranges.for_each(|((out, range), _)| *out = seen(*range) / self.max_range),
            ScanEncoding::Root => {
                ranges.for_each(|((out, range), _)| *out = 1.0 - (seen(*range) / self.max_range).sqrt());
            }
            ScanEncoding::Clearance => ranges.for_each(|((out, range), extent)| {
                let clearance = (seen(*range) - extent).max(0.0);
                *out = Self::HALF_CLEARANCE / (clearance + Self::HALF_CLEARANCE);
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headway_sensors::LidarSpec;
    use headway_sim::{Point, Pose, Twist, VehicleSpec};

    fn encoder(encoding: ScanEncoding, mirror: bool, field_of_view: f64) -> (Encoder, Lidar) {
        let lidar = LidarSpec { n_beams: 4, field_of_view, ..LidarSpec::default() }.build().unwrap();
        let spec = ObservationSpec { encoding, mirror };
        let vehicle = VehicleSpec::default().build().unwrap();
        (Encoder::new(spec, &lidar, &vehicle), lidar)
    }

    fn encode(encoder: &(Encoder, Lidar), goal: Point) -> (Vec<f32>, Side) {
        encode_scan(encoder, goal, &[0.5, 1.0, 2.0, 4.0])
    }

    fn encode_scan(encoder: &(Encoder, Lidar), goal: Point, scan: &[f32]) -> (Vec<f32>, Side) {
        let sensed = Sensed {
            vehicle: &VehicleSpec::default(),
            scan,
            beam_angles: encoder.1.beam_angles(),
            max_range: 5.0,
            pose: Pose::new([1.0, 1.0].into(), std::f64::consts::FRAC_PI_2),
            twist: Twist::new(0.75, 0.0, -0.3),
            goal,
            route: None,
        };
        let mut obs = vec![0.0; encoder.0.obs_dim()];
        let side = encoder.0.encode(&sensed, &mut obs);
        (obs, side)
    }

    fn assert_close(found: &[f32], expected: &[f32]) {
        assert_eq!(found.len(), expected.len());
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < 1e-6, "{found:?} but {expected:?}");
        }
    }

    #[test]
    fn every_entry_by_hand() {
        // Facing +y from (1, 1), a goal at (-3, 4) lies 3 m ahead and 4 m to the left.
        let goal = Point::new(-3.0, 4.0);
        let others = [5.0 / 8.0, 0.6, 0.8, 1.0, 0.5, -0.2];
        let full = std::f64::consts::TAU;
        let scans = [
            (ScanEncoding::Linear, [0.1, 0.2, 0.4, 0.8]),
            (ScanEncoding::Root, [0.1, 0.2, 0.4, 0.8].map(|x: f32| 1.0 - x.sqrt())),
            (ScanEncoding::Clearance, [0.5, 0.25, 0.125, 0.0625]),
        ];
        for (encoding, scan) in scans {
            let (obs, side) = encode(&encoder(encoding, true, full), goal);
            assert_eq!(side, Side::AsSeen);
            assert_close(&obs, &[scan.as_slice(), others.as_slice()].concat());
        }
    }

    #[test]
    fn readings_of_real_lidars_are_taken_as_they_are_meant() {
        let odd = [f32::INFINITY, f32::NAN, -1.0, 80.0];
        let (obs, _) = encode_scan(&encoder(ScanEncoding::Linear, false, 3.0), Point::new(5.0, 1.0), &odd);
        assert_close(&obs[..4], &[1.0, 1.0, 0.0, 1.0]);
    }

    #[test]
    fn a_goal_on_the_right_is_shown_on_the_left() {
        let goal = Point::new(5.0, 4.0); // 3 m ahead, 4 m to the right
        let others = [5.0 / 8.0, 0.6, 0.8, 1.0, 0.5, 0.2];
        // Beams behind, right, ahead, left: behind and ahead stay, right and left change places.
        let (obs, side) = encode(&encoder(ScanEncoding::Linear, true, std::f64::consts::TAU), goal);
        assert_eq!(side, Side::Mirrored);
        assert_close(&obs, &[[0.1, 0.8, 0.4, 0.2].as_slice(), others.as_slice()].concat());
        let (obs, _) = encode(&encoder(ScanEncoding::Linear, true, 3.0), goal);
        assert_close(&obs[..4], &[0.8, 0.4, 0.2, 0.1]);
        let (obs, side) = encode(&encoder(ScanEncoding::Linear, false, 3.0), goal);
        assert_eq!(side, Side::AsSeen);
        assert_close(&obs[..4], &[0.1, 0.2, 0.4, 0.8]);
        assert!((obs[6] + 0.8).abs() < 1e-6);
    }
}
