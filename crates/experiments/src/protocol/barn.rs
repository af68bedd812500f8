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

mod reference;
mod score;
mod summary;

use std::f64::consts::FRAC_PI_2;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use headway_env::{Event, GoalHandling, Mdp, NavSpec, Navigator, StepEnd};
use headway_planning::Controller;
use headway_sim::{FilesSpec, SimError, WorldSpec, files};

use crate::Error;
use crate::candidate::Candidate;
use crate::episode::Outcome;
use crate::jobs::{self, Display, Job};
use crate::plot::Trajectory;

pub use reference::{Origin, Reference};
pub use score::Clip;
pub use summary::{Report, Row};

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

/// One of the worlds, with what its runs are measured by.
#[derive(Debug)]
pub struct World {
    /// The file's name without its ending.
    pub name: String,
    /// The shortest way.
    pub reference: Reference,
    path: PathBuf,
}

/// How one run ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// How.
    pub outcome: Outcome,
    /// Time from the start of the clock, seconds; 0 if that never started.
    pub time: f64,
}

/// The world files of a folder, or of its folder `worlds`, each with its reference path.
///
/// The path of `world_N` is `path_N.npy` in `folder/../paths` or `folder/paths`; where there is none, one is planned.
///
/// # Errors
/// If there is no world file or one cannot be read; if a path file is there and holds no path.
pub fn worlds(folder: &Path) -> Result<Vec<World>, Error> {
    let input = |error: files::FileError| Error::Input(error.to_string());
    if !folder.is_dir() {
        return Err(Error::Input(format!("--worlds {}: there is no such folder", folder.display())));
    }
    let mut paths = files::list(folder).map_err(input)?;
    if paths.is_empty() && folder.join("worlds").is_dir() {
        paths = files::list(&folder.join("worlds")).map_err(input)?;
    }
    if paths.is_empty() {
        return Err(Error::Input(format!(
            "--worlds {}: neither it nor a folder `worlds` in it holds world files (*.world, *.sdf, *.yaml)",
            folder.display()
        )));
    }
    let world = |path: PathBuf| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let reference = Reference::find(&name, folder, path.parent().unwrap_or(folder))?;
        Ok(World { name, reference, path })
    };
    paths.into_iter().map(world).collect()
}

impl World {
    /// The decision process of a run in this world under given conditions: their vehicle, lidar and route, and the protocol's
    /// start, goal and ends.
    ///
    /// # Errors
    /// If the file cannot be read, or the vehicle does not fit the start.
    pub fn rules(&self, conditions: &NavSpec) -> Result<NavSpec, Error> {
        let [x, y, yaw] = START;
        let files = FilesSpec {
            paths: vec![self.path.clone()],
            start: Some([x, y, yaw]),
            goal: Some(GOAL),
            ..FilesSpec::default()
        };
        let mut rules = NavSpec { world: WorldSpec::Files(files), ..conditions.clone() };
        rules.env.goal = GoalHandling::Terminate;
        rules.env.reach_radius = REACH_RADIUS;
        // The clock of `drive` is the one that counts; this one, which starts at once, comes after it.
        rules.env.time_limit = 2.0 * TIME_LIMIT + 1.0;
        Ok(rules)
    }
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
    watch(&vehicle);
    loop {
        let command = driver.command(&vehicle.sensed());
        let end = vehicle.drive(command).map_err(Error::failure)?;
        watch(&vehicle);
        let from_start = vehicle.vehicle().pose.translation.vector - vehicle.scenario().start.translation.vector;
        if let Some(run) = clock.step(vehicle.step_duration(), from_start.norm(), &end) {
            return Ok(run);
        }
    }
}

/// The protocol's clock.
#[derive(Debug, Default)]
struct Clock {
    is_running: bool,
    /// Since it began to run, or before that, since the vehicle was placed.
    time: f64,
}

impl Clock {
    /// Goes on by a step that ended at some distance from the start; the run, if that was its end.
    fn step(&mut self, duration: f64, from_start: f64, end: &StepEnd) -> Option<Run> {
        /// Times are sums of control periods: this much apart, they are the same.
        const SAME_TIME: f64 = 1e-6;
        self.time += duration;
        if !self.is_running && from_start >= CLOCK_DISTANCE {
            (self.is_running, self.time) = (true, 0.0);
        }
        let outcome = match end.event {
            Some(Event::Collision) => Outcome::Collision,
            Some(Event::Reach) => Outcome::Success,
            None if self.time > TIME_LIMIT - SAME_TIME || end.truncated => Outcome::Timeout,
            None => return None,
        };
        Some(Run { outcome, time: if self.is_running { self.time } else { 0.0 } })
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

/// Drives in all worlds: the runs of each, in order.
///
/// # Errors
/// If the vehicle does not fit a start, or the environment fails.
pub fn evaluate(
    worlds: &[World],
    candidate: &Candidate,
    conditions: &NavSpec,
    plan: &Plan,
    display: Display,
) -> Result<Vec<Vec<Run>>, Error> {
    let mdps: Vec<_> = worlds.iter().map(|world| Job { input: world, work: 1 }).collect();
    let mdps = jobs::run(&mdps, plan.n_jobs, Display::Silent, |world, _| mdp(world, conditions))?;
    let n_runs = plan.n_runs.get();
    let runs: Vec<_> = mdps.iter().flat_map(|mdp| (0..n_runs as u64).map(move |k| (mdp, k))).collect();
    let runs: Vec<_> = runs.into_iter().map(|input| Job { input, work: 1 }).collect();
    let runs = jobs::run(&runs, plan.n_jobs, display, |(mdp, k), _| {
        drive(mdp, &mut *candidate.driver(mdp)?, plan.seed, *k, |_| ())
    })?;
    Ok(runs.chunks(n_runs).map(<[Run]>::to_vec).collect())
}

fn mdp(world: &World, conditions: &NavSpec) -> Result<Arc<Mdp>, Error> {
    let built = world.rules(conditions)?.build();
    built.map_err(|error| Error::Input(format!("{}: {error}", world.path.display())))
}

/// One run as a picture needs it.
///
/// # Errors
/// As [`drive`] and [`evaluate`].
pub fn trajectory(
    world: &World,
    candidate: &Candidate,
    conditions: &NavSpec,
    seed: u64,
    index: u64,
) -> Result<Trajectory, Error> {
    let mdp = mdp(world, conditions)?;
    let mut driver = candidate.driver(&mdp)?;
    let scenario = mdp.source().scenario(seed, index).map_err(|error: SimError| Error::failure(error))?;
    crate::evaluate::draw(&mdp, &scenario, format!("{}, run {index}", world.name), |watch| {
        Ok(drive(&mdp, &mut *driver, seed, index, watch)?.outcome)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ON: StepEnd = StepEnd { reward: 0.0, event: None, terminated: false, truncated: false };

    #[test]
    fn the_clock_starts_when_the_vehicle_has_moved() {
        let mut clock = Clock::default();
        assert_eq!(clock.step(7.0, 0.05, &ON), None);
        assert_eq!(clock.step(1.0, 0.1, &ON), None);
        assert_eq!(clock.step(2.0, 0.05, &ON), None, "it goes on");
        let reached = StepEnd { event: Some(Event::Reach), ..ON };
        assert_eq!(clock.step(0.5, 9.0, &reached), Some(Run { outcome: Outcome::Success, time: 2.5 }));
    }

    #[test]
    fn a_vehicle_that_never_moves_times_out_and_one_that_does_has_all_its_time() {
        let mut clock = Clock::default();
        assert_eq!(clock.step(99.9, 0.0, &ON), None);
        assert_eq!(clock.step(0.1, 0.0, &ON), Some(Run { outcome: Outcome::Timeout, time: 0.0 }));
        let mut clock = Clock::default();
        assert_eq!(clock.step(99.0, 0.2, &ON), None);
        assert_eq!(clock.step(99.9, 5.0, &ON), None);
        assert_eq!(clock.step(0.1, 5.0, &ON), Some(Run { outcome: Outcome::Timeout, time: 100.0 }));
    }
}
