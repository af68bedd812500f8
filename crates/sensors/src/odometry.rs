//! What a vehicle believes about its own motion.

use headway_sim::check::non_negative;
use headway_sim::{FieldError, Pose, Twist};
use nalgebra::Vector2;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// Odometry as data: standard deviations, of which each may be 0. With all of them 0 it is exact.
///
/// What is drawn once an episode (bias) makes the estimate drift steadily, what is drawn every control period (noise) makes it
/// wander. The estimate starts at the true pose.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OdometrySpec {
    /// Of the error of scale of distances and speeds, a fraction, once an episode: wheels of another radius.
    pub distance_bias: f64,
    /// Of the error of scale of turns and yaw rates, a fraction, once an episode: wheels of another distance.
    pub turn_bias: f64,
    /// Of the constant error of the yaw rate, rad/s, once an episode: a gyroscope's bias.
    pub yaw_rate_bias: f64,
    /// Of the error of scale of each period's distance and speed, a fraction: slip.
    pub distance_noise: f64,
    /// Of each period's error of the heading, radians per square root of a second: a gyroscope's angular random walk.
    pub yaw_walk: f64,
}

impl OdometrySpec {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the field, its value and what is allowed.
    pub fn check(&self) -> Result<(), FieldError> {
        non_negative("distance_bias", self.distance_bias)?;
        non_negative("turn_bias", self.turn_bias)?;
        non_negative("yaw_rate_bias", self.yaw_rate_bias)?;
        non_negative("distance_noise", self.distance_noise)?;
        non_negative("yaw_walk", self.yaw_walk)
    }

    fn is_exact(&self) -> bool {
        *self == Self::default()
    }
}

/// The estimate of an episode.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Odometry {
    spec: OdometrySpec,
    /// Scale of distances, scale of turns, and constant yaw rate of this episode.
    biases: [f64; 3],
    pose: Pose,
    twist: Twist,
}

impl Odometry {
    /// The estimate of a vehicle that stands at `pose`, with biases drawn for the episode. An exact one draws nothing.
    ///
    /// The spec must have passed [`OdometrySpec::check`].
    ///
    /// ```
    /// use headway_sensors::{Odometry, OdometrySpec};
    /// use headway_sim::{Pose, Twist, stream};
    /// let spec = OdometrySpec { distance_bias: 0.1, ..OdometrySpec::default() };
    /// let mut rng = stream(0, "odometry", 0);
    /// let mut odometry = Odometry::new(&spec, Pose::identity(), &mut rng);
    /// // 10 m straight ahead are believed to be some 10 % more or less.
    /// odometry.advance(&Pose::identity(), &Pose::translation(10.0, 0.0), Twist::new(1.0, 0.0, 0.0), 10.0, &mut rng);
    /// let error = odometry.pose().translation.x - 10.0;
    /// assert!(error != 0.0 && error.abs() < 5.0);
    /// assert!((odometry.twist().x - odometry.pose().translation.x / 10.0).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn new(spec: &OdometrySpec, pose: Pose, rng: &mut impl RngExt) -> Self {
        // All or none, so that one error does not change the others.
        let mut drawn = |deviation: f64| if spec.is_exact() { 0.0 } else { deviation * normal(rng) };
        let biases = [1.0 + drawn(spec.distance_bias), 1.0 + drawn(spec.turn_bias), drawn(spec.yaw_rate_bias)];
        Self { spec: *spec, biases, pose, twist: Twist::zeros() }
    }

    /// Takes in a control period of `dt` seconds in which the vehicle moved from one true pose to another, and at whose end
    /// it has a true velocity.
    pub fn advance(&mut self, from: &Pose, to: &Pose, twist: Twist, dt: f64, rng: &mut impl RngExt) {
        if self.spec.is_exact() {
            (self.pose, self.twist) = (*to, twist);
            return;
        }
        let slip = 1.0 + self.spec.distance_noise * normal(rng);
        let walk = self.spec.yaw_walk * dt.sqrt() * normal(rng);
        let [distance_scale, turn_scale, yaw_rate_bias] = self.biases;
        let scale = distance_scale * slip;
        let moved = from.inv_mul(to);
        let turned = moved.rotation.angle() * turn_scale + yaw_rate_bias * dt + walk;
        let step: Vector2<f64> = moved.translation.vector * scale;
        self.pose *= Pose::new(step, turned);
        self.twist = Twist::new(twist.x * scale, twist.y * scale, twist.z * turn_scale + yaw_rate_bias);
    }

    /// Where the vehicle believes it is.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// How it believes it moves, in the body frame.
    #[must_use]
    pub fn twist(&self) -> Twist {
        self.twist
    }
}

fn normal(rng: &mut impl RngExt) -> f64 {
    StandardNormal.sample(rng)
}

#[cfg(test)]
mod tests {
    use super::*;
    use headway_sim::{glide, stream};

    /// The estimate after `n` periods of 0.1 s at a velocity.
    fn estimate(spec: &OdometrySpec, twist: Twist, n: usize, seed: u64) -> (Odometry, Pose) {
        let mut rng = stream(seed, "odometry", 0);
        let mut pose = Pose::new([1.0, 2.0].into(), 0.5);
        let mut odometry = Odometry::new(spec, pose, &mut rng);
        for _ in 0..n {
            let next = glide(&pose, &twist, 0.1);
            odometry.advance(&pose, &next, twist, 0.1, &mut rng);
            pose = next;
        }
        (odometry, pose)
    }

    #[test]
    fn without_errors_it_is_exact_and_draws_nothing() {
        let twist = Twist::new(1.0, 0.2, 0.7);
        let (odometry, pose) = estimate(&OdometrySpec::default(), twist, 50, 0);
        assert_eq!((odometry.pose(), odometry.twist()), (pose, twist));
        let mut rng = stream(0, "odometry", 0);
        let untouched = rng.clone();
        let _ = Odometry::new(&OdometrySpec::default(), pose, &mut rng);
        assert_eq!(rng, untouched);
    }

    #[test]
    fn a_bias_of_the_yaw_rate_bends_a_straight_way_into_a_circle() {
        let spec = OdometrySpec { yaw_rate_bias: 0.1, ..OdometrySpec::default() };
        let (odometry, _) = estimate(&spec, Twist::new(1.0, 0.0, 0.0), 100, 3);
        let bias = odometry.twist().z;
        assert!(bias != 0.0);
        // As if it had turned after each period of a straight line: a polygon around that circle.
        let turned = (odometry.pose().rotation.angle() - 0.5 - 10.0 * bias).rem_euclid(std::f64::consts::TAU);
        assert!(turned.min(std::f64::consts::TAU - turned) < 1e-9);
    }

    #[test]
    fn errors_have_their_sizes() {
        let deviation = |spec: OdometrySpec, twist, n, error: fn(&Odometry, &Pose) -> f64| {
            let squares = (0..2000).map(|seed| {
                let (odometry, pose) = estimate(&spec, twist, n, seed);
                error(&odometry, &pose).powi(2)
            });
            (squares.sum::<f64>() / 2000.0).sqrt()
        };
        let ahead = Twist::new(1.0, 0.0, 0.0);
        let away =
            |odometry: &Odometry, pose: &Pose| (odometry.pose().translation.vector - pose.translation.vector).norm();
        let turned = |odometry: &Odometry, pose: &Pose| pose.rotation.angle_to(&odometry.pose().rotation);
        // 10 m with 2 % of bias; 100 periods of 0.1 m with 10 % of slip; 10 s of walk; 2 rad with 5 %.
        let cases = [
            (
                OdometrySpec { distance_bias: 0.02, ..Default::default() },
                ahead,
                away as fn(&Odometry, &Pose) -> f64,
                0.2,
            ),
            (OdometrySpec { distance_noise: 0.1, ..Default::default() }, ahead, away, 0.1),
            (OdometrySpec { yaw_walk: 0.01, ..Default::default() }, ahead, turned, 0.01 * 10.0_f64.sqrt()),
            (OdometrySpec { turn_bias: 0.05, ..Default::default() }, Twist::new(0.0, 0.0, 0.2), turned, 0.1),
        ];
        for (spec, twist, error, expected) in cases {
            let found = deviation(spec, twist, 100, error);
            assert!((found / expected - 1.0).abs() < 0.06, "{spec:?}: {found} but {expected}");
        }
    }

    #[test]
    fn refusals_name_the_field() {
        let spec = OdometrySpec { yaw_walk: -1.0, ..OdometrySpec::default() };
        assert_eq!(spec.check().unwrap_err().to_string(), "yaw_walk = -1: must be a finite number, 0 or above");
    }
}
