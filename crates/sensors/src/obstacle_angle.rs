//! The obstacle angle: Fig. 1 of Liu et al., defined here and nowhere else.

use std::f64::consts::PI;

use headway_sim::check::positive;
use headway_sim::{FieldError, Outline, Point, Pose, Proximity, Surface, Twist, World, wrap};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::Lidar;

/// Which obstacles have an angle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ObstacleAngleSpec {
    /// Only obstacles whose clearance is at most this count, metres.
    pub radius: f64,
    /// Whether walls count as obstacles.
    pub include_walls: bool,
}

impl Default for ObstacleAngleSpec {
    fn default() -> Self {
        Self { radius: 3.0, include_walls: false }
    }
}

impl ObstacleAngleSpec {
    /// Checks the radius.
    ///
    /// # Errors
    /// If it is not a finite number above 0.
    pub fn build(&self) -> Result<ObstacleAngle, FieldError> {
        positive("radius", self.radius)?;
        Ok(ObstacleAngle { spec: *self })
    }
}

/// The checked definition of the obstacle angle.
#[derive(Debug, Clone)]
pub struct ObstacleAngle {
    spec: ObstacleAngleSpec,
}

impl ObstacleAngle {
    /// Ranges of neighbouring beams that differ by this much belong to different things, metres.
    pub const SCAN_GAP: f32 = 0.5;

    /// The angle between the direction of motion and the nearer edge of the nearest obstacle, radians.
    ///
    /// Unsigned, in [0, pi], seen from the footprint's origin. The nearest obstacle is the one with the
    /// least clearance (`proximity`) within the radius, from true geometry, whether or not it is hidden
    /// behind another; walls count only if the spec says so. An edge is an end of the interval of bearings
    /// that the obstacle covers. 0 where the direction of motion points into it, `None` where there is no
    /// obstacle. Liu et al. call `angle <= 30 deg` in front.
    ///
    /// ```
    /// use headway_sensors::ObstacleAngleSpec;
    /// use headway_sim::{Footprint, Obstacle, Pose, Room, Shape, Twist, World};
    /// let disc = |radius| Shape::Disc { radius };
    /// // A disc of radius 1 m, 2 m to the left: its edges are 30 degrees off its centre.
    /// let obstacle = Obstacle { shape: disc(1.0), x: 5.0, y: 7.0, yaw: 0.0 };
    /// let world = World::new(Room::new(10.0, 15.0), vec![obstacle])?;
    /// let pose = Pose::translation(5.0, 5.0);
    /// let proximity = world.proximity(&Footprint::new(&disc(0.25))?, &pose);
    /// let angle = ObstacleAngleSpec::default().build()?.measure(&world, &pose, &Twist::zeros(), &proximity);
    /// assert!((angle.unwrap() - 60_f64.to_radians()).abs() < 1e-12);
    /// # Ok::<(), headway_sim::SimError>(())
    /// ```
    #[must_use]
    pub fn measure(&self, world: &World, pose: &Pose, twist: &Twist, proximity: &Proximity) -> Option<f64> {
        let surface = self.nearest(proximity)?;
        let in_frame = |point: &Point| pose.inverse_transform_point(point).coords;
        Some(angle_between(direction_of_motion(twist), bearings(&world.outline(surface), in_frame)))
    }

    /// The obstacle angle as a vehicle can tell it from a scan alone, radians.
    ///
    /// The nearest return is the one with the least clearance: its range less the footprint's `extents`
    /// towards it (metres, one per beam). The obstacle is that beam and its neighbours to both sides for as
    /// long as the ranges of neighbours differ by less than [`Self::SCAN_GAP`]; its edges are its outermost
    /// beams. `None` if nothing is seen within the radius. Walls cannot be told from obstacles in a scan,
    /// so they count. `direction` is the direction of motion in the vehicle's frame.
    ///
    /// # Panics
    /// If `scan` and `extents` do not hold one number per beam.
    ///
    /// ```
    /// use headway_sensors::{LidarSpec, ObstacleAngleSpec};
    /// // Five beams from right to left; something stands 1 m off, 45 to 90 degrees to the left.
    /// let view = LidarSpec { n_beams: 5, field_of_view: std::f64::consts::PI, ..LidarSpec::default() };
    /// let scan = [5.0, 5.0, 5.0, 1.0, 1.1];
    /// let angle = ObstacleAngleSpec::default().build()?.from_scan(&view.build()?, &scan, &[0.25; 5], 0.0);
    /// assert!((angle.unwrap() - 45_f64.to_radians()).abs() < 1e-12);
    /// # Ok::<(), headway_sim::FieldError>(())
    /// ```
    #[must_use]
    pub fn from_scan(&self, lidar: &Lidar, scan: &[f32], extents: &[f32], direction: f64) -> Option<f64> {
        let angles = lidar.beam_angles();
        let n = angles.len();
        assert!(scan.len() == n && extents.len() == n, "one entry per beam");
        let clearance = |k: usize| scan[k] - extents[k];
        let nearest = (0..n).min_by(|a, b| clearance(*a).total_cmp(&clearance(*b)))?;
        let max_range = lidar.spec().max_range as f32;
        if scan[nearest] >= max_range || f64::from(clearance(nearest)) > self.spec.radius {
            return None;
        }
        let spacing = if n > 1 { angles[1] - angles[0] } else { 0.0 };
        let [left, right] = [1, -1].map(|step| n_connected(scan, nearest, step, lidar) as f64 * spacing);
        let middle = angles[nearest] + (left - right) / 2.0;
        Some(angle_between(direction, (middle, (left + right) / 2.0)))
    }

    fn nearest(&self, proximity: &Proximity) -> Option<Surface> {
        let obstacle = proximity.obstacle.map(|(index, clearance)| (Surface::Obstacle(index), clearance));
        let wall = (Surface::Wall(proximity.wall.0), proximity.wall.1);
        let wall = self.spec.include_walls.then_some(wall);
        let nearest = obstacle.into_iter().chain(wall).min_by(|a, b| a.1.total_cmp(&b.1))?;
        (nearest.1 <= self.spec.radius).then_some(nearest.0)
    }
}

/// The direction of motion in the vehicle's frame, radians: where the velocity points; straight ahead at rest, that is below
/// 1 mm/s, where the direction of a measured velocity means nothing.
#[must_use]
pub fn direction_of_motion(twist: &Twist) -> f64 {
    match (twist.x, twist.y) {
        (x, 0.0) if x >= 0.0 => 0.0, // as most often
        (x, y) if x.hypot(y) > 1e-3 => y.atan2(x),
        _ => 0.0,
    }
}

/// The unsigned angle from a direction to the nearer end of an interval of directions given as its middle
/// and half-width, 0 within it, radians.
fn angle_between(direction: f64, (middle, half_width): (f64, f64)) -> f64 {
    (wrap(direction - middle).abs() - half_width).max(0.0)
}

/// The interval of directions that an outline covers as seen from the origin of a frame, into which `in_frame` takes
/// points: its middle and its half-width. From within, all directions.
fn bearings(outline: &Outline<'_>, in_frame: impl Fn(&Point) -> Vector2<f64>) -> (f64, f64) {
    match outline {
        Outline::Disc { center, radius } => {
            let to = in_frame(center);
            let ratio = radius / to.norm();
            (to.y.atan2(to.x), if ratio < 1.0 { ratio.asin() } else { PI })
        }
        Outline::Polygon(corners) => corner_bearings(corners, in_frame),
        Outline::Wall(ends) => corner_bearings(ends, in_frame),
    }
}

fn corner_bearings(corners: &[Point], in_frame: impl Fn(&Point) -> Vector2<f64>) -> (f64, f64) {
    let bearing = |corner: &Point| {
        let to = in_frame(corner);
        to.y.atan2(to.x)
    };
    let first = bearing(&corners[0]);
    let (mut before, mut low, mut high, mut turned) = (first, 0.0_f64, 0.0_f64, 0.0);
    for corner in &corners[1..] {
        let here = bearing(corner);
        turned += wrap(here - before);
        low = low.min(turned);
        high = high.max(turned);
        before = here;
    }
    let closing = corners.len() > 2 && (turned + wrap(first - before)).abs() > PI;
    if closing {
        return (first, PI); // the corners go all the way round the origin
    }
    (wrap(first + (low + high) / 2.0), (high - low) / 2.0)
}

/// How many beams in a row, from `start` to one side (`step` is 1 or -1), see the same thing.
fn n_connected(scan: &[f32], start: usize, step: isize, lidar: &Lidar) -> usize {
    let (n, max_range) = (scan.len() as isize, lidar.spec().max_range as f32);
    let mut here = start;
    for count in 0..scan.len() - 1 {
        let next = here as isize + step;
        let wrapped = next.rem_euclid(n) as usize;
        let is_end = wrapped as isize != next && !lidar.is_full_turn();
        let sees_another = scan[wrapped] >= max_range || (scan[wrapped] - scan[here]).abs() >= ObstacleAngle::SCAN_GAP;
        if is_end || sees_another {
            return count;
        }
        here = wrapped;
    }
    scan.len() - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LidarSpec;
    use headway_sim::{Footprint, Obstacle, Room, Shape};

    fn measure(spec: ObstacleAngleSpec, obstacles: Vec<Obstacle>, pose: Pose, twist: Twist) -> Option<f64> {
        let world = World::new(Room::new(20.0, 20.0), obstacles).unwrap();
        let footprint = Footprint::new(&Shape::Disc { radius: 0.25 }).unwrap();
        let proximity = world.proximity(&footprint, &pose);
        spec.build().unwrap().measure(&world, &pose, &twist, &proximity)
    }

    fn disc(x: f64, y: f64, radius: f64) -> Obstacle {
        Obstacle { shape: Shape::Disc { radius }, x, y, yaw: 0.0 }
    }

    fn degrees(angle: Option<f64>) -> f64 {
        angle.unwrap().to_degrees()
    }

    #[test]
    fn edges_by_hand() {
        let spec = ObstacleAngleSpec::default();
        let pose = Pose::translation(10.0, 10.0);
        let ahead = vec![disc(12.0, 10.0, 0.5)];
        assert_eq!(measure(spec, ahead.clone(), pose, Twist::zeros()), Some(0.0));
        // Reversing, the same disc lies behind: 180 degrees less its half-width, asin(0.5 / 2).
        let reversing = Twist::new(-1.0, 0.0, 0.0);
        let expected = 180.0 - 0.25_f64.asin().to_degrees();
        assert!((degrees(measure(spec, ahead, pose, reversing)) - expected).abs() < 1e-9);
        // A box whose corners (11, 11) and (13, 11) are the nearer edge and the farther one: 45 degrees.
        let boxed = Obstacle { shape: Shape::Box { length: 2.0, width: 1.0 }, x: 12.0, y: 11.5, yaw: 0.0 };
        let expected = 1.0_f64.atan2(3.0).to_degrees();
        assert!((degrees(measure(spec, vec![boxed], pose, Twist::zeros())) - expected).abs() < 1e-9);
    }

    #[test]
    fn the_nearest_by_clearance_counts_and_only_within_the_radius() {
        let spec = ObstacleAngleSpec { radius: 2.0, include_walls: false };
        let pose = Pose::translation(10.0, 10.0);
        // The large disc's centre is farther, its surface nearer.
        let obstacles = vec![disc(10.0, 12.0, 0.2), disc(13.0, 10.0, 2.0)];
        assert_eq!(measure(spec, obstacles, pose, Twist::zeros()), Some(0.0));
        let far = vec![disc(10.0, 13.0, 0.5)];
        assert_eq!(measure(spec, far, pose, Twist::zeros()), None);
    }

    #[test]
    fn walls_count_if_asked() {
        let pose = Pose::new([1.0, 10.0].into(), 0.0);
        let spec = |include_walls| ObstacleAngleSpec { radius: 2.0, include_walls };
        assert_eq!(measure(spec(false), vec![], pose, Twist::zeros()), None);
        // The wall at x = 0 covers bearings from atan2(10, -1) on: just over 90 degrees off.
        let expected = 10.0_f64.atan2(-1.0).to_degrees();
        let angle = degrees(measure(spec(true), vec![], pose, Twist::zeros()));
        assert!((angle - expected).abs() < 1e-9, "{angle} but {expected}");
    }

    #[test]
    fn what_is_out_of_range_is_no_obstacle_and_joins_none() {
        let angle = |max_range, scan: &[f32; 8]| {
            let lidar = LidarSpec { n_beams: 8, max_range, ..LidarSpec::default() }.build().unwrap();
            ObstacleAngleSpec { radius: 5.0, include_walls: false }
                .build()
                .unwrap()
                .from_scan(&lidar, scan, &[0.25; 8], 0.0)
        };
        // 3.1 as f32 is less than 3.1: an empty scan must still be empty.
        assert_eq!(angle(3.1, &[3.1; 8]), None);
        // One return behind, within a gap of the range limit: the empty beams beside it are not part of it.
        let behind = angle(3.0, &[2.8, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0]);
        assert!((behind.unwrap() - PI).abs() < 1e-12);
    }

    #[test]
    fn a_residue_of_speed_is_rest() {
        assert_eq!(direction_of_motion(&Twist::new(-1e-16, 0.0, 0.0)), 0.0);
        assert_eq!(direction_of_motion(&Twist::new(-0.1, 0.0, 0.0)), PI);
    }

    #[test]
    fn the_scan_tells_nearly_the_same_as_the_truth() {
        let lidar = LidarSpec { n_beams: 720, ..LidarSpec::default() }.build().unwrap();
        let spec = ObstacleAngleSpec::default();
        let extents = [0.25; 720];
        for k in 0..24 {
            let yaw = f64::from(k) * 0.26 - 3.0;
            let pose = Pose::new([10.0, 10.0].into(), yaw);
            let obstacles = vec![disc(11.5, 10.7, 0.4)];
            let truth = measure(spec, obstacles.clone(), pose, Twist::zeros()).unwrap();
            let world = World::new(Room::new(20.0, 20.0), obstacles).unwrap();
            let mut scan = [0.0; 720];
            lidar.scan(&world, &pose, &mut headway_sim::stream(0, "noise", 0), &mut scan);
            let seen = spec.build().unwrap().from_scan(&lidar, &scan, &extents, 0.0).unwrap();
            assert!((truth - seen).abs() < 0.02, "yaw {yaw}: {truth} but {seen}");
        }
    }
}
