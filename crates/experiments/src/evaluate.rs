//! Evaluation: drivers on held-out scenarios, one goal an episode.

mod drawing;

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use headway_env::{EnvSpec, Event, Mdp, NavSpec, Navigator, StepEnd};
use headway_planning::{Controller, Interventions};
use headway_policy::{Driver, Policy};
use headway_sim::{Point, Scenario, stream_seed};

use crate::Error;
use crate::episode::{EpisodeMeter, EpisodeRecord, Outcome, Sample};
use crate::plot::Trajectory;

pub(crate) use drawing::draw;

/// Half the opening of the cone that must be clear for a deceleration to be needless, radians.
const CONE: f64 = PI / 6.0;

/// Held-out scenarios of one world: the same for every driver, whatever it was trained with.
#[derive(Debug)]
pub struct ScenarioSet {
    seed: u64,
    /// The number of the first of them.
    first: usize,
    /// Each scenario with the length of its shortest way to the edge of the goal's disc, metres.
    scenarios: Vec<(Scenario, f64)>,
}

impl ScenarioSet {
    /// The first `n_episodes` scenarios of a seed.
    ///
    /// They come from a random stream that no training draws from, even if the seeds are equal.
    ///
    /// # Errors
    /// If a scenario cannot be made.
    pub fn new(mdp: &Mdp, n_episodes: usize, seed: u64) -> Result<Self, Error> {
        Self::part(mdp, 0..n_episodes, seed)
    }

    /// Some of the scenarios of a seed, by number: a whole set may be made in parts, side by side.
    pub(crate) fn part(mdp: &Mdp, numbers: Range<usize>, seed: u64) -> Result<Self, Error> {
        let seed = stream_seed(seed, "evaluate", 0);
        let make = |index| {
            let scenario = mdp.source().scenario(seed, index).map_err(Error::failure)?;
            let start = Point::from(scenario.start.translation.vector);
            let way = mdp.geodesic(&scenario.world, &start, &scenario.goal) - mdp.reach_radius();
            Ok((scenario, way.max(0.0)))
        };
        let first = numbers.start;
        let scenarios = numbers.map(|number| make(number as u64)).collect::<Result<_, Error>>()?;
        Ok(Self { seed, first, scenarios })
    }

    /// Adds the part that follows.
    pub(crate) fn append(&mut self, next: Self) {
        self.scenarios.extend(next.scenarios);
    }

    /// How many scenarios there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.scenarios.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.scenarios.is_empty()
    }

    /// One episode in scenario number `index`: its record; `watch` sees every state, the start included.
    ///
    /// # Errors
    /// If there is no such scenario.
    pub fn drive(
        &self,
        mdp: &Arc<Mdp>,
        driver: &mut dyn Controller,
        index: usize,
        mut watch: impl FnMut(&Navigator),
    ) -> Result<EpisodeRecord, Error> {
        let (scenario, geodesic) = self.get(index).ok_or_else(|| self.no_episode(index))?;
        let mut vehicle = Navigator::in_scenario(Arc::clone(mdp), scenario.clone(), self.seed, index as u64)
            .map_err(Error::failure)?;
        let mut meter = EpisodeMeter::new(mdp.vehicle().spec().max_acceleration);
        driver.reset();
        let before = driver.interventions();
        watch(&vehicle);
        loop {
            let free_range = vehicle.scenario().world.sector_range(&vehicle.vehicle().pose, CONE);
            let command = driver.command(&vehicle.sensed());
            let end = vehicle.drive(command).map_err(Error::failure)?;
            let step = vehicle.transition();
            meter.push(&Sample {
                speed_before: step.before.speed,
                speed_after: step.after.speed,
                dt: vehicle.step_duration(),
                distance: vehicle.step_distance(),
                clearance: step.before.clearance,
                free_range,
            });
            watch(&vehicle);
            if let Some(outcome) = outcome(&end) {
                let drawn: Vec<String> = vehicle.drawn().map(|(path, number)| format!("{path}={number}")).collect();
                let record = meter.finish(index as u64, outcome, *geodesic);
                let Interventions { n_commands, n_vetoes, n_stops } = driver.interventions().since(before);
                return Ok(EpisodeRecord {
                    drawn: drawn.join(" "),
                    n_shielded: n_commands,
                    n_vetoes,
                    n_stops,
                    ..record
                });
            }
        }
    }

    /// All episodes, in the order of the scenarios.
    ///
    /// # Errors
    /// If the environment fails.
    pub fn drive_all(&self, mdp: &Arc<Mdp>, driver: &mut dyn Controller) -> Result<Vec<EpisodeRecord>, Error> {
        (self.first..self.first + self.len()).map(|index| self.drive(mdp, driver, index, |_| ())).collect()
    }

    /// One episode as a picture needs it.
    ///
    /// # Errors
    /// If there is no such scenario.
    pub fn trajectory(
        &self,
        mdp: &Arc<Mdp>,
        driver: &mut dyn Controller,
        index: usize,
        title: String,
    ) -> Result<Trajectory, Error> {
        let Some((scenario, _)) = self.get(index) else {
            return Err(self.no_episode(index));
        };
        draw(mdp, scenario, title, |watch| Ok(self.drive(mdp, driver, index, watch)?.outcome))
    }

    /// A scenario, by its number.
    fn get(&self, index: usize) -> Option<&(Scenario, f64)> {
        self.scenarios.get(index.checked_sub(self.first)?)
    }

    fn no_episode(&self, index: usize) -> Error {
        Error::Input(format!("there is no episode {index}: there are {}, counted from {}", self.len(), self.first))
    }
}

fn outcome(end: &StepEnd) -> Option<Outcome> {
    match end.event {
        Some(Event::Collision) => Some(Outcome::Collision),
        Some(Event::Reach) => Some(Outcome::Success),
        None => end.truncated.then_some(Outcome::Timeout),
    }
}

/// The decision process that a policy drives in, and the policy as its driver: the world, the goal and the time limit of
/// `rules`, and all else as in the policy's own header.
///
/// # Errors
/// If the policy was made for another vehicle or lidar than `rules` have.
pub fn for_policy(mut rules: NavSpec, policy: &Arc<Policy>) -> Result<(Arc<Mdp>, Driver), Error> {
    let driver = Driver::new(Arc::clone(policy), &rules.vehicle, &rules.lidar);
    let driver = driver.map_err(|error| Error::Input(error.to_string()))?;
    adapt(&mut rules.env, policy);
    Ok((rules.build().map_err(Error::failure)?, driver))
}

/// Replaces what a policy brings along.
pub(crate) fn adapt(env: &mut EnvSpec, policy: &Policy) {
    let header = policy.header();
    env.control = header.control;
    env.actions = header.actions.clone();
    env.observation = header.observation.clone();
    env.route = header.route.clone();
}
