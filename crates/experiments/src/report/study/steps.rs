//! The control steps of chosen episodes, driven again.

use std::path::Path;

use headway_env::{ActionSet, Navigator, Side};
use headway_sim::Command;

use super::drives::Task;
use super::redrive::Evaluation;
use super::{Choice, again, asked, groups};
use crate::Error;
use crate::episode::EpisodeRecord;
use crate::evaluate::ScenarioSet;
use crate::report::Report;
use crate::store::{Index, RunFolder};

/// An episode that was driven again, step by step.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveSteps {
    /// The row of the report that it belongs to.
    pub row: usize,
    /// The training seed.
    pub seed: u64,
    /// The number of the scenario.
    pub scenario: u64,
    /// Why it was chosen.
    pub why: &'static str,
    /// Whether it went exactly as recorded when the run was evaluated.
    pub is_as_recorded: bool,
    /// Its states, one at the start of each control step and one at the end of the last.
    pub steps: Vec<ControlStep>,
}

/// A true state of a drive at the start of a control step, and what was commanded in it. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlStep {
    /// Time since the start of the episode, s.
    pub t: f64,
    /// Position of the vehicle's origin, m.
    pub x: f64,
    /// Position of the vehicle's origin, m.
    pub y: f64,
    /// Heading, rad, in (-pi, pi], counter-clockwise from the x axis.
    pub yaw: f64,
    /// Forward speed, m/s.
    pub speed: f64,
    /// Leftward speed, m/s; 0 of vehicles that cannot move sideways.
    pub lateral_speed: f64,
    /// Yaw rate, rad/s, positive to the left.
    pub yaw_rate: f64,
    /// Distance from the footprint to the nearest obstacle or wall, m.
    pub clearance: f64,
    /// What was commanded for the step; none at the end of the episode.
    pub command: Option<Command>,
    /// The action that means this command; none if the driver does not choose among actions, or a shield braked instead with a
    /// command that is none of them.
    pub action: Option<u32>,
}

/// The episodes of the results folder at `root` that `choice` names, driven again, on all cores, and reasons to distrust them;
/// `report` is that on the folder.
///
/// What cannot be driven again, for want of a world file, say, is left out, and a warning tells.
///
/// # Errors
/// If there is no index in the folder, or an episode is asked for that is not there.
///
/// ```
/// use headway_experiments::report::{Choice, of_policy, steps};
/// let report = of_policy(&[("room", Vec::new())]);
/// let missing = steps("no/results".as_ref(), &report, &Choice::default()).unwrap_err();
/// assert!(missing.to_string().contains("no/results"));
/// ```
pub fn steps(root: &Path, report: &Report, choice: &Choice) -> Result<(Vec<DriveSteps>, Vec<String>), Error> {
    let index = Index::load(root)?;
    asked::check(choice, &index, report)?;
    let cells = groups(&index);
    let (rows, mut warnings) = again::each(again::tasks(&index, &cells, report), |task| task.steps(root, choice))?;
    let drives: Vec<DriveSteps> = rows.into_iter().flatten().collect();
    let n_otherwise = drives.iter().filter(|drive| !drive.is_as_recorded).count();
    warnings.extend(again::otherwise(drives.len(), n_otherwise, "steps"));
    Ok((drives, warnings))
}

impl Task<'_> {
    /// Drives again what the row shows, each episode once.
    fn steps(&self, root: &Path, choice: &Choice) -> Result<Vec<DriveSteps>, Error> {
        let mut drives: Vec<DriveSteps> = Vec::new();
        for run in self.evaluated() {
            let folder = RunFolder::new(root, &run.train_id);
            let evaluation = folder.evaluation(self.eval_id);
            let records = evaluation.episodes()?;
            let shown = self.shown(choice, run.seed, &records);
            if shown.is_empty() {
                continue;
            }
            let mut evaluation = Evaluation::of(&folder, &evaluation)?;
            for (why, record) in shown {
                let is_there = |drive: &DriveSteps| (drive.seed, drive.scenario) == (run.seed, record.scenario);
                if !drives.iter().any(is_there) {
                    let (steps, again) = evaluation.steps(record)?;
                    let (scenario, is_as_recorded) = (record.scenario, again == *record);
                    drives.push(DriveSteps { row: self.row, seed: run.seed, scenario, why, is_as_recorded, steps });
                }
            }
        }
        Ok(drives)
    }
}

impl Evaluation {
    fn steps(&mut self, record: &EpisodeRecord) -> Result<(Vec<ControlStep>, EpisodeRecord), Error> {
        let number = usize::try_from(record.scenario).map_err(Error::failure)?;
        let set = ScenarioSet::part(&self.mdp, number..number + 1, self.seed)?;
        let (actions, mut recorder) = (self.actions().cloned(), Recorder::default());
        let again = self.drive(&set, record, |vehicle| recorder.push(vehicle, actions.as_ref()))?;
        Ok((recorder.steps, again))
    }
}

/// The steps of a drive as its states come in.
#[derive(Debug, Default)]
struct Recorder {
    steps: Vec<ControlStep>,
    /// The forward speed that the driver was told last, m/s.
    sensed_speed: f64,
}

impl Recorder {
    fn push(&mut self, vehicle: &Navigator, actions: Option<&ActionSet>) {
        let (state, sensed) = (vehicle.vehicle(), vehicle.sensed());
        let mut t = 0.0;
        if let Some(last) = self.steps.last_mut() {
            t = last.t + vehicle.step_duration();
            last.command = Some(sensed.last_command);
            last.action = actions.and_then(|actions| action(actions, sensed.last_command, self.sensed_speed));
        }
        self.sensed_speed = sensed.twist.x;
        self.steps.push(ControlStep {
            t,
            x: state.pose.translation.x,
            y: state.pose.translation.y,
            yaw: state.pose.rotation.angle(),
            speed: state.twist.x,
            lateral_speed: state.twist.y,
            yaw_rate: state.twist.z,
            clearance: vehicle.transition().after.clearance,
            command: None,
            action: None,
        });
    }
}

/// The number of the first action that means `command` for a vehicle at `speed`.
fn action(actions: &ActionSet, command: Command, speed: f64) -> Option<u32> {
    let n_actions = u32::try_from(actions.len()).expect("sets of actions are small");
    (0..n_actions).find(|action| actions.command(*action, speed, Side::AsSeen) == command)
}

#[cfg(test)]
mod tests {
    use headway_env::{ActionSpec, Control};
    use headway_sim::VehicleSpec;

    use super::*;

    #[test]
    fn commands_have_the_numbers_of_their_actions() {
        let actions = ActionSpec::default().build(&VehicleSpec::default(), &Control::Full {}, false).unwrap();
        for number in 0..12 {
            assert_eq!(action(&actions, actions.command(number, 0.0, Side::AsSeen), 0.0), Some(number));
        }
        assert_eq!(action(&actions, Command::new(0.7, 0.0), 0.0), None);
        let accelerate = ActionSpec::Accelerate { yaw_rates: vec![0.0] };
        let actions = accelerate.build(&VehicleSpec::default(), &Control::Full {}, false).unwrap();
        assert_eq!(action(&actions, Command::new(0.7, 0.0), 0.7), Some(1)); // keeps the speed
    }
}
