//! A policy that drives.

use std::sync::Arc;

use headway_env::{ActionSet, Control, Encoder};
use headway_planning::{Controller, Sensed};
use headway_sim::Command;

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
        let command = self.actions.command(action, sensed.twist.x, side);
        match &self.policy.header().control {
            Control::Full {} => command,
            Control::SpeedOnly(spec) => spec.pursuit.follow(&sensed.route_or_straight(), &sensed.pose, command.speed),
        }
    }
}
