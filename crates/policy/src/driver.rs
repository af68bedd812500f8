//! A policy that drives.

use std::sync::Arc;

use headway_env::{ActionSet, Encoder, History};
use headway_planning::{Controller, Sensed};
use headway_sensors::LidarSpec;
use headway_sim::{Command, VehicleSpec};

use crate::mlp::argmax;
use crate::{Policy, PolicyError};

/// A policy as a [`Controller`]: takes the action of greatest value.
///
/// Under [`headway_env::Control::SpeedOnly`] it steers along [`Sensed::route`], as in training; under an observation that looks ahead it is
/// shown that route. Where there is none, both take the straight line to the goal, whatever stands there: whoever drives by
/// such a policy plans the route.
///
/// [`Controller::command`] panics if a scan has another number of ranges than the lidar has beams.
#[derive(Debug, Clone)]
pub struct Driver {
    policy: Arc<Policy>,
    encoder: Encoder,
    actions: ActionSet,
    history: History,
    obs: Vec<f32>,
    buffers: [Vec<f32>; 2],
}

impl Driver {
    /// A driver for a robot: the one that the policy was trained on; see [`Policy::check`].
    ///
    /// # Errors
    /// [`PolicyError::Mismatch`] lists every number in which the robot is another one.
    pub fn new(policy: Arc<Policy>, vehicle: &VehicleSpec, lidar: &LidarSpec) -> Result<Self, PolicyError> {
        policy.check(vehicle, lidar)?;
        let (encoder, actions) = policy.header().build()?;
        let obs = vec![0.0; encoder.obs_dim()];
        let history = encoder.history();
        Ok(Self { policy, encoder, actions, history, obs, buffers: Default::default() })
    }

    /// The action of greatest value for an observation, shape `[obs_dim]`; the first of several.
    ///
    /// # Panics
    /// If the observation has another length.
    #[must_use]
    pub fn act(&mut self, obs: &[f32]) -> u32 {
        argmax(self.policy.values(obs, &mut self.buffers))
    }
}

impl Controller for Driver {
    fn reset(&mut self) {
        self.history.clear();
    }

    /// What the action of greatest value asks for.
    ///
    /// # Panics
    /// If `sensed.scan` does not hold one range per beam of the lidar that the driver was made for.
    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        let mut obs = std::mem::take(&mut self.obs);
        self.history.remember(&sensed.pose);
        let side = self.encoder.encode(sensed, &self.history, &mut obs);
        let action = self.act(&obs);
        self.obs = obs;
        let asked = self.actions.command(action, sensed.twist.x, side);
        self.policy.header().control.command(asked, sensed)
    }
}
