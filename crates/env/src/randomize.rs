//! Numbers that differ from episode to episode.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use headway_sensors::{LidarSpec, OdometrySpec};
use headway_sim::{FieldError, VehicleSpec, stream};
use rand::RngExt;
use rand_distr::{Distribution as _, StandardNormal};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::NavSpec;
use crate::robot::Robot;

/// What each episode draws anew: the table `[randomize]`, from the dotted path of a number to its distribution.
///
/// Numbers of `vehicle`, `lidar` and `odometry` can be drawn, but for those that drivers are built by: the outline, the control
/// period, the number and directions of beams. Drivers, observations and rewards know the numbers of the spec, not those drawn.
///
/// ```
/// use headway_env::{NavSpec, RandomizeSpec};
/// let randomize: RandomizeSpec = toml::from_str("'vehicle.actuation.latency' = { uniform = [0.0, 0.2] }")?;
/// assert!(NavSpec { randomize, ..NavSpec::default() }.build().is_ok());
/// let misspelt: RandomizeSpec = toml::from_str("'vehicle.max_sped' = { uniform = [1.0, 2.0] }")?;
/// let error = NavSpec { randomize: misspelt, ..NavSpec::default() }.build().unwrap_err();
/// assert!(error.to_string().starts_with("randomize.\"vehicle.max_sped\" = uniform from 1 to 2: must be the path of a number"));
/// # Ok::<(), toml::de::Error>(())
/// ```
pub type RandomizeSpec = BTreeMap<String, Distribution>;

/// How a number is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Distribution {
    /// Uniform between two ends, the lower one first.
    Uniform([f64; 2]),
    /// Normal with a mean and a standard deviation, drawn again where it lies more than three deviations off.
    Normal([f64; 2]),
    /// One of these, each as likely.
    Choice(Vec<f64>),
}

impl std::fmt::Display for Distribution {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Uniform([low, high]) => write!(f, "uniform from {low} to {high}"),
            Self::Normal([mean, deviation]) => write!(f, "normal around {mean}, deviation {deviation}"),
            Self::Choice(numbers) => write!(f, "one of {numbers:?}"),
        }
    }
}

impl Distribution {
    /// The numbers that it lies between, or all that it can be.
    fn extremes(&self) -> Vec<f64> {
        match self {
            Self::Uniform(ends) => ends.to_vec(),
            Self::Normal([mean, deviation]) => vec![mean - 3.0 * deviation, mean + 3.0 * deviation],
            Self::Choice(numbers) => numbers.clone(),
        }
    }

    /// The least and the greatest number that it draws, before they are rounded where only whole numbers are meant.
    ///
    /// ```
    /// use headway_env::Distribution;
    /// assert_eq!(Distribution::Uniform([0.1, 0.3]).bounds(), 0.1..=0.3);
    /// assert_eq!(Distribution::Normal([0.5, 0.125]).bounds(), 0.125..=0.875);
    /// assert_eq!(Distribution::Choice(vec![3.0, 4.0, 2.0]).bounds(), 2.0..=4.0);
    /// ```
    #[must_use]
    pub fn bounds(&self) -> RangeInclusive<f64> {
        let extremes = self.extremes();
        let least = extremes.iter().copied().fold(f64::INFINITY, f64::min);
        least..=extremes.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    fn is_sound(&self) -> bool {
        let extremes = self.extremes();
        let is_ordered = matches!(self, Self::Choice(_)) || extremes[0] <= extremes[1];
        !extremes.is_empty() && is_ordered && extremes.iter().all(|number| number.is_finite())
    }

    fn sample(&self, rng: &mut impl RngExt) -> f64 {
        match self {
            Self::Uniform([low, high]) => rng.random_range(*low..=*high),
            Self::Normal([mean, deviation]) => loop {
                let x: f64 = StandardNormal.sample(rng);
                if x.abs() <= 3.0 {
                    return mean + deviation * x;
                }
            },
            Self::Choice(numbers) => numbers[rng.random_range(0..numbers.len())],
        }
    }
}

/// The tables whose numbers can be drawn.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Tables {
    vehicle: VehicleSpec,
    lidar: LidarSpec,
    odometry: OdometrySpec,
}

/// The checked table.
#[derive(Debug, Clone)]
pub(crate) struct Randomizer {
    /// JSON pointers and distributions.
    draws: Vec<(String, Distribution)>,
    tables: Value,
}

impl Randomizer {
    /// What drivers are built by.
    const FIXED: [&'static str; 5] =
        ["/vehicle/footprint", "/vehicle/control_period", "/lidar/n_beams", "/lidar/field_of_view", "/lidar/max_range"];

    /// # Errors
    /// Names the path and says whether it is none, cannot be drawn, or may be drawn beyond what is allowed.
    pub(crate) fn new(spec: &NavSpec) -> Result<Self, FieldError> {
        let NavSpec { vehicle, lidar, odometry, .. } = spec.clone();
        let tables = serde_json::to_value(Tables { vehicle, lidar, odometry }).unwrap_or_default();
        let mut randomizer = Self { draws: Vec::new(), tables };
        for (path, distribution) in &spec.randomize {
            let pointer = format!("/{}", path.replace('.', "/"));
            let field = format!("randomize.\"{path}\"");
            let refuse = |allowed: &str| Err(FieldError::new(&field, distribution, allowed));
            if Self::FIXED.iter().any(|fixed| pointer.starts_with(fixed)) {
                return refuse("of another number: drivers are built by this one");
            }
            if !randomizer.tables.pointer(&pointer).is_some_and(Value::is_number) {
                return refuse("the path of a number of vehicle, lidar or odometry");
            }
            if !distribution.is_sound() {
                return refuse("made of finite numbers, the lower one first");
            }
            for extreme in distribution.extremes() {
                randomizer.robot(&[(pointer.clone(), extreme)]).map_err(|error| {
                    FieldError::new(&field, distribution, format!("within what is allowed: {error}"))
                })?;
            }
            randomizer.draws.push((pointer, distribution.clone()));
        }
        Ok(randomizer)
    }

    pub(crate) fn is_idle(&self) -> bool {
        self.draws.is_empty()
    }

    /// The dotted paths that are drawn, in the order of [`Self::draw`].
    pub(crate) fn paths(&self) -> impl Iterator<Item = String> {
        self.draws.iter().map(|(pointer, _)| pointer.trim_start_matches('/').replace('/', "."))
    }

    /// The numbers of scenario number `index` of a seed.
    pub(crate) fn draw(&self, seed: u64, index: u64) -> Vec<f64> {
        let mut rng = stream(seed, "randomize", index);
        let is_whole = |pointer: &str| self.tables.pointer(pointer).is_some_and(Value::is_u64);
        let draw = |(pointer, distribution): &(String, Distribution)| {
            let number = distribution.sample(&mut rng);
            if is_whole(pointer) { number.round() } else { number }
        };
        self.draws.iter().map(draw).collect()
    }

    /// What drives with numbers that were drawn.
    ///
    /// # Errors
    /// If numbers that are each allowed are not allowed together.
    pub(crate) fn build(&self, drawn: &[f64]) -> Result<Robot, FieldError> {
        let numbers: Vec<_> =
            self.draws.iter().zip(drawn).map(|((pointer, _), number)| (pointer.clone(), *number)).collect();
        self.robot(&numbers)
    }

    fn robot(&self, numbers: &[(String, f64)]) -> Result<Robot, FieldError> {
        let mut tables = self.tables.clone();
        for (pointer, number) in numbers {
            if let Some(place) = tables.pointer_mut(pointer) {
                *place = if place.is_u64() { Value::from(number.max(0.0) as u64) } else { Value::from(*number) };
            }
        }
        let Tables { vehicle, lidar, odometry } =
            serde_json::from_value(tables).map_err(|error| FieldError::new("randomize", error, "numbers"))?;
        Robot::build(&vehicle, &lidar, &odometry)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn randomizer(entries: &[(&str, Distribution)]) -> Result<Randomizer, FieldError> {
        let randomize = entries.iter().map(|(path, distribution)| ((*path).to_owned(), distribution.clone())).collect();
        Randomizer::new(&NavSpec { randomize, ..NavSpec::default() })
    }

    #[test]
    fn episodes_drive_with_what_they_drew() {
        let randomizer = randomizer(&[
            ("vehicle.max_acceleration", Distribution::Uniform([1.0, 3.0])),
            ("vehicle.n_substeps", Distribution::Uniform([1.6, 8.4])),
            ("lidar.noise", Distribution::Normal([0.05, 0.01])),
        ])
        .unwrap();
        let paths: Vec<String> = randomizer.paths().collect();
        assert_eq!(paths, ["lidar.noise", "vehicle.max_acceleration", "vehicle.n_substeps"]);
        for index in 0..100 {
            let drawn = randomizer.draw(7, index);
            assert_eq!(drawn, randomizer.draw(7, index));
            let robot = randomizer.build(&drawn).unwrap();
            let found = (robot.lidar.spec().noise, robot.vehicle.spec().max_acceleration);
            assert_eq!(found, (drawn[0], drawn[1]));
            assert!((0.02..=0.08).contains(&drawn[0]) && (1.0..=3.0).contains(&drawn[1]));
            assert_eq!(robot.vehicle.spec().n_substeps as f64, drawn[2]);
            assert_eq!(robot.vehicle.spec().max_speed, NavSpec::default().vehicle.max_speed);
        }
    }

    #[test]
    fn refusals_name_path_and_reason() {
        let uniform = |low, high| Distribution::Uniform([low, high]);
        for (path, distribution, message) in [
            ("world.width", uniform(1.0, 2.0), "must be the path of a number of vehicle, lidar or odometry"),
            ("vehicle", uniform(1.0, 2.0), "must be the path of a number"),
            ("lidar.n_beams", uniform(36.0, 72.0), "must be of another number: drivers are built by this one"),
            ("vehicle.footprint.radius", uniform(0.1, 0.2), "must be of another number"),
            ("lidar.noise", uniform(0.2, 0.1), "must be made of finite numbers, the lower one first"),
            ("lidar.noise", Distribution::Choice(vec![]), "must be made of finite numbers"),
            ("lidar.noise", Distribution::Normal([0.0, f64::NAN]), "must be made of finite numbers"),
            ("lidar.dropout", uniform(0.5, 1.5), "within what is allowed: lidar.dropout = 1.5: must be from 0 to 1"),
        ] {
            let error = randomizer(&[(path, distribution)]).unwrap_err().to_string();
            assert!(error.starts_with(&format!("randomize.\"{path}\" = ")) && error.contains(message), "{error}");
        }
    }
}
