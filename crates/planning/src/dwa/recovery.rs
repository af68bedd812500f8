//! What to do when nothing can be done.

use std::f64::consts::TAU;

use headway_sim::wrap;

use super::DwaSpec;

/// Waiting, then forgetting what is far away and turning once around.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Recovery {
    /// Seconds without an admissible trajectory.
    waited: f64,
    /// Recoveries in a row.
    n_made: i32,
    rotation: Option<Rotation>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Rotation {
    /// Radians turned so far.
    turned: f64,
    last_yaw: Option<f64>,
}

impl Recovery {
    /// A trajectory was admissible.
    pub(super) fn succeed(&mut self) {
        *self = Self::default();
    }

    /// None was, for a control period more: the distance beyond which to forget, once patience is over.
    pub(super) fn wait(&mut self, spec: &DwaSpec, period: f64) -> Option<f64> {
        self.waited += period;
        if self.waited < spec.patience {
            return None;
        }
        let distance = spec.reset_distance * 0.5_f64.powi(self.n_made);
        (self.waited, self.n_made) = (0.0, self.n_made.saturating_add(1));
        self.rotation = spec.clearing_rotation.then(Rotation::default);
        Some(distance)
    }

    pub(super) fn is_rotating(&self) -> bool {
        self.rotation.is_some()
    }

    /// Whether to go on turning: until once around, or there is no room.
    pub(super) fn rotate(&mut self, yaw: f64, is_free: bool) -> bool {
        let Some(rotation) = &mut self.rotation else { return false };
        rotation.turned += wrap(yaw - rotation.last_yaw.unwrap_or(yaw)).abs();
        rotation.last_yaw = Some(yaw);
        if rotation.turned >= TAU || !is_free {
            self.rotation = None;
        }
        self.rotation.is_some()
    }
}
