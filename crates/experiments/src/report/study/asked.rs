//! Whether there are the episodes that were asked for.

use std::collections::BTreeSet;

use super::choice::{Choice, Pick};
use crate::Error;
use crate::report::{Report, RunRow};
use crate::store::{Cell, Index};

/// Refuses episodes that are not there, and says which are.
///
/// # Errors
/// Names the first part of an episode's name that nothing has.
pub(super) fn check(choice: &Choice, index: &Index, report: &Report) -> Result<(), Error> {
    choice.asked.iter().try_for_each(|pick| check_pick(pick, index, report))
}

fn check_pick(pick: &Pick, index: &Index, report: &Report) -> Result<(), Error> {
    let levels = |cell: &Cell| cell.axes.iter().map(|level| level.level.as_str()).collect::<Vec<_>>().join(",");
    let cells: Vec<&Cell> = index.cells.iter().filter(|cell| pick.is_of(&levels(cell))).collect();
    if cells.is_empty() {
        return refuse(format!("cell `{}`", pick.cell), index.cells.iter().map(levels));
    }
    let worlds: BTreeSet<&String> = cells.iter().flat_map(|cell| &cell.evaluations).map(|its| &its.world).collect();
    if !worlds.contains(&pick.world) {
        return refuse(format!("world `{}`", pick.world), worlds);
    }
    let seeds: BTreeSet<u64> = cells.iter().flat_map(|cell| &cell.runs).map(|run| run.seed).collect();
    if !seeds.contains(&pick.seed) {
        return refuse(format!("seed {}", pick.seed), seeds);
    }
    let of_seed = |run: &&RunRow| run.seed == pick.seed;
    let summaries = report.runs.iter().filter(of_seed).flat_map(|run| &run.summaries);
    let here = summaries.filter(|(world, _)| *world == pick.world).filter_map(|(_, summary)| summary.as_ref());
    let n_episodes = here.map(|summary| summary.n_episodes).max().unwrap_or(0);
    if pick.scenario >= n_episodes as u64 {
        return refuse(format!("scenario {}", pick.scenario), [format!("{n_episodes}, counted from 0")]);
    }
    Ok(())
}

fn refuse(what: String, known: impl IntoIterator<Item = impl ToString>) -> Result<(), Error> {
    let known: Vec<String> = known.into_iter().map(|known| known.to_string()).collect();
    Err(Error::Input(format!("--drive: there is no {what}; there are {}", known.join("; "))))
}
