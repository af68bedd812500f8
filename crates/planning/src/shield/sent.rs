//! What a shield remembers of the commands that it sent.

use std::collections::VecDeque;

use headway_sim::{Command, Drive, Dynamics, Interval, VehicleSpec, Wheels};

use crate::Sensed;

/// Commands sent that do not act in full yet if each takes a certain time to, and what those before have made of the wheels.
#[derive(Debug, Clone)]
pub(super) struct Sent {
    /// That time, in whole control periods and the substeps left over.
    delay: (usize, usize),
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
    /// Nothing yet, for every latency that a vehicle may have, which is a whole number of substeps.
    pub(super) fn nothing(latency: Interval, vehicle: &VehicleSpec) -> Vec<Self> {
        // Vehicles with very short substeps are looked at with some of them.
        const MOST: usize = 100;
        let n_substeps = |latency: f64| {
            let (n_whole, n_late) = Dynamics::new(vehicle).delay(latency);
            n_whole * vehicle.n_substeps + n_late
        };
        let (least, most) = (n_substeps(*latency.bounds().start()), n_substeps(*latency.bounds().end()));
        let n_steps = (most - least).min(MOST - 1);
        let nth = |k: usize| least + (most - least) * k / n_steps.max(1);
        let of = |n: usize| (n / vehicle.n_substeps, n % vehicle.n_substeps);
        (0..=n_steps).map(|k| Self { delay: of(nth(k)), commands: VecDeque::new(), steering: 0.0 }).collect()
    }

    /// The commands in force from now until the next one acts.
    pub(super) fn phases(&self, sensed: &Sensed<'_>) -> Vec<Phase> {
        let (n_whole, n_late) = self.delay;
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
    pub(super) fn push(&mut self, sensed: &Sensed<'_>, command: Command) {
        let mut phases = self.phases(sensed);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn latencies_are_whole_substeps_from_end_to_end() {
        let delays = |latency: Interval, n_substeps: usize| {
            let vehicle = VehicleSpec { n_substeps, ..VehicleSpec::default() };
            Sent::nothing(latency, &vehicle).into_iter().map(|sent| sent.delay).collect::<Vec<_>>()
        };
        // Substeps of 0.05 s, four of them a period.
        assert_eq!(delays(Interval::Fixed(0.3), 4), [(1, 2)]);
        assert_eq!(delays(Interval::Range([0.13, 0.24]), 4), [(0, 3), (1, 0), (1, 1)]);
        // Of 0.2 ms: 501 of them, of which every fifth or so is looked at.
        let some = delays(Interval::Range([0.1, 0.2]), 1000);
        assert_eq!((some.len(), some[0], some[99]), (100, (0, 500), (1, 0)));
        let numbers: Vec<usize> = some.iter().map(|(n_whole, n_late)| n_whole * 1000 + n_late).collect();
        assert!(numbers.windows(2).all(|pair| (5..=6).contains(&(pair[1] - pair[0]))), "{numbers:?}");
    }
}
