//! From what is perceived to the numbers that a network reads.

use headway_planning::Sensed;
use headway_sensors::Lidar;
use headway_sim::nalgebra::Vector2;
use headway_sim::{FieldError, Mover, Point, Vehicle};

use crate::{History, ObservationSpec, ScanEncoding, Side};

/// The checked encoding: a pure function from [`Sensed`] and a [`History`] to `n_ranges + 6` numbers or more, where `n_ranges`
/// is the number of sectors, or of beams where there are no sectors.
///
/// Speeds and yaw rates are over the highest of the spec; a vehicle whose odometry is off, whose wheels slip or whose limits are drawn
/// may exceed them somewhat.
///
/// | entry | is | range |
/// |---|---|---|
/// | `0..n_ranges` | the encoded ranges, right to left | [0, 1] |
/// | `n_ranges` | `d / (d + 3)` for the distance `d` to the goal in metres | [0, 1) |
/// | `+ 1` | cosine of the goal's bearing | [-1, 1] |
/// | `+ 2` | sine of the goal's bearing, positive on the left | [-1, 1] |
/// | `+ 3` | `min(d, 2) / 2` | [0, 1] |
/// | `+ 4` | speed / highest speed | [-1, 1] |
/// | `+ 5` | yaw rate / highest yaw rate, positive to the left | [-1, 1] |
/// | one, for vehicles that move sideways | leftward speed / highest | [-1, 1] |
/// | two for each of `look_ahead` | cosine and sine of the bearing of that point of the route, or of the straight line to the goal | [-1, 1] |
/// | two for each of `trail` | `x / (1 + r)`, `y / (1 + r)` of the place `(x, y)` in the vehicle's frame, `r` metres away | (-1, 1) |
/// | two for `last_command`, three for vehicles that move sideways | its speed, yaw rate and leftward speed, over the highest ones | [-1, 1] |
/// | five for each of `n_movers` | of the nearest movers: `0.5 / (c + 0.5)` for the clearance `c` between the discs around both, cosine and sine of the bearing, and the velocity ahead and to the left over the vehicle's highest speed, clamped; 0 where there is none | [-1, 1] |
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
    max_lateral_speed: f64,
    /// The footprint's circumradius, metres.
    radius: f64,
    /// Of each entry of the trail: how many control periods ago.
    trail: Vec<usize>,
}

impl Encoder {
    /// Distance at which half of the first distance entry is used up, metres.
    pub const FAR: f64 = 3.0;
    /// Distance from which on the second distance entry is 1, metres.
    pub const NEAR: f64 = 2.0;
    /// Clearance encoded as a half, metres.
    pub const HALF_CLEARANCE: f32 = 0.25;
    /// Clearance from a mover encoded as a half, metres.
    pub const HALF_MOVER: f64 = 0.5;

    /// The encoding of a lidar's scans on a vehicle.
    ///
    /// # Errors
    /// Names the field of the observation that is not allowed.
    pub fn new(spec: &ObservationSpec, lidar: &Lidar, vehicle: &Vehicle) -> Result<Self, FieldError> {
        spec.check(lidar.beam_angles().len())?;
        let limits = vehicle.spec();
        let periods = |time: &f64| (time / limits.control_period).round() as usize;
        Ok(Self {
            min_range: lidar.spec().min_range as f32,
            max_range: lidar.spec().max_range as f32,
            extents: lidar.beam_angles().iter().map(|angle| vehicle.footprint().extent(*angle) as f32).collect(),
            is_full_turn: lidar.is_full_turn(),
            max_speed: limits.max_speed.max(limits.max_reverse_speed),
            max_yaw_rate: limits.max_yaw_rate,
            max_lateral_speed: limits.drive.max_lateral_speed(),
            radius: vehicle.footprint().circumradius(),
            trail: spec.trail.iter().map(periods).collect(),
            spec: spec.clone(),
        })
    }

    /// Numbers in an observation.
    #[must_use]
    pub fn obs_dim(&self) -> usize {
        let ObservationSpec { look_ahead, trail, last_command, n_movers, .. } = &self.spec;
        let n_pairs = look_ahead.len() + trail.len() + usize::from(*last_command);
        let n_aside = if self.max_lateral_speed > 0.0 { 1 + usize::from(*last_command) } else { 0 };
        self.n_ranges() + 6 + n_aside + 2 * n_pairs + 5 * n_movers
    }

    /// An empty memory, as long as this encoding needs it.
    #[must_use]
    pub fn history(&self) -> History {
        History::new(self.trail.iter().copied().max().unwrap_or(0))
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
    pub fn encode(&self, sensed: &Sensed<'_>, history: &History, obs: &mut [f32]) -> Side {
        assert_eq!(sensed.scan.len(), self.extents.len(), "one range per beam");
        assert_eq!(obs.len(), self.obs_dim(), "as many numbers as an observation has");
        let to_goal = sensed.to_goal();
        let distance = to_goal.norm();
        // At the goal itself every bearing is right: straight ahead.
        let ahead = if distance > 0.0 { to_goal / distance } else { Vector2::x() };
        let side = self.side(sensed);
        let (ranges, others) = obs.split_at_mut(self.n_ranges());
        self.encode_scan(sensed.scan, side, ranges);
        let left = if side == Side::Mirrored { -1.0 } else { 1.0 };
        let entries = [
            distance / (distance + Self::FAR),
            ahead.x,
            left * ahead.y,
            distance.min(Self::NEAR) / Self::NEAR,
            sensed.twist.x / self.max_speed,
            left * sensed.twist.z / self.max_yaw_rate,
        ];
        let (first, more) = others.split_at_mut(entries.len());
        first.copy_from_slice(&entries.map(|entry| entry as f32));
        if !more.is_empty() {
            self.encode_more(sensed, history, left, more);
        }
        side
    }

    /// What only some observations hold, in its order.
    fn encode_more(&self, sensed: &Sensed<'_>, history: &History, left: f64, out: &mut [f32]) {
        let mut out = out.iter_mut();
        let mut put = |number: f64| {
            if let Some(place) = out.next() {
                *place = number as f32;
            }
        };
        if self.max_lateral_speed > 0.0 {
            put(left * sensed.twist.y / self.max_lateral_speed);
        }
        let here = Point::from(sensed.pose.translation.vector);
        let seen = |point: &Point| sensed.pose.inverse_transform_point(point).coords;
        for point in self.look_ahead(sensed, &here) {
            let to = seen(&point).try_normalize(1e-9).unwrap_or(Vector2::x());
            put(to.x);
            put(left * to.y);
        }
        for n_periods in &self.trail {
            let to = seen(&history.place(*n_periods, here));
            let scale = 1.0 / (1.0 + to.norm());
            put(scale * to.x);
            put(scale * left * to.y);
        }
        if self.spec.last_command {
            put(sensed.last_command.speed / self.max_speed);
            put(left * sensed.last_command.yaw_rate / self.max_yaw_rate);
            if self.max_lateral_speed > 0.0 {
                put(left * sensed.last_command.lateral_speed / self.max_lateral_speed);
            }
        }
        if self.spec.n_movers > 0 {
            self.movers(sensed, &here, left).into_iter().flatten().for_each(put);
        }
    }

    /// The nearest movers, as many as are shown.
    fn movers(&self, sensed: &Sensed<'_>, here: &Point, left: f64) -> Vec<[f64; 5]> {
        let clearance = |mover: &Mover| (mover.position - here).norm() - mover.radius - self.radius;
        let mut nearest: Vec<&Mover> = sensed.movers.iter().collect();
        nearest.sort_by(|a, b| clearance(a).total_cmp(&clearance(b)));
        let shown = |mover: &&Mover| {
            let to = sensed.pose.inverse_transform_point(&mover.position).coords;
            let to = to.try_normalize(1e-9).unwrap_or(Vector2::x());
            let velocity = sensed.pose.rotation.inverse() * mover.velocity / self.max_speed;
            let near = Self::HALF_MOVER / (clearance(mover).max(0.0) + Self::HALF_MOVER);
            [near, to.x, left * to.y, velocity.x.clamp(-1.0, 1.0), left * velocity.y.clamp(-1.0, 1.0)]
        };
        let mut rows: Vec<[f64; 5]> = nearest.iter().take(self.spec.n_movers).map(shown).collect();
        rows.resize(self.spec.n_movers, [0.0; 5]);
        rows
    }

    /// The points ahead on the route.
    fn look_ahead(&self, sensed: &Sensed<'_>, here: &Point) -> Vec<Point> {
        if self.spec.look_ahead.is_empty() {
            return Vec::new();
        }
        let route = sensed.route_or_straight();
        let along = route.project(here);
        self.spec.look_ahead.iter().map(|ahead| route.at(along + ahead)).collect()
    }

    fn n_ranges(&self) -> usize {
        if self.spec.n_sectors > 0 { self.spec.n_sectors } else { self.extents.len() }
    }

    /// Encodes the scan as shown from a side.
    fn encode_scan(&self, scan: &[f32], side: Side, out: &mut [f32]) {
        if self.spec.n_sectors > 0 {
            return self.encode_sectors(scan, side, out);
        }
        let shown = out.iter_mut().zip(scan).zip(&self.extents);
        shown.for_each(|((out, range), extent)| *out = self.number(self.seen(*range), *extent));
        if side == Side::Mirrored {
            // The first beam of a full turn looks straight behind, and is its own mirror image.
            out[usize::from(self.is_full_turn)..].reverse();
        }
    }

    /// The greatest number of each sector, which is that of its nearest return; under [`ScanEncoding::Linear`] the least.
    fn encode_sectors(&self, scan: &[f32], side: Side, out: &mut [f32]) {
        let (n, width) = (scan.len(), scan.len() / out.len());
        let is_linear = self.spec.encoding == ScanEncoding::Linear;
        for (sector, out) in out.iter_mut().enumerate() {
            let mut nearest = if is_linear { f32::INFINITY } else { f32::NEG_INFINITY };
            for shown in sector * width..(sector + 1) * width {
                let beam = match side {
                    Side::AsSeen => shown,
                    Side::Mirrored if self.is_full_turn => (n - shown) % n,
                    Side::Mirrored => n - 1 - shown,
                };
                let number = self.number(self.seen(scan[beam]), self.extents[beam]);
                nearest = if is_linear { nearest.min(number) } else { nearest.max(number) };
            }
            *out = nearest;
        }
    }

    /// A range as the lidar should have reported it.
    #[inline]
    fn seen(&self, range: f32) -> f32 {
        if range.is_finite() { range.clamp(self.min_range, self.max_range) } else { self.max_range }
    }

    /// A range as a number.
    #[inline]
    fn number(&self, range: f32, extent: f32) -> f32 {
        match self.spec.encoding {
            ScanEncoding::Linear => range / self.max_range,
            ScanEncoding::Root => 1.0 - (range / self.max_range).sqrt(),
            ScanEncoding::Clearance => {
                let clearance = (range - extent).max(0.0);
                Self::HALF_CLEARANCE / (clearance + Self::HALF_CLEARANCE)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headway_planning::Route;
    use headway_sensors::LidarSpec;
    use headway_sim::{Command, Drive, Pose, Twist, VehicleSpec};

    fn encoder(encoding: ScanEncoding, mirror: bool, field_of_view: f64) -> (Encoder, Lidar) {
        let lidar = LidarSpec { n_beams: 4, field_of_view, ..LidarSpec::default() }.build().unwrap();
        let spec = ObservationSpec { encoding, mirror, ..Default::default() };
        let vehicle = VehicleSpec::default().build().unwrap();
        (Encoder::new(&spec, &lidar, &vehicle).unwrap(), lidar)
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
            last_command: Command::default(),
            movers: &[],
        };
        let mut obs = vec![0.0; encoder.0.obs_dim()];
        let side = encoder.0.encode(&sensed, &encoder.0.history(), &mut obs);
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

    #[test]
    fn sectors_show_their_nearest_return_from_either_side() {
        let lidar = |field_of_view| LidarSpec { n_beams: 6, field_of_view, ..LidarSpec::default() }.build().unwrap();
        let scan = [1.0, 2.0, 3.0, 0.5, 4.0, 5.0];
        let numbers = |encoding, field_of_view, side| {
            let spec = ObservationSpec { encoding, n_sectors: 3, ..Default::default() };
            let vehicle = VehicleSpec::default().build().unwrap();
            let mut out = [0.0; 3];
            Encoder::new(&spec, &lidar(field_of_view), &vehicle).unwrap().encode_scan(&scan, side, &mut out);
            out
        };
        let half = 3.0;
        assert_close(&numbers(ScanEncoding::Linear, half, Side::AsSeen), &[0.2, 0.1, 0.8]);
        assert_close(&numbers(ScanEncoding::Linear, half, Side::Mirrored), &[0.8, 0.1, 0.2]);
        // c = r - 0.25: 0.25 / (c + 0.25) = 0.25 / r.
        assert_close(&numbers(ScanEncoding::Clearance, half, Side::AsSeen), &[0.25, 0.5, 0.0625]);
        // Of a full turn, the beam behind stays, and the others change places: 1, 5 | 4, 0.5 | 3, 2.
        assert_close(&numbers(ScanEncoding::Linear, std::f64::consts::TAU, Side::Mirrored), &[0.2, 0.1, 0.4]);
        let spec = ObservationSpec { n_sectors: 4, ..Default::default() };
        let refused = Encoder::new(&spec, &lidar(half), &VehicleSpec::default().build().unwrap()).unwrap_err();
        assert_eq!(refused.to_string(), "n_sectors = 4: must be 0 or a divisor of the 6 beams");
    }

    #[test]
    fn routes_trails_commands_and_sideways_speed_by_hand() {
        let drive = Drive::Omnidirectional { max_lateral_speed: 0.5 };
        let vehicle = VehicleSpec { drive, ..VehicleSpec::default() };
        let lidar = LidarSpec { n_beams: 1, ..LidarSpec::default() }.build().unwrap();
        let spec = ObservationSpec {
            look_ahead: vec![2.0],
            trail: vec![0.2, 9.0],
            last_command: true,
            ..ObservationSpec::default()
        };
        let encoder = Encoder::new(&spec, &lidar, &vehicle.build().unwrap()).unwrap();
        let mut history = encoder.history();
        // From (0, -3) by (4, 0) to where it is now, the origin, facing +x.
        for [x, y] in [[0.0, -3.0], [4.0, 0.0], [0.0, 0.0]] {
            history.remember(&Pose::translation(x, y));
        }
        let route = Route::new(vec![Point::origin(), Point::new(0.0, -5.0)]);
        let encode = |goal| {
            let sensed = Sensed {
                vehicle: &vehicle,
                scan: &[5.0],
                beam_angles: lidar.beam_angles(),
                max_range: 5.0,
                pose: Pose::identity(),
                twist: Twist::new(0.0, 0.25, 0.0),
                goal,
                route: Some(&route),
                last_command: Command { lateral_speed: -0.25, ..Command::new(0.75, 0.3) },
                movers: &[],
            };
            let mut obs = vec![0.0; encoder.obs_dim()];
            encoder.encode(&sensed, &history, &mut obs);
            obs
        };
        // Sideways speed, bearing of (0, -2), (4, 0) one period ago, (0, -3) as the oldest, the command.
        let seen = [0.5, 0.0, -1.0, 0.8, 0.0, 0.0, -0.75, 0.5, 0.2, -0.5];
        assert_close(&encode(Point::new(3.0, 1.0))[7..], &seen);
        let mirrored = [-0.5, 0.0, 1.0, 0.8, 0.0, 0.0, 0.75, 0.5, -0.2, 0.5];
        assert_close(&encode(Point::new(3.0, -1.0))[7..], &mirrored);
        history.clear();
        assert_eq!(history.place(3, Point::new(1.0, 2.0)), Point::new(1.0, 2.0));
    }

    #[test]
    fn the_nearest_movers_are_shown_with_their_velocities() {
        let lidar = LidarSpec { n_beams: 1, ..LidarSpec::default() }.build().unwrap();
        let spec = ObservationSpec { n_movers: 3, ..ObservationSpec::default() };
        let vehicle = VehicleSpec::default(); // a disc of 0.25 m, at most 1.5 m/s
        let encoder = Encoder::new(&spec, &lidar, &vehicle.build().unwrap()).unwrap();
        let mover = |position: [f64; 2], velocity: [f64; 2]| Mover {
            position: position.into(),
            velocity: velocity.into(),
            radius: 0.25,
        };
        // Facing +y: 4 m to the left, and 2 m ahead coming nearer, too fast.
        let movers = [mover([-4.0, 0.0], [0.0, 0.75]), mover([0.0, 2.0], [0.0, -3.0])];
        let sensed = Sensed {
            vehicle: &vehicle,
            scan: &[5.0],
            beam_angles: lidar.beam_angles(),
            max_range: 5.0,
            pose: Pose::rotation(std::f64::consts::FRAC_PI_2),
            twist: Twist::zeros(),
            goal: Point::new(1.0, 5.0), // on the right: all is mirrored
            route: None,
            last_command: Command::default(),
            movers: &movers,
        };
        let mut obs = vec![0.0; encoder.obs_dim()];
        assert_eq!(encoder.encode(&sensed, &encoder.history(), &mut obs), Side::Mirrored);
        let near = [0.25, 1.0, 0.0, -1.0, 0.0];
        let far = [0.125, 0.0, -1.0, 0.5, 0.0];
        assert_close(&obs[7..], &[near, far, [0.0; 5]].concat());
    }
}
