//! A vehicle with limits, driven by commands.

mod actuation;
mod body;
mod drive;
mod preset;
mod spec;

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use crate::{Footprint, Pose, Proximity, Twist, World};
use body::Body;

pub use actuation::ActuationSpec;
pub use body::{Dynamics, Stretch, Wheels};
pub use drive::Drive;
pub use preset::VehiclePreset;
pub use spec::VehicleSpec;

/// What a driver asks for: set-points that the vehicle approaches as fast as its limits allow.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Command {
    /// Forward speed, m/s.
    pub speed: f64,
    /// Yaw rate, rad/s, positive to the left.
    pub yaw_rate: f64,
    /// Leftward speed, m/s: for vehicles that can move sideways, 0 for all others.
    #[serde(default)]
    pub lateral_speed: f64,
}

impl Command {
    /// A forward speed, m/s, and a yaw rate, rad/s, without sideways motion.
    #[must_use]
    pub const fn new(speed: f64, yaw_rate: f64) -> Self {
        Self { speed, yaw_rate, lateral_speed: 0.0 }
    }
}

/// Where a vehicle is and how it moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VehicleState {
    /// Position and yaw in the world.
    pub pose: Pose,
    /// Velocity in the body frame.
    pub twist: Twist,
    /// Angle of the front wheels, radians, positive to the left; 0 without [`Drive::Ackermann`].
    #[serde(default)]
    pub steering: f64,
    /// Commands on their way to the wheels, the oldest first; none without [`ActuationSpec::latency`].
    #[serde(default)]
    pub in_transit: Vec<Command>,
}

impl VehicleState {
    /// A vehicle that stands at `pose`.
    #[must_use]
    pub fn at_rest(pose: Pose) -> Self {
        Self { pose, twist: Twist::zeros(), steering: 0.0, in_transit: Vec::new() }
    }
}

/// What happened in one control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Length of the path driven, metres.
    pub distance: f64,
    /// Time driven, seconds: the control period, or less up to a collision.
    pub duration: f64,
    /// Whether the vehicle hit something; it then stays where it first touched.
    pub collided: bool,
    /// How near things are at the end.
    pub proximity: Proximity,
}

/// A checked vehicle: its outline and limits, without a state.
#[derive(Debug, Clone)]
pub struct Vehicle {
    spec: VehicleSpec,
    dynamics: Dynamics,
    footprint: Footprint,
}

/// A command and for how many substeps it is in force.
#[derive(Clone, Copy)]
struct Phase {
    command: Command,
    n_substeps: usize,
}

impl Vehicle {
    /// How deep a corner may be cut between two collision checks, metres.
    pub const CONTACT_TOLERANCE: f64 = 1e-3;

    /// The data it was built from.
    #[must_use]
    pub fn spec(&self) -> &VehicleSpec {
        &self.spec
    }

    /// Its outline.
    #[must_use]
    pub fn footprint(&self) -> &Footprint {
        &self.footprint
    }

    /// Drives for one control period.
    ///
    /// Speed and yaw rate approach the command within the limits of the [`Drive`] and of the [`ActuationSpec`]; each substep
    /// is an exact arc at its mean velocity. A collision anywhere on the way is found by advancing
    /// by no more than the clearance allows (conservative advancement, Mirtich 1996), so a fast vehicle
    /// does not pass through a thin obstacle; only corners cut by less than
    /// [`Self::CONTACT_TOLERANCE`] can be missed. After a step without collision the clearance is above 0.
    ///
    /// A number in the command that is infinite or not a number counts as 0, so that a driver gone wrong brakes.
    pub fn step(&self, world: &World, state: &mut VehicleState, command: Command) -> Motion {
        let phases = self.phases(state, command);
        self.drive(world, state, &phases, self.spec.control_period)
    }

    /// As [`Self::step`], in a world that moves: before each substep, `advance` moves it on by that many seconds, and the
    /// vehicle then drives as if it stood still. What moves into the vehicle collides with it; what moves in a substep by more than its own
    /// size and the vehicle's may jump over it, so fast movers need more substeps.
    pub fn step_among(
        &self,
        world: &mut World,
        state: &mut VehicleState,
        command: Command,
        mut advance: impl FnMut(&mut World, &VehicleState, f64),
    ) -> Motion {
        let substep = self.dynamics.substep();
        let (mut distance, mut duration, mut last) = (0.0, 0.0, None);
        for Phase { command, n_substeps } in self.phases(state, command) {
            for _ in 0..n_substeps {
                advance(world, state, substep);
                let motion = self.drive(world, state, &[Phase { command, n_substeps: 1 }], substep);
                distance += motion.distance;
                duration += motion.duration;
                last = Some(motion);
                if motion.collided {
                    return Motion { distance, duration, ..motion };
                }
            }
        }
        let motion = last.expect("a period has a substep");
        Motion { distance, duration: self.spec.control_period, ..motion }
    }

    /// What actuators make of a command: its numbers times `1 + noise x` with a standard normal `x` for each, see
    /// [`ActuationSpec::noise`]. No random number is drawn without noise.
    #[must_use]
    pub fn disturb(&self, command: Command, rng: &mut impl RngExt) -> Command {
        let noise = self.spec.actuation.noise;
        if noise == 0.0 {
            return command;
        }
        let mut factor = || {
            let deviation: f64 = StandardNormal.sample(rng);
            1.0 + noise * deviation
        };
        let Command { speed, yaw_rate, lateral_speed } = command;
        let (speed, yaw_rate) = (speed * factor(), yaw_rate * factor());
        Command { speed, yaw_rate, lateral_speed: if lateral_speed == 0.0 { 0.0 } else { lateral_speed * factor() } }
    }

    /// The commands in force over the period that begins when `command` is sent: with a latency first the one before it.
    fn phases(&self, state: &mut VehicleState, command: Command) -> [Phase; 2] {
        let n_substeps = self.spec.n_substeps;
        let (n_whole, n_late) = self.dynamics.delay(self.spec.actuation.latency);
        if n_whole == 0 && n_late == 0 {
            return [Phase { command, n_substeps }, Phase { command, n_substeps: 0 }];
        }
        // Before the first command arrives, the vehicle was told to stand.
        let n_before = n_whole + usize::from(n_late > 0);
        state.in_transit.resize(n_before, Command::default());
        state.in_transit.push(command);
        let old = state.in_transit.remove(0);
        let new = if n_late > 0 { state.in_transit[0] } else { old };
        [Phase { command: old, n_substeps: n_late }, Phase { command: new, n_substeps: n_substeps - n_late }]
    }

    /// Drives through phases that take `duration` seconds together.
    fn drive(&self, world: &World, state: &mut VehicleState, phases: &[Phase], duration: f64) -> Motion {
        let start = Body::of(state);
        let (mut body, mut distance, mut reach) = (start, 0.0, 0.0);
        for phase in phases {
            let target = self.dynamics.target(phase.command, body.wheels.steering);
            let mut n_left = phase.n_substeps;
            while n_left > 0 {
                let stretch = self.dynamics.next_stretch(&mut body.wheels, target, &mut n_left);
                body.pose = stretch.end(&body.pose, stretch.time);
                distance += stretch.speed() * stretch.time;
                reach += self.point_speed(&stretch) * stretch.time;
            }
        }
        body.store(state);
        let proximity = world.proximity(&self.footprint, &state.pose);
        let unhurt = Motion { distance, duration, collided: false, proximity };
        // No point of the outline moved further than what was free around it before, and is now, together: wherever on the
        // way it was, the nearer of the two ends vouches for it. Most often what is free now is enough.
        let free_now = proximity.clearance();
        if free_now > reach || free_now > 0.0 && free_now + world.clearance(&self.footprint, &start.pose) > reach {
            return unhurt;
        }
        self.first_contact(world, start, phases, state).unwrap_or(unhurt)
    }

    /// The highest speed of any point of the outline, m/s.
    fn point_speed(&self, stretch: &Stretch) -> f64 {
        stretch.speed() + stretch.twist.z.abs() * self.footprint.turning_radius()
    }

    /// Drives the period again from `start`, looking everywhere: the first touch, where `state` is left;
    /// `None` where there is none.
    fn first_contact(&self, world: &World, start: Body, phases: &[Phase], state: &mut VehicleState) -> Option<Motion> {
        let (mut body, mut distance, mut duration) = (start, 0.0, 0.0);
        for phase in phases {
            let target = self.dynamics.target(phase.command, body.wheels.steering);
            let mut n_left = phase.n_substeps;
            while n_left > 0 {
                let stretch = self.dynamics.next_stretch(&mut body.wheels, target, &mut n_left);
                if let Some((time, proximity)) = self.contact_within(world, &body.pose, &stretch) {
                    body.pose = stretch.end(&body.pose, time);
                    body.store(state);
                    distance += stretch.speed() * time;
                    duration += time;
                    return Some(Motion { distance, duration, collided: true, proximity });
                }
                body.pose = stretch.end(&body.pose, stretch.time);
                distance += stretch.speed() * stretch.time;
                duration += stretch.time;
            }
        }
        None
    }

    /// When in a stretch that starts at `pose` something is touched first, seconds, and how near things are then.
    fn contact_within(&self, world: &World, pose: &Pose, stretch: &Stretch) -> Option<(f64, Proximity)> {
        let speed = self.point_speed(stretch);
        let mut time = 0.0;
        loop {
            let proximity = world.proximity(&self.footprint, &stretch.end(pose, time));
            let room = proximity.clearance();
            if room.is_nan() || room <= 0.0 {
                return Some((time, proximity));
            }
            if time >= stretch.time {
                return None;
            }
            let next = time + room.max(Self::CONTACT_TOLERANCE) / speed;
            // A step lost in rounding would be made for ever.
            time = if next > time && next < stretch.time { next } else { stretch.time };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Interval, Kinds, Room, RoomSpec, Shape, WorldSpec};
    use proptest::prelude::*;

    proptest! {
        /// What a step skips, since the two ends vouch for the way, against looking everywhere.
        #[test]
        fn a_step_is_what_looking_everywhere_finds(
            seed in 0..200_u64,
            is_box in any::<bool>(),
            max_speed in 0.5..20.0,
            commands in prop::collection::vec((0.0..1.0, -1.0..1.0), 12),
        ) {
            let footprint = if is_box { Shape::Box { length: 0.6, width: 0.3 } } else { Shape::Disc { radius: 0.25 } };
            let limits = VehicleSpec { max_acceleration: 50.0, max_yaw_rate: 4.0, ..VehicleSpec::default() };
            let vehicle = VehicleSpec { footprint, max_speed, ..limits }.build().unwrap();
            let kinds = Kinds { disc: 1.0, r#box: 1.0, polygon: 1.0 };
            let room = RoomSpec { kinds, obstacle_radius: Interval::Range([0.05, 0.4]), ..RoomSpec::default() };
            let scenario = WorldSpec::Room(room).build(vehicle.footprint()).unwrap().scenario(seed, 0).unwrap();
            let (world, mut state) = (&scenario.world, VehicleState::at_rest(scenario.start));
            for (speed, yaw_rate) in commands {
                let command = Command::new(speed * max_speed, yaw_rate * 4.0);
                let (start, mut looked) = (Body::of(&state), state.clone());
                let phases = vehicle.phases(&mut looked, command);
                let contact = vehicle.first_contact(world, start, &phases, &mut looked);
                let motion = vehicle.step(world, &mut state, command);
                prop_assert_eq!(motion.collided, contact.is_some());
                if let Some(contact) = contact {
                    prop_assert_eq!((motion, &state), (contact, &looked));
                    break;
                }
            }
        }
    }

    #[test]
    fn a_period_ends_even_if_time_does_not_advance() {
        // The corners' speed overflows, so that advancing by a millimetre takes no time: this never came back.
        let world = World::new(Room::new(10.0, 10.0), vec![]).unwrap();
        let footprint = Footprint::new(&Shape::Box { length: 9.0, width: 1.0 }).unwrap();
        let yaw_rate = 0.8e308;
        let spec = VehicleSpec { max_yaw_rate: yaw_rate, ..VehicleSpec::default() };
        let mut state = VehicleState::at_rest(Pose::translation(5.0, 5.0));
        state.twist.z = yaw_rate;
        let vehicle = Vehicle { dynamics: Dynamics::new(&spec), spec, footprint };
        let motion = vehicle.step(&world, &mut state, Command::new(0.0, yaw_rate));
        assert_eq!(motion.duration, 0.2);
    }
}
