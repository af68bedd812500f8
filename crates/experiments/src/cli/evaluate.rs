//! `experiments evaluate`: a saved policy in the evaluation worlds of a spec.

use std::io::Write;
use std::num::NonZeroUsize;
use std::sync::Arc;

use headway_policy::{Driver, Policy};

use super::args::{EvaluateArgs, EvaluateFormat};
use super::print;
use crate::Error;
use crate::evaluate::{ScenarioSet, for_policy};
use crate::plot;
use crate::report;
use crate::spec::{EvaluateWorld, Grid, RunSpec};

/// Drives a policy through the evaluation worlds of a spec and prints what came of it; may draw an episode.
///
/// Of a grid, the first cell whose vehicle and lidar are the policy's says where to drive.
///
/// # Errors
/// If the spec, the policy file or an argument is wrong, or the policy was made for another robot.
pub fn execute(args: &EvaluateArgs, out: &mut dyn Write) -> Result<(), Error> {
    let policy = Policy::load(&args.policy).map_err(|error| Error::Input(error.to_string()))?;
    let grid = Grid::load(&args.spec, &args.set)?;
    let fits = |spec: &&RunSpec| policy.check(&spec.vehicle, &spec.lidar).is_ok();
    let mut specs = grid.cells.iter().map(|cell| &cell.spec);
    let spec = specs.clone().find(fits).or_else(|| specs.next()).expect("a grid has a cell");
    let policy = Arc::new(policy);
    let mut results = Vec::new();
    for world in chosen_worlds(args, spec)? {
        let mdp = for_policy(spec.evaluation(world), &policy)?;
        let n_episodes = args.episodes.map_or(spec.evaluate.n_episodes, NonZeroUsize::get);
        let set = ScenarioSet::new(&mdp, n_episodes, args.seed.unwrap_or(spec.evaluate.seed))?;
        let mut driver = Driver::new(Arc::clone(&policy)).map_err(Error::failure)?;
        if let Some(path) = args.plot.as_ref().filter(|_| results.is_empty()) {
            let draw = |index| set.trajectory(&mdp, &mut driver, index, format!("{}, episode {index}", world.name));
            let drives: Vec<_> = args.plot_episodes.iter().copied().map(draw).collect::<Result<_, _>>()?;
            let svg = if let [drive] = &drives[..] { plot::figure(drive) } else { plot::small_multiples(&drives) };
            std::fs::write(path, svg).map_err(|error| Error::io("write", path, error))?;
        }
        results.push((world.name.as_str(), set.drive_all(&mdp, &mut driver)?));
    }
    let report = report::of_policy(&results);
    print(
        out,
        &match args.format {
            EvaluateFormat::Table => report.table(),
            EvaluateFormat::Json => report.json(),
        },
    )
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
