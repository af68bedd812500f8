//! `experiments run`: trains and evaluates what a spec stands for and is not yet there.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::Path;
use std::thread::available_parallelism;

use super::args::RunArgs;
use super::work::{self, Events, Task};
use super::{left_out, print};
use crate::Error;
use crate::plan::Plan;
use crate::report;
use crate::spec::Grid;
use crate::store::{Id, Index, RunFolder, Store};
use crate::tensorboard;

/// Trains and evaluates every run of the grid that is not yet in the results folder, then prints the report.
///
/// # Errors
/// Whatever is wrong with the spec or the folder, or the first run that failed.
pub fn execute(args: &RunArgs, out: &mut dyn Write) -> Result<(), Error> {
    let grid = Grid::load(&args.spec, &args.set)?;
    let folder = args.out.clone().unwrap_or_else(|| Path::new("results").join(&grid.name));
    let plan = Plan::new(&grid)?;
    plan.check_against(&folder)?; // before anything is created
    let left_out = left_out::in_words(&grid);
    if !left_out.is_empty() {
        note(left_out.trim_end());
    }
    let store = Store::open(&folder)?;
    plan.check_against(&folder)?; // now that nobody else writes to it
    note_what_leaves(&folder, &plan.index);
    store.write_index(&plan.index)?;
    let tasks: Vec<Task<'_>> = plan.runs.iter().map(|run| Task::of(run, &store)).collect::<Result<_, _>>()?;
    let missing: Vec<Task<'_>> = tasks.into_iter().filter(Task::is_any).collect();
    if missing.is_empty() {
        note(&format!("nothing to do: all {} runs are there", plan.runs.len()));
    } else {
        let n_workers = args.jobs.or_else(|| available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);
        let events = if args.tensorboard { Events::TensorBoard } else { Events::None };
        work::complete(missing, &store, n_workers, events)?;
    }
    if args.tensorboard {
        tensorboard::complete(&folder, &plan.runs)?;
    }
    let (text, folder) = (report::load(&folder)?.table(), folder.display());
    print(out, &format!("{text}\nresults in {folder}\nevery run and its policy: experiments report {folder} --runs\n"))
}

/// Says how many finished runs the report will no longer show.
fn note_what_leaves(folder: &Path, index: &Index) {
    let Ok(held) = Index::load(folder) else { return };
    let mut ids: Vec<&Id> = held.cells.iter().flat_map(|cell| &cell.runs).map(|run| &run.train_id).collect();
    ids.sort();
    ids.dedup(); // cells may share a run
    let stays = |id: &Id| index.cells.iter().flat_map(|cell| &cell.runs).any(|run| run.train_id == *id);
    let n_leaving = ids.iter().filter(|id| !stays(id) && RunFolder::new(folder, id).has_finished()).count();
    if n_leaving > 0 {
        note(&format!("{n_leaving} runs of the folder are not in this spec: they stay there, but not in the report"));
    }
}

/// Says something beside the output; where even stderr is closed, nobody misses it.
pub(super) fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}
