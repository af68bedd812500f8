//! `experiments evaluate --protocol`: a published way to measure.

use std::io::Write;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use std::thread::available_parallelism;

use headway_env::NavSpec;
use headway_policy::Policy;

use super::args::{EvaluateArgs, EvaluateFormat};
use super::evaluate::{Asked, check_folder, draw};
use super::{cell, print};
use crate::Error;
use crate::candidate::Candidate;
use crate::jobs::Display;
use crate::protocol::barn;
use crate::spec::{Grid, PolicySpec, RunSpec};

/// Runs a classical driver, or a policy, through all worlds of a folder.
///
/// # Errors
/// If the folder holds no worlds, or an argument is wrong.
pub(super) fn execute(args: &EvaluateArgs, out: &mut dyn Write) -> Result<(), Error> {
    let Some(folder) = &args.worlds else {
        return Err(Error::Input("--protocol barn needs --worlds DIR, the folder that holds the world files".into()));
    };
    args.plot.as_deref().map_or(Ok(()), check_folder)?;
    let Conditions { candidate, rules, seed } = Conditions::of(args)?;
    let mut worlds = barn::worlds(folder)?;
    if let Some(name) = &args.world {
        choose(&mut worlds, name, folder)?;
    }
    let n_cores = available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let n_runs = args.runs.unwrap_or(DEFAULT_RUNS);
    let plan = barn::Plan { n_runs, seed, n_jobs: args.jobs.unwrap_or(n_cores) };
    let runs = barn::evaluate(&worlds, &candidate, &rules, &plan, Display::auto("runs"))?;
    let footprint = rules.vehicle.build().map_err(Error::failure)?;
    let report = barn::Report::new(&worlds, &runs, footprint.footprint())?;
    if let Some(path) = &args.plot {
        let drive = |index: usize| barn::trajectory(&worlds[0], &candidate, &rules, seed, index as u64);
        draw(path, args, drive)?;
    }
    let same = "Nothing in these conditions is random: the runs of a world are all the same.\n";
    let note = if n_runs.get() > 1 && !is_random(&rules) { same } else { "" };
    print(
        out,
        &match args.format {
            EvaluateFormat::Table => report.table() + note,
            EvaluateFormat::Json => report.json(),
        },
    )
}

const DEFAULT_RUNS: NonZeroUsize = NonZeroUsize::new(10).expect("ten is not zero");

/// Who drives, and in what.
struct Conditions {
    candidate: Candidate,
    rules: NavSpec,
    seed: u64,
}

impl Conditions {
    fn of(args: &EvaluateArgs) -> Result<Self, Error> {
        let asked = Asked::of(args)?;
        let spec = match (&args.spec, &asked) {
            (Some(path), _) => {
                let grid = Grid::load(path, &asked.assignments(args))?;
                cell::choose(&grid, asked.policy(), args)?.spec.clone()
            }
            (None, Asked::Driver(_)) => RunSpec::barn().assigned(&asked.assignments(args))?,
            (None, Asked::Policy(policy)) => of_policy(policy, &args.policy).assigned(&asked.assignments(args))?,
        };
        let (candidate, rules) = (asked.candidate(&spec), spec.training());
        // Of a spec, all but the policy's own conditions count; without one, what was set over the policy's stays.
        let rules = if args.spec.is_some() { candidate.rules(rules)? } else { rules };
        Ok(Self { candidate, rules, seed: args.seed.unwrap_or(spec.evaluate.seed) })
    }
}

/// The conditions of a policy: those of its header.
fn of_policy(policy: &Arc<Policy>, path: &Path) -> RunSpec {
    let (header, mut spec) = (policy.header(), RunSpec::barn());
    spec.vehicle = header.vehicle.clone();
    spec.lidar = header.lidar.clone();
    spec.policy = PolicySpec::File { path: path.to_owned() };
    crate::evaluate::adapt(&mut spec.env, policy);
    spec
}

/// Leaves the one world of this name.
fn choose(worlds: &mut Vec<barn::World>, name: &str, folder: &Path) -> Result<(), Error> {
    if worlds.iter().all(|world| world.name != name) {
        let names: Vec<&str> = worlds.iter().map(|world| world.name.as_str()).collect();
        let known = if names.len() > 12 { format!("{}, ...", names[..12].join(", ")) } else { names.join(", ") };
        return Err(Error::Input(format!("--world {name}: the worlds in {} are {known}", folder.display())));
    }
    worlds.retain(|world| world.name == name);
    Ok(())
}

/// Whether runs of the same world can differ.
fn is_random(rules: &NavSpec) -> bool {
    let lidar_is = rules.lidar.noise > 0.0 || rules.lidar.dropout > 0.0;
    lidar_is
        || rules.vehicle.actuation.noise > 0.0
        || rules.odometry != Default::default()
        || rules.randomize != Default::default()
}
