//! A vehicle with limits, driven by speed and yaw-rate commands.

use serde::{Deserialize, Serialize};

use crate::{FieldError, Footprint, Pose, Proximity, Shape, Twist, World, arc, at_least, non_negative, positive};

/// A differential-drive vehicle (unicycle) as data: outline, limits, control period.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VehicleSpec {
    /// The outline, around the middle of the axle.
    pub footprint: Shape,
    /// Highest forward speed, m/s.
    pub max_speed: f64,
    /// Highest backward speed, m/s; 0 for a vehicle that does not reverse.
    pub max_reverse_speed: f64,
    /// Highest yaw rate to either side, rad/s.
    pub max_yaw_rate: f64,
    /// Highest change of speed, m/s^2, speeding up and braking.
    pub max_acceleration: f64,
    /// Highest change of yaw rate, rad/s^2.
    pub max_yaw_acceleration: f64,
    /// Time between two commands, seconds.
    pub control_period: f64,
    /// Integration steps per control period.
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
        positive("max_speed", self.max_speed)?;
        non_negative("max_reverse_speed", self.max_reverse_speed)?;
        positive("max_yaw_rate", self.max_yaw_rate)?;
        positive("max_acceleration", self.max_acceleration)?;
        positive("max_yaw_acceleration", self.max_yaw_acceleration)?;
        positive("control_period", self.control_period)?;
        at_least("n_substeps", self.n_substeps, 1)?;
        Ok(Vehicle { spec: self.clone(), footprint })
    }
}

/// What a driver asks for: set-points that the vehicle approaches as fast as its limits allow.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Command {
    /// Forward speed, m/s.
    pub speed: f64,
    /// Yaw rate, rad/s, positive to the left.
    pub yaw_rate: f64,
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
    pub fn step(&self, world: &World, state: &mut VehicleState, command: Command) -> Motion {
        let start = *state;
        let (mut distance, mut reach) = (0.0, 0.0);
        for _ in 0..self.spec.n_substeps {
            let stretch = self.accelerate(&mut state.twist, command);
            state.pose = arc(&state.pose, stretch.speed, stretch.yaw_rate, stretch.time);
            distance += stretch.speed.abs() * stretch.time;
            reach += self.point_speed(&stretch) * stretch.time;
        }
        let proximity = world.proximity(&self.footprint, &state.pose);
        let duration = self.spec.control_period;
        let unhurt = Motion { distance, duration, collided: false, proximity };
        if proximity.clearance() > reach {
            // No point of the outline moved further than what is now free around it.
            return unhurt;
        }
        self.first_contact(world, start, command, state).unwrap_or(unhurt)
    }

    /// One substep of the linear approach to the command: the mean speed and yaw rate over it.
    fn accelerate(&self, twist: &mut Twist, command: Command) -> Stretch {
        let spec = &self.spec;
        let h = spec.control_period / spec.n_substeps as f64;
        let speed = command.speed.clamp(-spec.max_reverse_speed, spec.max_speed);
        let yaw_rate = command.yaw_rate.clamp(-spec.max_yaw_rate, spec.max_yaw_rate);
        let before = *twist;
        twist.x = approach(twist.x, speed, spec.max_acceleration * h);
        twist.z = approach(twist.z, yaw_rate, spec.max_yaw_acceleration * h);
        Stretch { speed: (before.x + twist.x) / 2.0, yaw_rate: (before.z + twist.z) / 2.0, time: h }
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
        command: Command,
        state: &mut VehicleState,
    ) -> Option<Motion> {
        let (mut pose, mut twist) = (start.pose, start.twist);
        let (mut distance, mut duration) = (0.0, 0.0);
        for _ in 0..self.spec.n_substeps {
            let stretch = self.accelerate(&mut twist, command);
            let speed = self.point_speed(&stretch);
            let mut time = 0.0;
            loop {
                let here = arc(&pose, stretch.speed, stretch.yaw_rate, time);
                let proximity = world.proximity(&self.footprint, &here);
                let room = proximity.clearance();
                if room <= 0.0 {
                    *state = VehicleState { pose: here, twist };
                    distance += stretch.speed.abs() * time;
                    duration += time;
                    return Some(Motion { distance, duration, collided: true, proximity });
                }
                if time >= stretch.time {
                    pose = here;
                    break;
                }
                let free = room.max(Self::CONTACT_TOLERANCE) / speed;
                time = if free < stretch.time - time { time + free } else { stretch.time };
            }
            distance += stretch.speed.abs() * stretch.time;
            duration += stretch.time;
        }
        None
    }
}

fn approach(value: f64, target: f64, most: f64) -> f64 {
    value + (target - value).clamp(-most, most)
}
