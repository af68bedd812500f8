//! Whether a plan may take the place of what a results folder holds.

use std::path::Path;

use toml::{Table, Value};

use super::{Plan, TrainTables, evaluation_key, labelled, seed_and_reward, train_id};
use crate::Error;
use crate::difference::in_words;
use crate::spec::{Cell, EvaluateWorld};
use crate::store::{
    self, AxisLevel, EvaluationFolder, EvaluationKey, Id, Index, IndexedEvaluation, RESULTS_VERSION, RunFolder,
    StoreError,
};

impl Plan<'_> {
    /// Whether the plan's index may take the place of the one in `folder`, which may not exist: whether every cell means
    /// what the cell of the same levels meant when it was run. More seeds, episodes, levels and worlds are welcome, and
    /// what never finished may be given up. Touches nothing.
    ///
    /// # Errors
    /// [`StoreError::OtherGrid`], [`Error::Input`] that says what differs, and trouble with reading the folder.
    pub(crate) fn check_against(&self, folder: &Path) -> Result<(), Error> {
        let held = match Index::load(folder) {
            Err(StoreError::NoFolder { .. } | StoreError::NoIndex { .. }) => return Ok(()),
            held => held?,
        };
        if held.name != self.index.name {
            let (held, given) = (held.name, self.index.name.clone());
            return Err(StoreError::OtherGrid { folder: folder.to_owned(), held, given }.into());
        }
        let mut conflicts = Vec::new();
        for cell in &self.grid.cells {
            if let Some(held) = held.cells.iter().find(|held| is_same(cell, &held.axes)) {
                conflicts.extend(Held { folder, cell: held }.conflict(cell)?);
            }
        }
        let Some(first) = conflicts.first() else { return Ok(()) };
        let more = match conflicts.len() - 1 {
            0 => String::new(),
            1 => " (and 1 more cell)".to_owned(),
            n => format!(" (and {n} more cells)"),
        };
        Err(Error::Input(format!(
            "the results folder `{}` holds other results under the same names: {first}{more}; give another folder with --out",
            folder.display()
        )))
    }
}

/// Whether a cell has these levels, in whatever order.
fn is_same(cell: &Cell, levels: &[AxisLevel]) -> bool {
    let has = |(axis, level): &(String, String)| levels.iter().any(|held| held.axis == *axis && held.level == *level);
    cell.axes.len() == levels.len() && cell.axes.iter().all(has)
}

/// A cell that a results folder holds.
struct Held<'a> {
    folder: &'a Path,
    cell: &'a store::Cell,
}

impl Held<'_> {
    /// In what the results of the cell differ from those that `cell` now stands for.
    fn conflict(&self, cell: &Cell) -> Result<Option<String>, Error> {
        for run in &self.cell.runs {
            let folder = self.run(&run.train_id);
            if folder.has_finished() && train_id(&cell.spec, run.seed)? != run.train_id {
                let what = other_training(&folder, cell);
                return Ok(Some(format!("{}: {what}", labelled(cell, run.seed))));
            }
        }
        for world in &cell.spec.evaluate.worlds {
            let held = self.cell.evaluations.iter().find(|held| held.world == world.name);
            if let Some(what) = held.map(|held| self.other_evaluation(held, cell, world)).transpose()?.flatten() {
                let place = if cell.axes.is_empty() { String::new() } else { format!("{}, ", cell.label()) };
                return Ok(Some(format!("{place}world {:?}: {what}", world.name)));
            }
        }
        Ok(None)
    }

    /// In what the evaluations in a world differ from those that there shall be, the number of episodes aside.
    fn other_evaluation(
        &self,
        held: &IndexedEvaluation,
        cell: &Cell,
        world: &EvaluateWorld,
    ) -> Result<Option<String>, Error> {
        let folders = self.cell.runs.iter().map(|run| self.run(&run.train_id).evaluation(&held.eval_id));
        let Some(spec) = folders.filter(EvaluationFolder::has_finished).find_map(|folder| folder.spec().ok()) else {
            return Ok(None); // nothing would be lost
        };
        let n_episodes = spec.get("n_episodes").and_then(Value::as_integer).unwrap_or_default();
        let n_episodes = usize::try_from(n_episodes).unwrap_or_default();
        let key = EvaluationKey { n_episodes, ..evaluation_key(&cell.spec, world)? };
        if key.id()? == held.eval_id {
            return Ok(None);
        }
        let what = Table::try_from(key).map(|key| in_words(&spec.into(), &key.into())).unwrap_or_default();
        Ok(Some(or_version(what)))
    }

    fn run(&self, id: &Id) -> RunFolder {
        RunFolder::new(self.folder, id)
    }
}

/// In what the training of a finished run differs from that of a cell, as far as it can be told.
fn other_training(folder: &RunFolder, cell: &Cell) -> String {
    let mut words = Vec::new();
    let here = TrainTables::of(&cell.spec).ok().and_then(|tables| Table::try_from(tables).ok());
    if let (Ok(there), Some(here)) = (folder.spec(), here) {
        words.push(in_words(&there.into(), &here.into()));
    }
    if let Ok(info) = folder.info() {
        let versions = [
            ("results version", info.results_version, RESULTS_VERSION),
            ("reward version", info.reward_version, seed_and_reward(&cell.spec, 0).1),
        ];
        let differ = versions.iter().filter(|(_, there, here)| there != here);
        words.extend(differ.map(|(what, there, here)| format!("the {what} is {there} there, {here} here")));
    }
    words.retain(|words| !words.is_empty());
    or_version(words.join("; "))
}

/// What is said where no difference is found.
fn or_version(words: String) -> String {
    if words.is_empty() { "made by another version of this program".to_owned() } else { words }
}
