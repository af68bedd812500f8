//! A policy that drives.

use std::sync::Arc;

use headway_env::{ActionSet, Control, Encoder};
use headway_planning::{Controller, Route, Sensed};
use headway_sim::{Command, Point};

use crate::mlp::argmax;
use crate::{Policy, PolicyError};

/// A policy as a [`Controller`]: takes the action of greatest value.
#[derive(Debug, Clone)]
pub struct Driver {
    policy: Arc<Policy>,
    encoder: Encoder,
    actions: ActionSet,
    obs: Vec<f32>,
    buffers: [Vec<f32>; 2],
}

impl Driver {
    /// A driver for the robot that the policy was trained on; see [`Policy::check`] for another one.
    ///
    /// # Errors
    /// If the policy's header is not allowed.
    pub fn new(policy: Arc<Policy>) -> Result<Self, PolicyError> {
        let (encoder, actions) = policy.header().build()?;
        let obs = vec![0.0; encoder.obs_dim()];
        Ok(Self { policy, encoder, actions, obs, buffers: Default::default() })
    }

    /// The action of greatest value for an observation, the first of several.
    #[must_use]
    pub fn act(&mut self, obs: &[f32]) -> u32 {
        argmax(self.policy.values(obs, &mut self.buffers))
    }
}

impl Controller for Driver {
    fn reset(&mut self) {}

    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        let mut obs = std::mem::take(&mut self.obs);
        let side = self.encoder.encode(sensed, &mut obs);
        let action = self.act(&obs);
        self.obs = obs;
        let mut command = self.actions.command(action, sensed.twist.x, side);
        if let Control::SpeedOnly(spec) = &self.policy.header().control {
            let here = Point::from(sensed.pose.translation.vector);
            let straight = || Route::new(vec![here, sensed.goal]);
            let owned = if sensed.route.is_none() { Some(straight()) } else { None };
            if let Some(route) = sensed.route.or(owned.as_ref()) {
                command.yaw_rate = spec.pursuit.yaw_rate(route, &sensed.pose, command.speed);
            }
        }
        command
    }
}
