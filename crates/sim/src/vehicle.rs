//! A vehicle with limits, driven by speed and yaw-rate commands.

use serde::{Deserialize, Serialize};

use crate::check::{non_negative, positive, within};
use crate::{FieldError, Footprint, Pose, Proximity, Shape, Twist, World, arc};

/// A differential-drive vehicle (unicycle) as data: outline, limits, control period.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VehicleSpec {
    /// The outline, around the middle of the axle; no point of it farther than 100 m from there.
    pub footprint: Shape,
    /// Highest forward speed, m/s; up to 100.
    pub max_speed: f64,
    /// Highest backward speed, m/s; up to 100, 0 for a vehicle that does not reverse.
    pub max_reverse_speed: f64,
    /// Highest yaw rate to either side, rad/s; up to 100.
    pub max_yaw_rate: f64,
    /// Highest change of speed, m/s^2, speeding up and braking; up to 10 000.
    pub max_acceleration: f64,
    /// Highest change of yaw rate, rad/s^2; up to 10 000.
    pub max_yaw_acceleration: f64,
    /// Time between two commands, seconds; from 0.001 to 10.
    pub control_period: f64,
    /// Integration steps per control period; from 1 to 1000.
    pub n_substeps: usize,
}

impl Default for VehicleSpec {
    fn default() -> Self {
        Self {
            footprint: Shape::Disc { radius: 0.25 },
            max_speed: 1.5,
            max_reverse_speed: 0.0,
            max_yaw_rate: 1.5,
            max_acceleration: 2.0,
            max_yaw_acceleration: 6.0,
            control_period: 0.2,
            n_substeps: 4,
        }
    }
}

impl VehicleSpec {
    /// Checks the numbers and builds the vehicle.
    ///
    /// # Errors
    /// Names the field, its value and what is allowed.
    pub fn build(&self) -> Result<Vehicle, FieldError> {
        let footprint = Footprint::new(&self.footprint).map_err(|e| e.under("footprint"))?;
        within("footprint (its circumradius)", footprint.circumradius(), 0.0, 100.0)?;
        non_negative("max_reverse_speed", self.max_reverse_speed)?;
        within("max_reverse_speed", self.max_reverse_speed, 0.0, 100.0)?;
        for (field, limit, most) in [
            ("max_speed", self.max_speed, 100.0),
            ("max_yaw_rate", self.max_yaw_rate, 100.0),
            ("max_acceleration", self.max_acceleration, 1e4),
            ("max_yaw_acceleration", self.max_yaw_acceleration, 1e4),
        ] {
            positive(field, limit)?;
            within(field, limit, 0.0, most)?;
        }
        within("control_period", self.control_period, 1e-3, 10.0)?;
        within("n_substeps", self.n_substeps as f64, 1.0, 1000.0)?;
        let substep = self.control_period / self.n_substeps as f64;
        Ok(Vehicle { spec: self.clone(), substep, footprint })
    }
}

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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct VehicleState {
    /// Position and yaw in the world.
    pub pose: Pose,
    /// Velocity in the body frame.
    pub twist: Twist,
}

impl VehicleState {
    /// A vehicle that stands at `pose`.
    #[must_use]
    pub fn at_rest(pose: Pose) -> Self {
        Self { pose, twist: Twist::zeros() }
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
    /// Seconds.
    substep: f64,
    footprint: Footprint,
}

/// A stretch of constant speed and yaw rate.
#[derive(Clone, Copy)]
struct Stretch {
    speed: f64,
    yaw_rate: f64,
    time: f64,
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
    /// Speed and yaw rate approach the command linearly within the acceleration limits; each substep is
    /// an exact arc at its mean speed and yaw rate. A collision anywhere on the way is found by advancing
    /// by no more than the clearance allows (conservative advancement, Mirtich 1996), so a fast vehicle
    /// does not pass through a thin obstacle; only corners cut by less than
    /// [`Self::CONTACT_TOLERANCE`] can be missed. After a step without collision the clearance is above 0.
    ///
    /// A speed or yaw rate in the command that is infinite or not a number counts as 0, so that a driver
    /// gone wrong brakes.
    pub fn step(&self, world: &World, state: &mut VehicleState, command: Command) -> Motion {
        let start = *state;
        let target = self.target(command);
        let (mut distance, mut reach, mut n_left) = (0.0, 0.0, self.spec.n_substeps);
        while n_left > 0 {
            let stretch = self.next_stretch(&mut state.twist, target, &mut n_left);
            state.pose = arc(&state.pose, stretch.speed, stretch.yaw_rate, stretch.time);
            distance += stretch.speed.abs() * stretch.time;
            reach += self.point_speed(&stretch) * stretch.time;
        }
        let proximity = world.proximity(&self.footprint, &state.pose);
        let duration = self.spec.control_period;
        let unhurt = Motion { distance, duration, collided: false, proximity };
        // No point of the outline moved further than what was free around it before, and is now, together: wherever on the
        // way it was, the nearer of the two ends vouches for it. Most often what is free now is enough.
        let free_now = proximity.clearance();
        if free_now > reach || free_now > 0.0 && free_now + world.clearance(&self.footprint, &start.pose) > reach {
            return unhurt;
        }
        self.first_contact(world, start, target, state).unwrap_or(unhurt)
    }

    /// The speed and yaw rate that a command makes the vehicle approach.
    fn target(&self, command: Command) -> Command {
        let spec = &self.spec;
        let finite = |number: f64| if number.is_finite() { number } else { 0.0 };
        Command::new(
            finite(command.speed).clamp(-spec.max_reverse_speed, spec.max_speed),
            finite(command.yaw_rate).clamp(-spec.max_yaw_rate, spec.max_yaw_rate),
        )
    }

    /// The next of the substeps that are left, at the mean speed and yaw rate over it; all of them in one once the target
    /// is reached, since arcs of the same speed and yaw rate make one arc.
    #[inline]
    fn next_stretch(&self, twist: &mut Twist, target: Command, n_left: &mut usize) -> Stretch {
        let spec = &self.spec;
        let (speed, yaw_rate) = (twist.x, twist.z);
        if speed == target.speed && yaw_rate == target.yaw_rate {
            let n = std::mem::take(n_left);
            return Stretch { speed, yaw_rate, time: n as f64 * self.substep };
        }
        *n_left -= 1;
        twist.x = approach(speed, target.speed, spec.max_acceleration * self.substep);
        twist.z = approach(yaw_rate, target.yaw_rate, spec.max_yaw_acceleration * self.substep);
        Stretch { speed: (speed + twist.x) / 2.0, yaw_rate: (yaw_rate + twist.z) / 2.0, time: self.substep }
    }

    /// The highest speed of any point of the outline, m/s.
    fn point_speed(&self, stretch: &Stretch) -> f64 {
        stretch.speed.abs() + stretch.yaw_rate.abs() * self.footprint.turning_radius()
    }

    /// Drives the period again from `start`, looking everywhere: the first touch, where `state` is left;
    /// `None` where there is none.
    fn first_contact(
        &self,
        world: &World,
        start: VehicleState,
        target: Command,
        state: &mut VehicleState,
    ) -> Option<Motion> {
        let (mut pose, mut twist) = (start.pose, start.twist);
        let (mut distance, mut duration, mut n_left) = (0.0, 0.0, self.spec.n_substeps);
        while n_left > 0 {
            let stretch = self.next_stretch(&mut twist, target, &mut n_left);
            let speed = self.point_speed(&stretch);
            let mut time = 0.0;
            loop {
                let here = arc(&pose, stretch.speed, stretch.yaw_rate, time);
                let proximity = world.proximity(&self.footprint, &here);
                let room = proximity.clearance();
                if room.is_nan() || room <= 0.0 {
                    *state = VehicleState { pose: here, twist };
                    distance += stretch.speed.abs() * time;
                    duration += time;
                    return Some(Motion { distance, duration, collided: true, proximity });
                }
                if time >= stretch.time {
                    pose = here;
                    break;
                }
                let next = time + room.max(Self::CONTACT_TOLERANCE) / speed;
                // A step lost in rounding would be made for ever.
                time = if next > time && next < stretch.time { next } else { stretch.time };
            }
            distance += stretch.speed.abs() * stretch.time;
            duration += stretch.time;
        }
        None
    }
}

fn approach(value: f64, target: f64, most: f64) -> f64 {
    if (target - value).abs() <= most { target } else { value + most.copysign(target - value) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Interval, Kinds, Room, RoomSpec, WorldSpec};
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
                let target = vehicle.target(Command::new(speed * max_speed, yaw_rate * 4.0));
                let (start, mut looked) = (state, state);
                let contact = vehicle.first_contact(world, start, target, &mut looked);
                let motion = vehicle.step(world, &mut state, target);
                prop_assert_eq!(motion.collided, contact.is_some());
                if let Some(contact) = contact {
                    prop_assert_eq!((motion, state), (contact, looked));
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
        let motion = Vehicle { substep: spec.control_period / 4.0, spec, footprint }.step(
            &world,
            &mut state,
            Command::new(0.0, yaw_rate),
        );
        assert_eq!(motion.duration, 0.2);
    }
}
