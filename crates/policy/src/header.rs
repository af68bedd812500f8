//! What a policy file says beside its weights.

use std::collections::BTreeMap;

use headway_env::{ActionSet, ActionSpec, Control, Encoder, ObservationSpec, RouteSource};
use headway_sensors::LidarSpec;
use headway_sim::VehicleSpec;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::{Normalisation, PolicyError};

/// All that driving needs besides the weights.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// The vehicle it was trained on: footprint, limits, control period.
    pub vehicle: VehicleSpec,
    /// The lidar it was trained with.
    pub lidar: LidarSpec,
    /// The route that it is shown, if any.
    pub route: RouteSource,
    /// What it controls.
    pub control: Control,
    /// What its outputs mean.
    pub actions: ActionSpec,
    /// What its inputs mean.
    pub observation: ObservationSpec,
    /// By which constants its inputs are scaled.
    pub normalisation: Normalisation,
    /// Where it comes from: run, seed and the like. Not used for driving.
    pub provenance: BTreeMap<String, String>,
}

impl Header {
    /// Numbers that a simulation has and a robot has not, or that a policy need not match.
    const FREE: [&'static str; 5] =
        ["/vehicle/n_substeps", "/vehicle/actuation", "/lidar/noise", "/lidar/dropout", "/lidar/grazing_angle"];

    /// Numbers in an observation: inputs of the network.
    ///
    /// # Errors
    /// If the header is not allowed.
    pub fn obs_dim(&self) -> Result<usize, PolicyError> {
        Ok(self.build()?.0.obs_dim())
    }

    /// The encoder of observations and the meaning of actions.
    pub(crate) fn build(&self) -> Result<(Encoder, ActionSet), PolicyError> {
        self.normalisation.check().map_err(|e| e.under("normalisation"))?;
        let vehicle = self.vehicle.build().map_err(|e| e.under("vehicle"))?;
        let lidar = self.lidar.build().map_err(|e| e.under("lidar"))?;
        self.control.check().map_err(|e| e.under("control"))?;
        let encoder = Encoder::new(&self.observation, &lidar, &vehicle).map_err(|e| e.under("observation"))?;
        let actions = self.actions.build(&self.vehicle, &self.control, self.observation.mirror);
        Ok((encoder, actions.map_err(|e| e.under("actions"))?))
    }

    /// What differs between the robot of the policy and another one, in words.
    pub(crate) fn differences(&self, vehicle: &VehicleSpec, lidar: &LidarSpec) -> Vec<String> {
        let robot = |vehicle, lidar| serde_json::json!({ "vehicle": vehicle, "lidar": lidar });
        let mut differences = Vec::new();
        let (own, other) = (robot(&self.vehicle, &self.lidar), robot(vehicle, lidar));
        compare("", &own, &other, &mut differences);
        differences
    }
}

/// Adds a line for every leaf in which two values differ.
fn compare(path: &str, own: &Value, other: &Value, differences: &mut Vec<String>) {
    if own == other || Header::FREE.contains(&path) {
        return;
    }
    match (own, other) {
        (Value::Object(own), Value::Object(other)) => {
            let missing = Value::Null;
            let keys: std::collections::BTreeSet<&String> = own.keys().chain(other.keys()).collect();
            for key in keys {
                let [a, b] = [own, other].map(|map| map.get(key).unwrap_or(&missing));
                compare(&format!("{path}/{key}"), a, b, differences);
            }
        }
        _ => {
            let place = path.trim_start_matches('/').replace('/', ".");
            let words = |value: &Value| {
                if value.is_null() { "absent".to_owned() } else { value.to_string() }
            };
            differences.push(format!("{place} is {} in the policy, {} here", words(own), words(other)));
        }
    }
}
