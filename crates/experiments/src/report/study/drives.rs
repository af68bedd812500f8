//! Episodes driven again: those that are shown, and those that tell the speed at each clearance.

use headway_env::{ActionSpec, Navigator};
use serde::Serialize;

use super::bands::Point;
use super::choice::Choice;
use super::clearance::{self, Meter, N_EPISODES};
use super::redrive::Evaluation;
use super::trace::{Recorder, Scene, Trace};
use crate::Error;
use crate::episode::{EpisodeRecord, Metric, Outcome};
use crate::evaluate::ScenarioSet;
use crate::plot::Trajectory;
use crate::report::RunRow;
use crate::store::{Id, RunFolder};

/// Why those are shown that were asked for.
pub(crate) const ASKED: &str = "asked for";

/// An episode that the page shows.
#[derive(Debug, Clone, Serialize)]
pub struct Drive {
    /// The row of the report that it belongs to.
    pub row: usize,
    /// The training seed.
    pub seed: u64,
    /// The number of the scenario.
    pub scenario: u64,
    /// Why it is shown.
    pub why: &'static str,
    /// How it ended.
    pub outcome: Outcome,
    /// Duration, s.
    pub duration: f64,
    /// Distance driven, m.
    pub distance: f64,
    /// Whether it went exactly as recorded when the run was evaluated.
    pub is_as_recorded: bool,
    /// Where.
    pub scene: Scene,
    /// How.
    pub trace: Trace,
    /// The set-points that could be chosen: speeds (m/s) and yaw rates (rad/s); none of what chooses freely.
    pub set_points: Option<[Vec<f64>; 2]>,
    /// The same as a figure needs it.
    #[serde(skip)]
    pub trajectory: Option<Trajectory>,
}

/// What driving again gave of one row of the report.
#[derive(Debug, Default)]
pub(crate) struct Driven {
    pub(crate) drives: Vec<Drive>,
    /// The mean speed over clearance.
    pub(crate) clearance: Vec<Point>,
    /// Number of episodes driven again, and of those that went otherwise than recorded.
    pub(crate) n_driven: usize,
    pub(crate) n_otherwise: usize,
}

/// One row of the report: a cell in one of its worlds.
#[derive(Debug, Clone)]
pub(super) struct Task<'a> {
    pub(super) row: usize,
    pub(super) runs: &'a [RunRow],
    /// The place of the world among the cell's.
    pub(super) world: usize,
    pub(super) name: &'a str,
    pub(super) eval_id: &'a Id,
    /// The cell's levels, joined by commas.
    pub(super) levels: String,
    pub(super) title: String,
}

impl Task<'_> {
    /// Drives again what the row shows.
    ///
    /// # Errors
    /// If a run cannot be set up as it was.
    pub(super) fn drive(&self, root: &std::path::Path, choice: &Choice, with: Trajectories) -> Result<Driven, Error> {
        let mut driven = Driven::default();
        let mut meters = Vec::new();
        for run in self.evaluated() {
            let folder = RunFolder::new(root, &run.train_id);
            let records = folder.evaluation(self.eval_id);
            let mut evaluation = Evaluation::of(&folder, &records)?;
            let records = records.episodes()?;
            let mut meter = Meter::default();
            let first = ScenarioSet::part(&evaluation.mdp, 0..N_EPISODES.min(records.len()), evaluation.seed)?;
            for record in &records[..first.len()] {
                let mut is_start = true;
                let again = evaluation.drive(&first, record, |vehicle| {
                    meter.push(vehicle, is_start);
                    is_start = false;
                })?;
                driven.count(again == *record);
            }
            meters.push(meter);
            for (why, record) in self.shown(choice, run.seed, &records) {
                let drive = self.show(&mut evaluation, run.seed, why, record, with)?;
                driven.count(drive.is_as_recorded);
                driven.drives.push(drive);
            }
        }
        driven.clearance = clearance::curve(&meters);
        Ok(driven)
    }

    /// The runs that were evaluated in the world.
    pub(super) fn evaluated(&self) -> impl Iterator<Item = &RunRow> {
        self.runs.iter().filter(|run| run.summaries[self.world].1.is_some())
    }

    /// The share of an outcome among the row's episodes, averaged over the seeds.
    fn share(&self, outcome: Outcome) -> f64 {
        let summaries = self.evaluated().filter_map(|run| run.summaries[self.world].1);
        let shares: Vec<f64> = summaries.filter_map(|summary| Metric::share_of(outcome).of(&summary)).collect();
        shares.iter().sum::<f64>() / shares.len().max(1) as f64
    }

    /// The episodes of a seed that are shown, and why: those of the typical seed by the rule, then those asked for.
    pub(super) fn shown<'a>(
        &self,
        choice: &Choice,
        seed: u64,
        records: &'a [EpisodeRecord],
    ) -> Vec<(&'static str, &'a EpisodeRecord)> {
        let typical = Choice::typical_run(self.runs, self.world).map(|run| run.seed);
        let mut shown =
            if typical == Some(seed) { choice.of_episodes(records, |outcome| self.share(outcome)) } else { Vec::new() };
        let here =
            choice.asked.iter().filter(|pick| pick.is_of(&self.levels) && pick.world == self.name && pick.seed == seed);
        let record = |scenario: u64| records.iter().find(|record| record.scenario == scenario);
        shown.extend(here.filter_map(|pick| Some((ASKED, record(pick.scenario)?))));
        shown
    }

    fn show(
        &self,
        evaluation: &mut Evaluation,
        seed: u64,
        why: &'static str,
        record: &EpisodeRecord,
        with: Trajectories,
    ) -> Result<Drive, Error> {
        let number = usize::try_from(record.scenario).map_err(Error::failure)?;
        let set = ScenarioSet::part(&evaluation.mdp, number..number + 1, evaluation.seed)?;
        let mut recording: Option<(Scene, Recorder)> = None;
        let mdp = std::sync::Arc::clone(&evaluation.mdp);
        let again = evaluation.drive(&set, record, |vehicle| {
            let start = || (Scene::new(&mdp, vehicle.scenario()), Recorder::new(&mdp, vehicle.scenario()));
            recording.get_or_insert_with(start).1.push(vehicle);
        })?;
        let (scene, recorder) = recording.expect("the start is seen in any case");
        let title = || format!("{}, seed {seed}, scenario {number}", self.title);
        let trajectory =
            (with == Trajectories::Kept).then(|| set.trajectory(&mdp, &mut *evaluation.driver, number, title()));
        Ok(Drive {
            row: self.row,
            seed,
            scenario: record.scenario,
            why,
            outcome: again.outcome,
            duration: again.duration,
            distance: again.distance,
            is_as_recorded: again == *record,
            scene,
            trace: recorder.finish(),
            set_points: evaluation.set_points(),
            trajectory: trajectory.transpose()?,
        })
    }
}

/// What becomes of each drive's [`Trajectory`], which figures in files need and pages do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trajectories {
    /// They are kept.
    Kept,
    /// They are dropped.
    Dropped,
}

impl Driven {
    fn count(&mut self, is_as_recorded: bool) {
        self.n_driven += 1;
        self.n_otherwise += usize::from(!is_as_recorded);
    }
}

impl Evaluation {
    pub(super) fn drive(
        &mut self,
        set: &ScenarioSet,
        record: &EpisodeRecord,
        watch: impl FnMut(&Navigator),
    ) -> Result<EpisodeRecord, Error> {
        let number = usize::try_from(record.scenario).map_err(Error::failure)?;
        set.drive(&self.mdp, &mut *self.driver, number, watch)
    }

    /// The set-points that a learned policy chooses among.
    fn set_points(&self) -> Option<[Vec<f64>; 2]> {
        match &self.spec.env.actions {
            ActionSpec::SetPoints { speeds, yaw_rates, lateral_speeds }
                if self.spec.policy.is_learned() && *lateral_speeds == [0.0] =>
            {
                Some([speeds.clone(), yaw_rates.clone()])
            }
            _ => None,
        }
    }
}
