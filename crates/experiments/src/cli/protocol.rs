//! `experiments evaluate --protocol`: a published way to measure.

use std::io::Write;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use std::thread::available_parallelism;

use headway_env::NavSpec;
use headway_policy::Policy;

use super::args::{EvaluateArgs, EvaluateFormat};
use super::evaluate::{Asked, check_folder, draw, unknown_world};
use super::fixed::{self, Brings};
use super::run::note;
use super::{cell, print};
use crate::Error;
use crate::candidate::Candidate;
use crate::jobs::Display;
use crate::protocol::barn::{self, Course, Report, World};
use crate::spec::{Grid, PolicySpec, RunSpec};
use crate::store::AxisLevel;

/// Runs a classical driver, or a policy, through all worlds of a folder.
///
/// # Errors
/// If the folder holds no worlds, or an argument is wrong.
pub(super) fn execute(args: &EvaluateArgs, out: &mut dyn Write) -> Result<(), Error> {
    let Some(folder) = &args.worlds else {
        return Err(Error::Input("--protocol barn needs --worlds DIR, the folder that holds the world files".into()));
    };
    if let (Some(AxisLevel { axis, level }), None) = (args.cell.first(), &args.spec) {
        return Err(Error::Input(format!("--cell {axis}={level}: cells are those of a spec, which --spec SPEC names")));
    }
    args.plot.as_deref().map_or(Ok(()), check_folder)?;
    let Conditions { candidate, rules, seed } = Conditions::of(args)?;
    let n_jobs = args.jobs.unwrap_or_else(|| available_parallelism().unwrap_or(NonZeroUsize::MIN));
    let plan = barn::Plan { n_runs: args.runs.unwrap_or(DEFAULT_RUNS), seed, n_jobs }.without_copies(&rules);
    check_plots(args, plan.n_runs)?;
    // All that can be refused is refused before anything drives.
    let courses = Course::all(chosen(args, folder)?, &rules, n_jobs)?;
    courses.first().map_or(Ok(()), |course| candidate.driver(&course.mdp).map(drop))?;
    if let Some(asked) = args.runs.filter(|asked| *asked > plan.n_runs) {
        note(&format!("--runs {asked}: one run in each world, since nothing here is random and all would be the same"));
    }
    let runs = barn::evaluate(&courses, &candidate, &plan, Display::auto("runs"))?;
    let report = Report::new(&courses, &runs, barn::Conditions::new(&candidate, &rules, &plan));
    if let Some(path) = &args.plot {
        draw(path, args, |index| barn::trajectory(&courses[0], &candidate, seed, index as u64))?;
    }
    print(
        out,
        &match args.format {
            EvaluateFormat::Table => report.table(),
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
        let brings = match (&asked, &args.spec) {
            (Asked::Driver(_), _) => Brings::Driver,
            (Asked::Policy(_), None) => Brings::Policy,
            (Asked::Policy(_), Some(_)) => Brings::PolicyOverSpec,
        };
        fixed::check(&args.set, brings)?;
        let spec = match (&args.spec, &asked) {
            (Some(path), _) => {
                let grid = Grid::load(path, &asked.assignments(args))?;
                cell::choose(&grid, asked.policy(), args)?.spec.clone()
            }
            (None, Asked::Driver(_)) => RunSpec::barn().assigned(&asked.assignments(args))?,
            (None, Asked::Policy(policy)) => of_policy(policy, &args.policy).assigned(&asked.assignments(args))?,
        };
        let (candidate, rules) = (asked.candidate(&spec, &args.policy), spec.training());
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

/// The worlds of the folder, or the one that was asked for.
fn chosen(args: &EvaluateArgs, folder: &Path) -> Result<Vec<World>, Error> {
    let worlds = barn::worlds(folder)?;
    let Some(name) = &args.world else { return Ok(worlds) };
    let names: Vec<String> = worlds.iter().map(|world| world.name.clone()).collect();
    let unknown = || unknown_world(name, &format!("The worlds in {}", folder.display()), &names);
    Ok(vec![worlds.into_iter().find(|world| world.name == *name).ok_or_else(unknown)?])
}

/// Refuses to draw runs that are not made.
fn check_plots(args: &EvaluateArgs, n_runs: NonZeroUsize) -> Result<(), Error> {
    let beyond = args.plot_episodes.iter().find(|index| args.plot.is_some() && **index >= n_runs.get());
    beyond.map_or(Ok(()), |index| {
        Err(Error::Input(format!(
            "--plot-episodes {index}: there is no such run; each world has {n_runs}, counted from 0"
        )))
    })
}
