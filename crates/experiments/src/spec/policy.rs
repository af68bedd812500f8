//! Who drives: a policy to be trained, one from a file, or a classical driver; and a shield around it.

use std::path::PathBuf;

use headway_env::RandomizeSpec;
use headway_planning::{DriverSpec, DwaSpec, PurePursuit, RegulatedPursuitSpec, ShieldSpec, VfhSpec};
use headway_sim::{Interval, VehicleSpec};
use serde::{Deserialize, Serialize};

/// Who a run is about: the table `[policy]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
#[allow(clippy::large_enum_variant, reason = "there are few specs, and a box would be in everybody's way")]
pub enum PolicySpec {
    /// A policy that the run trains.
    Learned {},
    /// A policy that was trained before: nothing is trained, and seeds make no difference.
    File {
        /// Its file, from the working directory.
        path: PathBuf,
    },
    /// As [`DriverSpec::Dwa`]; nothing is trained.
    Dwa(DwaSpec),
    /// As [`DriverSpec::PurePursuit`]; nothing is trained.
    PurePursuit(RegulatedPursuitSpec),
    /// As [`DriverSpec::PlainPursuit`]; nothing is trained.
    PlainPursuit(PurePursuit),
    /// As [`DriverSpec::Vfh`]; nothing is trained.
    Vfh(VfhSpec),
}

impl Default for PolicySpec {
    fn default() -> Self {
        Self::Learned {}
    }
}

impl PolicySpec {
    /// Whether the run trains it.
    #[must_use]
    pub fn is_learned(&self) -> bool {
        *self == Self::Learned {}
    }

    /// The classical driver, if it is one.
    ///
    /// ```
    /// use headway_experiments::spec::PolicySpec;
    /// use headway_planning::DriverSpec;
    /// for name in DriverSpec::TYPES {
    ///     let policy: PolicySpec = toml::from_str(&format!("type = {name:?}"))?;
    ///     assert_eq!(policy.driver(), DriverSpec::named(name));
    /// }
    /// # Ok::<(), toml::de::Error>(())
    /// ```
    #[must_use]
    pub fn driver(&self) -> Option<DriverSpec> {
        match self {
            Self::Learned {} | Self::File { .. } => None,
            Self::Dwa(spec) => Some(DriverSpec::Dwa(spec.clone())),
            Self::PurePursuit(spec) => Some(DriverSpec::PurePursuit(*spec)),
            Self::PlainPursuit(spec) => Some(DriverSpec::PlainPursuit(*spec)),
            Self::Vfh(spec) => Some(DriverSpec::Vfh(*spec)),
        }
    }
}

/// A shield around whoever is evaluated: a [`ShieldSpec`] whose latency may be left to the vehicle.
///
/// It foresees the vehicle of the spec; of the numbers that episodes draw it allows for the latency alone, and `confidence`
/// and `noise` must make up for the others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ShieldOption {
    /// See [`ShieldSpec::margin`].
    pub margin: f64,
    /// See [`ShieldSpec::confidence`].
    pub confidence: f64,
    /// See [`ShieldSpec::noise`].
    pub noise: f64,
    /// See [`ShieldSpec::latency`]; if not given the vehicle's own, or the range of what an episode may draw.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latency: Option<Interval>,
}

impl Default for ShieldOption {
    fn default() -> Self {
        let ShieldSpec { margin, confidence, noise, latency: _ } = ShieldSpec::default();
        Self { margin, confidence, noise, latency: None }
    }
}

impl ShieldOption {
    /// The shield around a driver of this vehicle, of whose numbers `randomize` draws some.
    ///
    /// ```
    /// use headway_env::RandomizeSpec;
    /// use headway_experiments::spec::ShieldOption;
    /// use headway_sim::Interval;
    /// let mut vehicle = headway_sim::VehicleSpec::default();
    /// vehicle.actuation.latency = 0.1;
    /// let shield = ShieldOption::default();
    /// assert_eq!(shield.for_vehicle(&vehicle, &RandomizeSpec::default()).latency, Interval::Fixed(0.1));
    /// let randomize: RandomizeSpec = toml::from_str("'vehicle.actuation.latency' = { uniform = [0.0, 0.2] }")?;
    /// assert_eq!(shield.for_vehicle(&vehicle, &randomize).latency, Interval::Range([0.0, 0.2]));
    /// # Ok::<(), toml::de::Error>(())
    /// ```
    #[must_use]
    pub fn for_vehicle(&self, vehicle: &VehicleSpec, randomize: &RandomizeSpec) -> ShieldSpec {
        let Self { margin, confidence, noise, latency } = *self;
        let drawn = randomize.get("vehicle.actuation.latency").map(|drawn| {
            let (least, greatest) = drawn.bounds().into_inner();
            Interval::Range([least, greatest])
        });
        let latency = latency.or(drawn).unwrap_or(Interval::Fixed(vehicle.actuation.latency));
        ShieldSpec { margin, confidence, noise, latency }
    }
}
