//! One vehicle on its way to a goal.

use std::sync::Arc;

use headway_planning::{Route, ScanPlanner, Sensed};
use headway_reward::{Event, State, Transition};
use headway_sensors::Odometry;
use headway_sim::{Command, Motion, Mover, Point, Proximity, Scenario, Vehicle, VehicleState, stream};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::robot::Robot;
use crate::{EnvError, GoalHandling, History, Mdp};

/// One vehicle in one scenario of an MDP. It is not reset by itself.
#[derive(Debug, Clone)]
pub struct Navigator {
    mdp: Arc<Mdp>,
    /// What drives in this episode.
    robot: Arc<Robot>,
    pub(crate) state: NavigatorState,
}

/// All of a navigator that changes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct NavigatorState {
    scenario: Scenario,
    goal: Point,
    route: Option<Route>,
    planner: Option<Box<ScanPlanner>>,
    vehicle: VehicleState,
    odometry: Odometry,
    /// The crowd as the vehicle knows it, in the frame of its odometry.
    movers: Vec<Mover>,
    history: History,
    /// The numbers of the robot that this episode drew.
    drawn: Vec<f64>,
    before: Facts,
    after: Facts,
    command: Command,
    event: Option<Event>,
    distance: f64,
    duration: f64,
    /// Steps since the start or the last goal.
    n_steps: u32,
    noise: ChaCha8Rng,
    motion: ChaCha8Rng,
    drift: ChaCha8Rng,
    goals: ChaCha8Rng,
}

/// What a next episode takes over: memory, and nothing that it holds.
struct Memory {
    planner: Option<Box<ScanPlanner>>,
    history: History,
    facts: [Facts; 2],
}

/// One moment in plain numbers: what becomes a reward's [`State`].
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Facts {
    speed: f64,
    yaw_rate: f64,
    goal_distance: f64,
    goal_bearing: f64,
    clearance: f64,
    obstacle_angle: Option<f64>,
    scan: Vec<f32>,
}

/// How a step left the process.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepEnd {
    /// What the step was paid.
    pub reward: f64,
    /// What happened, if anything.
    pub event: Option<Event>,
    /// Whether the process ended.
    pub terminated: bool,
    /// Whether the time limit cut it; never with `terminated`.
    pub truncated: bool,
}

impl Navigator {
    /// A vehicle at rest at the start of scenario number `index` of a seed. Its layout, its lidar's noise, the
    /// errors of its motion and of its odometry, what it draws of its numbers, and its further goals have random streams of
    /// their own.
    ///
    /// # Errors
    /// If the scenario cannot be made, or the agent does not steer and no route leads to the goal.
    pub fn new(mdp: Arc<Mdp>, seed: u64, index: u64) -> Result<Self, EnvError> {
        let scenario = mdp.source.scenario(seed, index)?;
        Self::in_scenario(mdp, scenario, seed, index)
    }

    /// A vehicle at rest at the start of a given scenario, with the random streams of scenario number
    /// `index` of a seed.
    ///
    /// # Errors
    /// If the agent does not steer and no route leads to the goal.
    pub fn in_scenario(mdp: Arc<Mdp>, scenario: Scenario, seed: u64, index: u64) -> Result<Self, EnvError> {
        let facts = || Facts::new(mdp.robot.lidar.beam_angles().len());
        let (robot, drawn) = mdp.draw_robot(seed, index)?;
        let route = mdp.route_of(&scenario)?;
        let memory = Memory { planner: mdp.planner()?, history: mdp.encoder.history(), facts: [facts(), facts()] };
        let state = NavigatorState::at_start(&robot, scenario, route, [seed, index], drawn, memory);
        let mut navigator = Self { mdp, robot, state };
        navigator.look_from_start();
        Ok(navigator)
    }

    /// As [`Self::new`] of the same MDP, in the same memory. After an error all is as before.
    ///
    /// # Errors
    /// If the scenario cannot be made, or the agent does not steer and no route leads to the goal.
    pub fn restart(&mut self, seed: u64, index: u64) -> Result<(), EnvError> {
        let scenario = self.mdp.source.scenario(seed, index)?;
        let route = self.mdp.route_of(&scenario)?;
        let (robot, drawn) = self.mdp.draw_robot(seed, index)?;
        let memory = self.state.take_memory();
        self.state = NavigatorState::at_start(&robot, scenario, route, [seed, index], drawn, memory);
        self.robot = robot;
        self.look_from_start();
        Ok(())
    }

    /// The first look, which stands for the state before the first step too.
    fn look_from_start(&mut self) {
        let footprint = self.robot.vehicle.footprint();
        let proximity = self.state.scenario.world.proximity(footprint, &self.state.vehicle.pose);
        self.look(&proximity);
        self.state.before.clone_from(&self.state.after);
    }

    /// Goes on by rules that differ in their world alone: from the next episode on.
    pub(crate) fn set_mdp(&mut self, mdp: Arc<Mdp>) {
        self.mdp = mdp;
    }

    /// Takes an action of the MDP's set, chosen on the present observation: what it means is decided by what is sensed alone,
    /// as on a robot.
    ///
    /// # Errors
    /// If a new goal is due and none can be found.
    ///
    /// # Panics
    /// If there is no such action.
    pub fn act(&mut self, action: u32) -> Result<StepEnd, EnvError> {
        let sensed = self.sensed();
        let asked = self.mdp.actions.command(action, sensed.twist.x, self.mdp.encoder.side(&sensed));
        let command = self.mdp.control.command(asked, &sensed);
        self.drive(command)
    }

    /// Drives by a command for one control period.
    ///
    /// # Errors
    /// If a new goal is due and none can be found.
    pub fn drive(&mut self, command: Command) -> Result<StepEnd, EnvError> {
        if self.state.n_steps == 0 {
            // The last step's `after` still shows the goal of that step; a new one may be in force since.
            (self.state.after.goal_distance, self.state.after.goal_bearing) = self.state.goal_polar();
        }
        let (state, vehicle) = (&mut self.state, &self.robot.vehicle);
        std::mem::swap(&mut state.before, &mut state.after);
        let from = state.vehicle.pose;
        let done = vehicle.disturb(command, &mut state.motion);
        let motion = state.step(vehicle, done);
        let VehicleState { pose, twist, .. } = &state.vehicle;
        state.odometry.advance(&from, pose, *twist, motion.duration, &mut state.drift);
        state.command = command;
        state.distance = motion.distance;
        state.duration = motion.duration;
        state.n_steps += 1;
        self.look(&motion.proximity);
        let has_reached = self.state.after.goal_distance <= self.mdp.reach_radius;
        self.state.event = match (motion.collided, has_reached) {
            (true, _) => Some(Event::Collision),
            (false, true) => Some(Event::Reach),
            (false, false) => None,
        };
        let reward = self.mdp.reward.reward(&self.transition());
        self.end_step(reward)
    }

    /// Decides how the step ends, and hands out a new goal if one is due.
    fn end_step(&mut self, reward: f64) -> Result<StepEnd, EnvError> {
        let drives_on = self.mdp.goal == GoalHandling::NewGoal && self.state.event == Some(Event::Reach);
        let terminated = self.state.event.is_some() && !drives_on;
        if drives_on {
            let here = self.state.vehicle.pose.translation.vector.into();
            let footprint = self.robot.vehicle.footprint();
            let goal = self.state.scenario.new_goal(&here, footprint, &mut self.state.goals);
            self.state.goal = goal;
            self.state.route = self.mdp.plan_route(&self.state.scenario.world, &here, &goal)?;
            self.plan();
            self.state.n_steps = 0;
        }
        let truncated = !terminated && self.state.n_steps >= self.mdp.n_max_steps;
        Ok(StepEnd { reward, event: self.state.event, terminated, truncated })
    }

    /// Perceives the world from where the vehicle is now, into `after`.
    fn look(&mut self, proximity: &Proximity) {
        let (mdp, state) = (&self.mdp, &mut self.state);
        let VehicleState { pose, twist, .. } = state.vehicle;
        let world = &state.scenario.world;
        self.robot.lidar.scan(world, &pose, &mut state.noise, &mut state.after.scan);
        state.after.speed = twist.x;
        state.after.yaw_rate = twist.z;
        state.after.clearance = proximity.clearance();
        state.after.obstacle_angle = mdp.obstacle_angle.measure(world, &pose, &twist, proximity);
        (state.after.goal_distance, state.after.goal_bearing) = state.goal_polar();
        state.history.remember(&state.odometry.pose());
        state.track();
        self.plan();
    }

    /// Lets the planner, if there is one, take in what is perceived now.
    fn plan(&mut self) {
        if let Some(mut planner) = self.state.planner.take() {
            planner.update(&self.sensed());
            self.state.planner = Some(planner);
        }
    }

    /// Encodes the present observation, shape `[obs_dim]`.
    pub fn observe(&self, obs: &mut [f32]) {
        self.mdp.encoder.encode(&self.sensed(), &self.state.history, obs);
    }

    /// What the vehicle perceives now.
    #[must_use]
    pub fn sensed(&self) -> Sensed<'_> {
        Sensed {
            vehicle: self.mdp.robot.vehicle.spec(),
            scan: &self.state.after.scan,
            beam_angles: self.mdp.robot.lidar.beam_angles(),
            max_range: self.mdp.robot.lidar.spec().max_range,
            pose: self.state.odometry.pose(),
            twist: self.state.odometry.twist(),
            goal: self.state.goal,
            route: self.route(),
            last_command: self.state.command,
            movers: &self.state.movers,
        }
    }

    /// The route that drivers are shown.
    fn route(&self) -> Option<&Route> {
        self.state.planner.as_ref().map_or(self.state.route.as_ref(), |planner| planner.route())
    }

    /// The last step as rewards see it: both of its states refer to the goal that was in force. Before the first step, both are
    /// the start.
    #[must_use]
    pub fn transition(&self) -> Transition<'_> {
        let angles = self.mdp.robot.lidar.beam_angles();
        Transition {
            before: self.state.before.as_state(angles),
            after: self.state.after.as_state(angles),
            command_speed: self.state.command.speed,
            command_yaw_rate: self.state.command.yaw_rate,
            dt: self.mdp.robot.vehicle.spec().control_period,
            event: self.state.event,
            limits: self.mdp.limits,
        }
    }

    /// Where the vehicle is and how it moves.
    #[must_use]
    pub fn vehicle(&self) -> &VehicleState {
        &self.state.vehicle
    }

    /// The present goal.
    #[must_use]
    pub fn goal(&self) -> Point {
        self.state.goal
    }

    /// The world, the start and the first goal.
    #[must_use]
    pub fn scenario(&self) -> &Scenario {
        &self.state.scenario
    }

    /// The numbers that this episode drew, by their dotted paths.
    pub fn drawn(&self) -> impl Iterator<Item = (String, f64)> {
        self.mdp.randomizer.paths().zip(self.state.drawn.iter().copied())
    }

    /// A navigator that goes on from a saved state.
    ///
    /// # Errors
    /// If the state was saved by rules with another lidar, other draws, or another planner.
    pub(crate) fn with_state(mdp: Arc<Mdp>, state: NavigatorState) -> Result<Self, EnvError> {
        let n_beams = mdp.robot.lidar.beam_angles().len();
        let (own_planner, n_drawn) = (mdp.planner()?, mdp.randomizer.paths().count());
        for (what, found, expected) in [
            ("beams a scan", state.before.scan.len(), n_beams),
            ("beams a scan", state.after.scan.len(), n_beams),
            ("numbers drawn anew each episode", state.drawn.len(), n_drawn),
            ("planners over scans", usize::from(state.planner.is_some()), usize::from(own_planner.is_some())),
        ] {
            if found != expected {
                return Err(EnvError::StateMismatch { what, found, expected });
            }
        }
        if state.planner.as_ref().map(|planner| planner.spec()) != own_planner.as_ref().map(|planner| planner.spec()) {
            return Err(EnvError::OtherPlanner);
        }
        let robot = mdp.robot_of(&state.drawn)?;
        Ok(Self { mdp, robot, state })
    }

    /// Length of the path driven in the last step, metres.
    #[must_use]
    pub fn step_distance(&self) -> f64 {
        self.state.distance
    }

    /// How much nearer the last step came to the goal that was in force, metres; negative if it went away from it.
    #[must_use]
    pub fn step_progress(&self) -> f64 {
        self.state.before.goal_distance - self.state.after.goal_distance
    }

    /// Duration of the last step, seconds: the control period, or the time up to a collision.
    #[must_use]
    pub fn step_duration(&self) -> f64 {
        self.state.duration
    }
}

impl NavigatorState {
    /// At rest at the start of scenario number `index` of a seed, before the first look.
    fn at_start(
        robot: &Robot,
        scenario: Scenario,
        route: Option<Route>,
        [seed, index]: [u64; 2],
        drawn: Vec<f64>,
        Memory { planner, history, facts: [before, after] }: Memory,
    ) -> Self {
        let mut drift = stream(seed, "odometry", index);
        Self {
            goal: scenario.goal,
            route,
            planner,
            movers: Vec::new(),
            vehicle: VehicleState::at_rest(scenario.start),
            odometry: Odometry::new(&robot.odometry, scenario.start, &mut drift),
            history,
            drawn,
            scenario,
            before,
            after,
            command: Command::default(),
            event: None,
            distance: 0.0,
            duration: 0.0,
            n_steps: 0,
            noise: stream(seed, "noise", index),
            motion: stream(seed, "motion", index),
            drift,
            goals: stream(seed, "goals", index),
        }
    }

    /// What a next episode takes over, emptied of this one.
    fn take_memory(&mut self) -> Memory {
        let mut planner = self.planner.take();
        planner.iter_mut().for_each(|planner| planner.reset());
        let mut history = std::mem::take(&mut self.history);
        history.clear();
        Memory { planner, history, facts: [&mut self.before, &mut self.after].map(Facts::take) }
    }

    /// Drives for a control period; a crowd moves along.
    fn step(&mut self, vehicle: &Vehicle, command: Command) -> Motion {
        let Scenario { world, crowd, .. } = &mut self.scenario;
        let Some(crowd) = crowd else { return vehicle.step(world, &mut self.vehicle, command) };
        vehicle.step_among(world, &mut self.vehicle, command, crowd)
    }

    /// Sees where the crowd is.
    fn track(&mut self) {
        let Some(crowd) = &self.scenario.crowd else { return };
        let believed = self.odometry.pose() * self.vehicle.pose.inverse();
        let seen = |mover: &Mover| Mover {
            position: believed * mover.position,
            velocity: believed * mover.velocity,
            radius: mover.radius,
        };
        self.movers.clear();
        self.movers.extend(crowd.movers().iter().map(seen));
    }

    /// Distance to the goal, metres, and its bearing in the vehicle's frame, radians, from where the vehicle really is.
    fn goal_polar(&self) -> (f64, f64) {
        let to_goal = self.vehicle.pose.inverse_transform_point(&self.goal).coords;
        (to_goal.norm(), to_goal.y.atan2(to_goal.x))
    }
}

impl Facts {
    /// The same memory, emptied of what it held but for the scan.
    fn take(&mut self) -> Self {
        Self { scan: std::mem::take(&mut self.scan), ..Self::new(0) }
    }

    fn new(n_beams: usize) -> Self {
        Self {
            speed: 0.0,
            yaw_rate: 0.0,
            goal_distance: 0.0,
            goal_bearing: 0.0,
            clearance: 0.0,
            obstacle_angle: None,
            scan: vec![0.0; n_beams],
        }
    }

    fn as_state<'a>(&'a self, beam_angles: &'a [f64]) -> State<'a> {
        State {
            speed: self.speed,
            yaw_rate: self.yaw_rate,
            goal_distance: self.goal_distance,
            goal_bearing: self.goal_bearing,
            clearance: self.clearance,
            obstacle_angle: self.obstacle_angle,
            scan: &self.scan,
            beam_angles,
        }
    }
}
