//! What a shield remembers of the commands that it sent.

use std::collections::VecDeque;

use headway_sim::{Command, Drive, Dynamics, Wheels};

use crate::Sensed;

/// Commands sent that do not act in full yet, and what those before have made of the wheels.
#[derive(Debug, Clone, Default)]
pub(super) struct Sent {
    /// The oldest first; before the first one, the vehicle was told to stand.
    commands: VecDeque<Command>,
    /// The angle that steered wheels should have by now, radians.
    steering: f64,
}

/// A command and for how many substeps it is in force.
pub(super) type Phase = (Command, usize);

/// Speed from which on the yaw rate tells how the wheels are steered, m/s.
const TELLING_SPEED: f64 = 0.05;

impl Sent {
    /// The commands in force from now until the next one acts, `latency` seconds from now.
    pub(super) fn phases(&self, latency: f64, sensed: &Sensed<'_>) -> Vec<Phase> {
        let (n_whole, n_late) = Dynamics::new(sensed.vehicle).delay(latency);
        let n_phases = n_whole + usize::from(n_late > 0);
        let n_substeps = |phase: usize| if phase == 0 && n_late > 0 { n_late } else { sensed.vehicle.n_substeps };
        let n_unsent = n_phases.saturating_sub(self.commands.len());
        let unsent = std::iter::repeat_n(Command::default(), n_unsent);
        let commands = unsent.chain(self.commands.iter().skip(self.commands.len() + n_unsent - n_phases).copied());
        commands.enumerate().map(|(phase, command)| (command, n_substeps(phase))).collect()
    }

    /// How the vehicle moves now.
    pub(super) fn wheels(&self, sensed: &Sensed<'_>) -> Wheels {
        let twist = sensed.twist;
        let steering = match sensed.vehicle.drive {
            Drive::Ackermann { wheelbase, max_steering_angle, .. } if twist.x.abs() > TELLING_SPEED => {
                (wheelbase * twist.z / twist.x).atan().clamp(-max_steering_angle, max_steering_angle)
            }
            _ => self.steering,
        };
        Wheels { twist, steering }
    }

    /// Takes in the command that is sent now.
    pub(super) fn push(&mut self, latency: f64, sensed: &Sensed<'_>, command: Command) {
        let mut phases = self.phases(latency, sensed);
        let n_under_way = phases.len();
        phases.push((command, sensed.vehicle.n_substeps));
        self.steering = steering_after(&phases, sensed, self.wheels(sensed));
        self.commands.push_back(command);
        let n_past = self.commands.len().saturating_sub(n_under_way);
        self.commands.drain(..n_past);
    }
}

/// The angle of steered wheels a control period from now, radians.
fn steering_after(phases: &[Phase], sensed: &Sensed<'_>, mut wheels: Wheels) -> f64 {
    if !matches!(sensed.vehicle.drive, Drive::Ackermann { .. }) {
        return 0.0;
    }
    let (dynamics, mut n_left) = (Dynamics::new(sensed.vehicle), sensed.vehicle.n_substeps);
    for (command, n_substeps) in phases {
        let mut n = n_left.min(*n_substeps);
        n_left -= n;
        let target = dynamics.target(*command, wheels.steering);
        while n > 0 {
            dynamics.next_stretch(&mut wheels, target, &mut n);
        }
    }
    wheels.steering
}
