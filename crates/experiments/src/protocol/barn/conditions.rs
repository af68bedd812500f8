//! What an evaluation was made under.

use std::collections::BTreeMap;

use headway_env::{NavSpec, RandomizeSpec, RouteSource};
use headway_planning::ShieldSpec;
use headway_sensors::{LidarSpec, OdometrySpec};
use headway_sim::{VehiclePreset, VehicleSpec};
use serde::Serialize;
use toml::Value;

use super::{Plan, is_random};
use crate::candidate::{Candidate, Identity};
use crate::difference::changes;

/// All that the figures of a report rest on, beside the worlds and the protocol itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Conditions {
    /// Who drove.
    pub driver: Identity,
    /// The shield around it.
    pub shield: Option<ShieldSpec>,
    /// In what.
    pub vehicle: Vehicle,
    /// What it sensed with.
    pub lidar: LidarSpec,
    /// How it knew its own motion.
    pub odometry: OdometrySpec,
    /// Which of these numbers each run drew anew.
    pub randomize: RandomizeSpec,
    /// Where the route came from that it was shown.
    pub route: RouteSource,
    /// Runs in each world.
    pub runs: usize,
    /// The seed of all that was random; it makes no difference where nothing was.
    pub seed: u64,
    /// Whether nothing was random: all runs of a world would be the same.
    #[serde(skip)]
    pub deterministic: bool,
}

/// A vehicle, and how it differs from the preset that it is nearest to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Vehicle {
    /// The preset of this outline and this drive with the fewest other numbers, if there is one.
    pub preset: Option<&'static str>,
    /// Its numbers where they are not the preset's, by dotted paths.
    pub changed: BTreeMap<String, Option<Value>>,
    /// All its numbers.
    #[serde(flatten)]
    pub spec: VehicleSpec,
}

impl Conditions {
    /// Those of a candidate, of the rules that it drives by, and of a plan.
    #[must_use]
    pub fn new(candidate: &Candidate, rules: &NavSpec, plan: &Plan) -> Self {
        Self {
            driver: candidate.identity(),
            shield: candidate.shield(),
            vehicle: Vehicle::of(&rules.vehicle),
            lidar: rules.lidar.clone(),
            odometry: rules.odometry,
            randomize: rules.randomize.clone(),
            route: rules.env.route.clone(),
            runs: plan.n_runs.get(),
            seed: plan.seed,
            deterministic: !is_random(rules),
        }
    }
}

impl Vehicle {
    /// A vehicle with the preset that it is nearest to.
    ///
    /// ```
    /// use headway_experiments::protocol::barn::Vehicle;
    /// use headway_sim::{VehiclePreset, VehicleSpec};
    /// let vehicle = Vehicle::of(&VehicleSpec { max_speed: 1.0, ..VehiclePreset::Jackal.spec() });
    /// assert_eq!(vehicle.preset, Some("jackal"));
    /// assert_eq!(vehicle.changed.into_iter().collect::<Vec<_>>(), [("max_speed".to_owned(), Some(1.0.into()))]);
    /// ```
    #[must_use]
    pub fn of(spec: &VehicleSpec) -> Self {
        let tree = |spec: &VehicleSpec| Value::try_from(spec).expect("numbers and names have a TOML form");
        let alike = VehiclePreset::ALL.into_iter().filter_map(|(name, preset)| {
            let preset = preset.spec();
            let is_alike = preset.footprint == spec.footprint && preset.drive == spec.drive;
            is_alike.then(|| (name, changes(&tree(&preset), &tree(spec))))
        });
        let nearest = alike.min_by_key(|(_, changed)| changed.len());
        let (preset, changed) = nearest.map_or((None, BTreeMap::new()), |(name, changed)| (Some(name), changed));
        Self { preset, changed, spec: spec.clone() }
    }
}
