//! The protocol of the BARN challenge (Perille, Truong, Xiao, Stone 2020; Xiao et al. 2022, "Autonomous Ground Navigation in
//! Highly Constrained Spaces"), in this crate's simulator.
//!
//! A vehicle starts at (-2, 3) m, facing +y, and is to go 10 m ahead. A run is a success within 1 m of the goal, a collision on
//! contact, and a timeout 100 s after its start. The clock starts when the vehicle is 0.1 m from where it stood; if that does
//! not happen within 100 s, the run is a timeout, too. All of this is looked at once per control period.
//!
//! What Gazebo does and this simulator does not (tyres that skid, a controller that runs late) is not part of the
//! protocol: results are comparable among each other, and with those from Gazebo only as far as the vehicle's table makes
//! up for that.

mod chance;
mod clock;
mod conditions;
mod course;
mod over_worlds;
mod reference;
mod score;
mod summary;
mod table;

use std::f64::consts::FRAC_PI_2;
use std::num::NonZeroUsize;
use std::sync::Arc;

use headway_env::{Mdp, NavSpec, Navigator};
use headway_planning::{Controller, Interventions};
use headway_sim::SimError;

use crate::Error;
use crate::candidate::Candidate;
use crate::episode::Outcome;
use crate::jobs::{self, Display, Job};
use crate::plot::Trajectory;
use clock::Clock;

pub use chance::is_random;
pub use conditions::{Conditions, Vehicle};
pub use course::{Course, World, worlds};
pub use over_worlds::OverWorlds;
pub use reference::{Reference, Source};
pub use score::Clip;
pub use summary::{Intervals, Measure, Report, Row};

/// Where the vehicle starts: x and y, metres, and yaw, radians.
pub const START: [f64; 3] = [-2.0, 3.0, FRAC_PI_2];
/// Where it is to go, metres.
pub const GOAL: [f64; 2] = [-2.0, 13.0];
/// Distance to the goal at which it counts as reached, metres.
pub const REACH_RADIUS: f64 = 1.0;
/// Time after which a run ends, seconds.
pub const TIME_LIMIT: f64 = 100.0;
/// Distance from the start at which the clock starts, metres.
pub const CLOCK_DISTANCE: f64 = 0.1;

/// How one run ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// How.
    pub outcome: Outcome,
    /// Time from the start of the clock, seconds; 0 if that never started.
    pub time: f64,
    /// How often a shield stepped in, before the clock started too; zeros where there was none.
    pub interventions: Interventions,
}

/// Run number `index` of a seed: noise, actuation and odometry have random streams of their own. `watch` sees every state, the
/// start included.
///
/// # Errors
/// If the environment fails.
pub fn drive(
    mdp: &Arc<Mdp>,
    driver: &mut dyn Controller,
    seed: u64,
    index: u64,
    mut watch: impl FnMut(&Navigator),
) -> Result<Run, Error> {
    let mut vehicle = Navigator::new(Arc::clone(mdp), seed, index).map_err(Error::failure)?;
    let mut clock = Clock::default();
    driver.reset();
    let before = driver.interventions();
    watch(&vehicle);
    loop {
        let command = driver.command(&vehicle.sensed());
        let end = vehicle.drive(command).map_err(Error::failure)?;
        watch(&vehicle);
        let from_start = vehicle.vehicle().pose.translation.vector - vehicle.scenario().start.translation.vector;
        if let Some(run) = clock.step(vehicle.step_duration(), from_start.norm(), &end) {
            return Ok(Run { interventions: driver.interventions().since(before), ..run });
        }
    }
}

/// How a whole evaluation is made.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    /// Runs in each world.
    pub n_runs: NonZeroUsize,
    /// The seed of all random streams; run k of every world has the streams of number k.
    pub seed: u64,
    /// Threads; they change nothing but the time it takes.
    pub n_jobs: NonZeroUsize,
}

impl Plan {
    /// The same with one run in each world where nothing is random: all others would be copies of it, and intervals would count
    /// them.
    #[must_use]
    pub fn without_copies(self, conditions: &NavSpec) -> Self {
        if is_random(conditions) { self } else { Self { n_runs: NonZeroUsize::MIN, ..self } }
    }
}

/// Drives all courses: the runs of each, in order.
///
/// # Errors
/// If the candidate cannot drive this vehicle, or the environment fails.
pub fn evaluate(
    courses: &[Course],
    candidate: &Candidate,
    plan: &Plan,
    display: Display,
) -> Result<Vec<Vec<Run>>, Error> {
    let n_runs = plan.n_runs.get();
    let runs = courses.iter().flat_map(|course| (0..n_runs as u64).map(move |k| (&course.mdp, k)));
    let runs: Vec<_> = runs.map(|input| Job { input, work: 1 }).collect();
    let runs = jobs::run(&runs, plan.n_jobs, display, |(mdp, k), _| {
        drive(mdp, &mut *candidate.driver(mdp)?, plan.seed, *k, |_| ())
    })?;
    Ok(runs.chunks(n_runs).map(<[Run]>::to_vec).collect())
}

/// One run as a picture needs it.
///
/// # Errors
/// As [`drive`] and [`evaluate`].
pub fn trajectory(course: &Course, candidate: &Candidate, seed: u64, index: u64) -> Result<Trajectory, Error> {
    let mdp = &course.mdp;
    let mut driver = candidate.driver(mdp)?;
    let scenario = mdp.source().scenario(seed, index).map_err(|error: SimError| Error::failure(error))?;
    crate::evaluate::draw(mdp, &scenario, format!("{}, run {index}", course.world.name), |watch| {
        Ok(drive(mdp, &mut *driver, seed, index, watch)?.outcome)
    })
}
