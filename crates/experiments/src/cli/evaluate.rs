//! `experiments evaluate`: a saved policy in the evaluation worlds of a spec.

use std::io::Write;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

use headway_policy::Policy;

use super::args::{EvaluateArgs, EvaluateFormat};
use super::{cell, print};
use crate::Error;
use crate::evaluate::{ScenarioSet, for_policy};
use crate::plot;
use crate::report;
use crate::spec::{EvaluateWorld, Grid, RunSpec};

/// Drives a policy through the evaluation worlds of a spec and prints what came of it; may draw an episode.
///
/// Of a grid, the cell whose run made the policy says where to drive; where there is none, the cells whose vehicle and
/// lidar are the policy's, which must agree.
///
/// # Errors
/// If the spec, the policy file or an argument is wrong, the policy was made for another robot, or the cells do not agree.
pub fn execute(args: &EvaluateArgs, out: &mut dyn Write) -> Result<(), Error> {
    let policy = Policy::load(&args.policy).map_err(|error| Error::Input(error.to_string()))?;
    let grid = Grid::load(&args.spec, &args.set)?;
    let cell = cell::choose(&grid, &policy, args)?;
    args.plot.as_deref().map_or(Ok(()), check_folder)?;
    let (spec, policy) = (&cell.spec, Arc::new(policy));
    let (mut results, mut drawing) = (Vec::new(), None);
    for world in chosen_worlds(args, spec)? {
        let (mdp, mut driver) = for_policy(spec.evaluation(world), &policy)?;
        let n_episodes = args.episodes.map_or(spec.evaluate.n_episodes, NonZeroUsize::get);
        let set = ScenarioSet::new(&mdp, n_episodes, args.seed.unwrap_or(spec.evaluate.seed))?;
        if let Some(path) = args.plot.as_ref().filter(|_| results.is_empty()) {
            let draw = |index| set.trajectory(&mdp, &mut driver, index, format!("{}, episode {index}", world.name));
            let drives: Vec<_> = args.plot_episodes.iter().copied().map(draw).collect::<Result<_, _>>()?;
            let svg = if let [drive] = &drives[..] { plot::figure(drive) } else { plot::small_multiples(&drives) };
            drawing = Some((path, svg));
        }
        results.push((world.name.as_str(), set.drive_all(&mdp, &mut driver)?));
    }
    // Written when nothing can fail any more.
    if let Some((path, svg)) = drawing {
        std::fs::write(path, svg).map_err(|error| Error::io("write", path, error))?;
    }
    let report = report::of_policy(&results);
    let which =
        if cell.axes.is_empty() { String::new() } else { format!("in the worlds of the cell {}\n", cell.label()) };
    print(
        out,
        &match args.format {
            EvaluateFormat::Table => report.table() + &which,
            EvaluateFormat::Json => report.json(),
        },
    )
}

/// Refuses a path in a folder that does not exist before anything is driven.
fn check_folder(path: &Path) -> Result<(), Error> {
    match path.parent() {
        Some(folder) if folder != Path::new("") && !folder.is_dir() => {
            Err(Error::Input(format!("--plot {}: there is no folder `{}`", path.display(), folder.display())))
        }
        _ => Ok(()),
    }
}

/// The spec's evaluation worlds, or the one that was asked for.
fn chosen_worlds<'a>(args: &EvaluateArgs, spec: &'a RunSpec) -> Result<Vec<&'a EvaluateWorld>, Error> {
    let worlds = &spec.evaluate.worlds;
    let Some(name) = &args.world else {
        return Ok(worlds.iter().collect());
    };
    let known: Vec<&str> = worlds.iter().map(|world| world.name.as_str()).collect();
    let chosen = worlds.iter().find(|world| world.name == *name);
    let unknown = || Error::Input(format!("--world {name}: the spec's evaluation worlds are {}", known.join(", ")));
    Ok(vec![chosen.ok_or_else(unknown)?])
}
