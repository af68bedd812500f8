//! What a player needs of a drive, in few bytes.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use headway_env::{Mdp, Navigator};
use headway_sim::{Outline, Room, Scenario, Shape, Surface, World};
use serde::Serialize;

/// Most rays of a scan that are kept; of more, every second, third, ... is.
const MAX_RAYS: usize = 72;
/// Space around what is shown of a room that is mostly empty, m.
const MARGIN: f64 = 1.0;

/// The scene of a drive: what stands in the room, where from and where to. Lengths in m.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scene {
    /// The part of the room that is shown: `[x, y, width, height]`.
    pub view: [f64; 4],
    /// What stands still.
    pub obstacles: Vec<Form>,
    /// What moves, around its own origin and at yaw 0.
    pub movers: Vec<Form>,
    /// The goal.
    pub goal: [f64; 2],
    /// Distance from the goal at which it counts as reached.
    pub reach: f64,
    /// The vehicle's outline around its origin.
    pub footprint: Form,
}

/// An outline: a disc as `[x, y, radius]`, or a polygon as its corners.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Form {
    /// Centre and radius.
    Disc([f64; 3]),
    /// The corners, in order.
    Polygon(Vec<[f64; 2]>),
}

/// The steps of a drive, quantised and packed.
///
/// `packed` is base64 of little-endian 16-bit channels one after the other, each with a number per state, the start
/// included: the time since the state before (unsigned, 0.1 ms); x and y (unsigned, `step` from `origin`); yaw (signed,
/// pi / 32767); speed and yaw rate, and the speed and the yaw rate commanded on the way here (signed, mm/s and mrad/s); the
/// clearance (unsigned, mm); then x, y and yaw of each mover. Last come the rays of all states, 8 bits each, in 1/255 of
/// `max_range`. What is beyond a channel's range is at its end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trace {
    /// Number of states.
    pub n: usize,
    /// Where x and y count from, m.
    pub origin: [f64; 2],
    /// In what steps they count, m.
    pub step: f64,
    /// The directions of the rays in the vehicle's frame, rad, in thousandths.
    pub rays: Vec<i32>,
    /// The length of a ray that meets nothing, m.
    pub max_range: f64,
    /// Number of movers.
    pub n_movers: usize,
    /// All numbers.
    pub packed: String,
}

impl Scene {
    /// The scene of a scenario under the rules that it is driven by.
    pub(super) fn new(mdp: &Mdp, scenario: &Scenario) -> Self {
        let world = &scenario.world;
        let n_still = world.static_obstacles().len();
        let obstacles: Vec<_> = (0..n_still).filter_map(|index| outline(world, index)).collect();
        let start = scenario.start.translation.vector;
        let ends = [[start.x, start.y], [scenario.goal.x, scenario.goal.y]];
        let Room { x, y, width, height } = view(world.room(), &obstacles, &ends, world.movers().is_empty());
        Self {
            view: [x, y, width, height].map(rounded),
            obstacles,
            movers: world.movers().iter().map(|mover| form(&mover.shape)).collect(),
            goal: ends[1].map(rounded),
            reach: mdp.reach_radius(),
            footprint: form(mdp.vehicle().footprint().shape()),
        }
    }
}

/// All of a room, or the part of it where anything is if that is less than half of it.
fn view(room: Room, obstacles: &[Form], ends: &[[f64; 2]], is_still: bool) -> Room {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let mut hold = |[x, y]: [f64; 2], radius: f64| {
        for (axis, place) in [x, y].into_iter().enumerate() {
            low[axis] = low[axis].min(place - radius - MARGIN);
            high[axis] = high[axis].max(place + radius + MARGIN);
        }
    };
    ends.iter().for_each(|end| hold(*end, 0.0));
    for form in obstacles {
        match form {
            Form::Disc([x, y, radius]) => hold([*x, *y], *radius),
            Form::Polygon(corners) => corners.iter().for_each(|corner| hold(*corner, 0.0)),
        }
    }
    let (x, y) = (low[0].max(room.x), low[1].max(room.y));
    let (right, above) = (high[0].min(room.x + room.width), high[1].min(room.y + room.height));
    let part = Room { x, y, width: right - x, height: above - y };
    let is_small = part.width * part.height < 0.5 * room.width * room.height;
    if is_still && is_small { part } else { room }
}

fn outline(world: &World, obstacle: usize) -> Option<Form> {
    match world.outline(Surface::Obstacle(obstacle)) {
        Outline::Disc { center, radius } => Some(Form::Disc([center.x, center.y, radius].map(rounded))),
        Outline::Polygon(corners) => {
            Some(Form::Polygon(corners.iter().map(|corner| [corner.x, corner.y].map(rounded)).collect()))
        }
        Outline::Wall(_) => None,
    }
}

fn form(shape: &Shape) -> Form {
    match shape {
        Shape::Disc { radius } => Form::Disc([0.0, 0.0, *radius]),
        _ => Form::Polygon(shape.vertices().iter().map(|corner| [corner.x, corner.y].map(rounded)).collect()),
    }
}

/// To the millimetre.
fn rounded(value: f64) -> f64 {
    (1000.0 * value).round() / 1000.0
}

/// A drive's states as they come in.
#[derive(Debug)]
pub(super) struct Recorder {
    origin: [f64; 2],
    step: f64,
    max_range: f64,
    /// Every how many beams one is kept.
    every: usize,
    rays: Vec<i32>,
    channels: Vec<Vec<u16>>,
    ranges: Vec<u8>,
}

/// Channels beside those of the movers.
const N_CHANNELS: usize = 9;

impl Recorder {
    pub(super) fn new(mdp: &Mdp, scenario: &Scenario) -> Self {
        let (room, angles) = (scenario.world.room(), mdp.lidar().beam_angles());
        let every = angles.len().div_ceil(MAX_RAYS);
        let n_channels = N_CHANNELS + 3 * scenario.world.movers().len();
        Self {
            // A vehicle's origin stays within the room; a margin costs nothing.
            origin: [room.x - MARGIN, room.y - MARGIN],
            step: (room.width.max(room.height) + 2.0 * MARGIN) / f64::from(u16::MAX),
            max_range: mdp.lidar().spec().max_range,
            every,
            rays: angles.iter().step_by(every).map(|angle| (1000.0 * angle).round() as i32).collect(),
            channels: vec![Vec::new(); n_channels],
            ranges: Vec::new(),
        }
    }

    /// Adds the next state; `is_start` says that no step led to it.
    pub(super) fn push(&mut self, vehicle: &Navigator) {
        let is_start = self.channels[0].is_empty();
        let (state, sensed) = (vehicle.vehicle(), vehicle.sensed());
        let elapsed = if is_start { 0.0 } else { vehicle.step_duration() };
        let (place, command) = (state.pose.translation.vector, sensed.last_command);
        let mut numbers = vec![
            unsigned(10_000.0 * elapsed),
            self.place(0, place.x),
            self.place(1, place.y),
            angle(state.pose.rotation.angle()),
            signed(1000.0 * state.twist.x),
            signed(1000.0 * state.twist.z),
            signed(1000.0 * command.speed),
            signed(1000.0 * command.yaw_rate),
            unsigned(1000.0 * vehicle.transition().after.clearance),
        ];
        for mover in vehicle.scenario().world.movers() {
            numbers.extend([self.place(0, mover.x), self.place(1, mover.y), angle(mover.yaw)]);
        }
        for (channel, number) in self.channels.iter_mut().zip(numbers) {
            channel.push(number);
        }
        let share = |range: &f32| (255.0 * (f64::from(*range) / self.max_range).clamp(0.0, 1.0)).round() as u8;
        self.ranges.extend(sensed.scan.iter().step_by(self.every).map(share));
    }

    fn place(&self, axis: usize, value: f64) -> u16 {
        unsigned((value - self.origin[axis]) / self.step)
    }

    pub(super) fn finish(self) -> Trace {
        let mut bytes: Vec<u8> = self.channels.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
        bytes.extend(&self.ranges);
        Trace {
            n: self.channels[0].len(),
            origin: self.origin,
            step: self.step,
            rays: self.rays,
            max_range: self.max_range,
            n_movers: (self.channels.len() - N_CHANNELS) / 3,
            packed: STANDARD.encode(bytes),
        }
    }
}

fn unsigned(value: f64) -> u16 {
    value.round().clamp(0.0, f64::from(u16::MAX)) as u16
}

fn signed(value: f64) -> u16 {
    let value = value.round().clamp(-f64::from(i16::MAX), f64::from(i16::MAX)) as i16;
    value.cast_unsigned()
}

fn angle(radians: f64) -> u16 {
    let turns = (radians + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
    signed(turns / std::f64::consts::PI * f64::from(i16::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_their_channels() {
        assert_eq!([unsigned(-1.0), unsigned(1e9), unsigned(2.4)], [0, u16::MAX, 2]);
        assert_eq!([signed(-1e9), signed(-2.0), signed(1e9)].map(u16::cast_signed), [-i16::MAX, -2, i16::MAX]);
        assert_eq!(unsigned(f64::NAN), 0);
        let half_turn = [angle(std::f64::consts::PI), angle(-std::f64::consts::PI)].map(u16::cast_signed);
        assert!(half_turn.iter().all(|end| end.unsigned_abs() == i16::MAX.unsigned_abs()), "{half_turn:?}");
        assert_eq!(angle(std::f64::consts::FRAC_PI_2), angle(-3.0 * std::f64::consts::FRAC_PI_2));
    }

    #[test]
    fn a_room_that_is_mostly_empty_is_shown_in_part() {
        let room = Room { x: 0.0, y: 0.0, width: 100.0, height: 100.0 };
        let disc = Form::Disc([10.0, 10.0, 1.0]);
        let part = view(room, std::slice::from_ref(&disc), &[[5.0, 5.0], [12.0, 0.5]], true);
        assert_eq!([part.x, part.y, part.width, part.height], [4.0, 0.0, 9.0, 12.0]);
        assert_eq!(view(room, &[disc], &[[5.0, 5.0], [99.0, 99.0]], true), room);
    }
}
