//! The checked MDP.

use std::sync::Arc;

use headway_planning::{GridMap, Route, ScanPlanner, plan};
use headway_reward::{Limits, Reward};
use headway_sensors::Lidar;
use headway_sensors::ObstacleAngle;
use headway_sim::{Point, Scenario, Vehicle, World, WorldSource};

use crate::randomize::Randomizer;
use crate::robot::Robot;
use crate::{ActionSet, Control, Encoder, EnvError, GoalHandling, NavSpec, RouteSource};

/// A navigation MDP, checked once and shared by all who act in it.
#[derive(Debug, Clone)]
pub struct Mdp {
    pub(crate) source: WorldSource,
    /// The one that drivers know; what drives differs from it where numbers are randomised.
    pub(crate) robot: Arc<Robot>,
    pub(crate) randomizer: Randomizer,
    pub(crate) obstacle_angle: ObstacleAngle,
    pub(crate) encoder: Encoder,
    pub(crate) actions: ActionSet,
    pub(crate) reward: Arc<dyn Reward>,
    pub(crate) goal: GoalHandling,
    pub(crate) reach_radius: f64,
    pub(crate) n_max_steps: u32,
    pub(crate) route: RouteSource,
    pub(crate) control: Control,
    pub(crate) limits: Limits,
}

impl NavSpec {
    /// Checks every table and builds the MDP.
    ///
    /// # Errors
    /// Names the first field that is not allowed, with its table, or says what in the world cannot be
    /// placed.
    pub fn build(&self) -> Result<Arc<Mdp>, EnvError> {
        let robot = Robot::build(&self.vehicle, &self.lidar, &self.odometry)?;
        let source = self.world.build(robot.vehicle.footprint())?;
        let env = &self.env;
        env.check().map_err(|e| e.under("env"))?;
        let encoder = Encoder::new(&env.observation, &robot.lidar, &robot.vehicle);
        let actions = env.actions.build(&self.vehicle, &env.control, env.observation.mirror);
        self.reward.validate()?;
        Ok(Arc::new(Mdp {
            encoder: encoder.map_err(|e| e.under("env.observation"))?,
            obstacle_angle: env.obstacle_angle.build().map_err(|e| e.under("env.obstacle_angle"))?,
            actions: actions.map_err(|e| e.under("env.actions"))?,
            reward: Arc::clone(&self.reward),
            goal: env.goal,
            reach_radius: env.reach_radius,
            n_max_steps: (env.time_limit / self.vehicle.control_period).round().max(1.0) as u32,
            limits: Limits {
                max_speed: self.vehicle.max_speed,
                max_yaw_rate: self.vehicle.max_yaw_rate,
                max_acceleration: self.vehicle.max_acceleration,
                max_yaw_acceleration: self.vehicle.max_yaw_acceleration,
            },
            source,
            randomizer: Randomizer::new(self)?,
            robot: Arc::new(robot),
            route: env.route.clone(),
            control: env.control,
        }))
    }
}

impl Mdp {
    /// Numbers in an observation.
    #[must_use]
    pub fn obs_dim(&self) -> usize {
        self.encoder.obs_dim()
    }

    /// What actions mean.
    #[must_use]
    pub fn actions(&self) -> &ActionSet {
        &self.actions
    }

    /// The vehicle that drives.
    #[must_use]
    pub fn vehicle(&self) -> &Vehicle {
        &self.robot.vehicle
    }

    /// What the vehicle sees with.
    #[must_use]
    pub fn lidar(&self) -> &Lidar {
        &self.robot.lidar
    }

    /// How observations are encoded.
    #[must_use]
    pub fn encoder(&self) -> &Encoder {
        &self.encoder
    }

    /// Where scenarios come from.
    #[must_use]
    pub fn source(&self) -> &WorldSource {
        &self.source
    }

    /// Distance to the goal at which it counts as reached, metres.
    #[must_use]
    pub fn reach_radius(&self) -> f64 {
        self.reach_radius
    }

    /// A route over the true map, where there is to be one: the one that keeps the margin, or else half of it, or none.
    ///
    /// A scenario's ends are joined by a path with clearance; cells of a grid lie within 0.71 of their edge from it.
    pub(crate) fn plan_route(&self, world: &World, from: &Point, goal: &Point) -> Result<Option<Route>, EnvError> {
        let RouteSource::TrueMap(spec) = &self.route else { return Ok(None) };
        let room = world.room();
        if !GridMap::fits(&room, spec.cell) {
            return Err(EnvError::MapTooLarge { cell: spec.cell, width: room.width, height: room.height });
        }
        let clearances = [spec.margin, spec.margin / 2.0, 0.0, -0.71 * spec.cell].map(|m| (self.radius() + m).max(0.0));
        let route = clearances.iter().find_map(|clearance| shortest_route(world, from, goal, *clearance, spec.cell));
        route.map(Some).ok_or(EnvError::NoRoute { from: [from.x, from.y], goal: [goal.x, goal.y], cell: spec.cell })
    }

    /// [`Self::plan_route`] from a scenario's start to its goal.
    pub(crate) fn route_of(&self, scenario: &Scenario) -> Result<Option<Route>, EnvError> {
        self.plan_route(&scenario.world, &scenario.start.translation.vector.into(), &scenario.goal)
    }

    /// The length of a short way from one point to another for a disc of the footprint's circumradius, metres, at most a few
    /// per cent above the shortest: planned over a grid of 10 cm, or more in the largest worlds, and pulled straight.
    #[must_use]
    pub fn geodesic(&self, world: &World, from: &Point, to: &Point) -> f64 {
        let world = &world.without_movers();
        if world.is_free(from, to, self.radius()) {
            return (to - from).norm();
        }
        // Coarser in a world of many square kilometres, so that its map fits in memory.
        let room = world.room();
        let cell = (room.width * room.height / f64::from(1 << 26)).sqrt().max(0.1);
        let route = shortest_route(world, from, to, self.radius(), cell)
            .or_else(|| shortest_route(world, from, to, (self.radius() - cell).max(0.0), cell));
        route.map_or((to - from).norm(), |route| route.length())
    }

    /// A planner over scans, where the route comes from one.
    pub(crate) fn planner(&self) -> Result<Option<Box<ScanPlanner>>, EnvError> {
        match &self.route {
            RouteSource::Scans(spec) => Ok(Some(Box::new(spec.build().map_err(|e| e.under("env.route"))?))),
            _ => Ok(None),
        }
    }

    /// What drives in scenario number `index` of a seed, and the numbers of it that were drawn.
    pub(crate) fn draw_robot(&self, seed: u64, index: u64) -> Result<(Arc<Robot>, Vec<f64>), EnvError> {
        let drawn = self.randomizer.draw(seed, index);
        Ok((self.robot_of(&drawn)?, drawn))
    }

    /// What drives with numbers that were drawn.
    pub(crate) fn robot_of(&self, drawn: &[f64]) -> Result<Arc<Robot>, EnvError> {
        if self.randomizer.is_idle() {
            return Ok(Arc::clone(&self.robot));
        }
        Ok(Arc::new(self.randomizer.build(drawn)?))
    }

    fn radius(&self) -> f64 {
        self.robot.vehicle.footprint().circumradius()
    }
}

fn shortest_route(world: &World, from: &Point, to: &Point, clearance: f64, cell: f64) -> Option<Route> {
    plan(&GridMap::from_world(world, cell, clearance), from, to)
}
