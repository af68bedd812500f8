use crate::{Limits, State};
use serde::{Deserialize, Serialize};

/// What a step can end in, beside simply having driven on.
///
/// There is at most one per step: a vehicle that touches an obstacle within reach of its goal has collided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Event {
    /// The footprint touched an obstacle or a wall.
    Collision,
    /// The vehicle came within the reach radius of its goal.
    Reach,
}

/// One step of the vehicle, (s, a, s'), in plain SI numbers: all that a [`Reward`](crate::Reward) sees.
///
/// The goal distances and bearings of both states refer to the same goal, the one in force during the step, even when
/// reaching it brings a new one. So `before` and `after` may always be compared.
///
/// ```
/// use headway_reward::{State, Transition};
///
/// let step = Transition {
///     after: State { speed: 0.4, goal_distance: 4.92, ..State::default() },
///     ..Transition::default() // at rest, 5 m from the goal, dt = 0.2 s
/// };
/// assert!((step.progress() - 0.08).abs() < 1e-12);
/// assert!((step.acceleration() - 2.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<'a> {
    /// The state in which the command was chosen, s.
    pub before: State<'a>,
    /// The state at the end of the step, s', before any reset and before any new goal.
    pub after: State<'a>,
    /// The commanded forward speed, m/s.
    pub command_speed: f64,
    /// The commanded yaw rate, rad/s.
    pub command_yaw_rate: f64,
    /// The control period, s; positive. A step that a collision cuts short counts in full.
    pub dt: f64,
    /// What the step ended in, if anything.
    pub event: Option<Event>,
    /// What the vehicle can do.
    pub limits: Limits,
}

impl Transition<'_> {
    /// The decrease of the distance to the goal over the step, m; negative when the vehicle moved away.
    pub fn progress(&self) -> f64 {
        self.before.goal_distance - self.after.goal_distance
    }

    /// The mean forward acceleration over the step, m/s²; negative when braking.
    pub fn acceleration(&self) -> f64 {
        (self.after.speed - self.before.speed) / self.dt
    }
}

impl Default for Transition<'_> {
    /// A step of 0.2 s at rest in the open: [`State::default`] before and after, a command of zero, no event.
    ///
    /// It is there to keep hand-written tests short: name the fields that matter and take the rest from here.
    fn default() -> Self {
        Self {
            before: State::default(),
            after: State::default(),
            command_speed: 0.0,
            command_yaw_rate: 0.0,
            dt: 0.2,
            event: None,
            limits: Limits::default(),
        }
    }
}
