//! `experiments evaluate`: a saved policy, or a classical driver, in the evaluation worlds of a spec or by a protocol.

use std::io::Write;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

use headway_planning::DriverSpec;
use headway_policy::Policy;

use super::args::{EvaluateArgs, EvaluateFormat};
use super::{cell, print, protocol};
use crate::Error;
use crate::candidate::Candidate;
use crate::evaluate::ScenarioSet;
use crate::plot::{self, Trajectory};
use crate::report;
use crate::spec::{Assignment, EvaluateWorld, Grid, RunSpec};

/// Drives a policy, or a classical driver, through the evaluation worlds of a spec and prints what came of it; may draw an
/// episode.
///
/// Of a grid, the cell whose run made the policy says where to drive; where there is none, the cells whose vehicle and
/// lidar are the policy's, which must agree.
///
/// # Errors
/// If the spec, the policy file or an argument is wrong, the policy was made for another robot, or the cells do not agree.
pub fn execute(args: &EvaluateArgs, out: &mut dyn Write) -> Result<(), Error> {
    if args.protocol.is_some() {
        return protocol::execute(args, out);
    }
    let Some(path) = &args.spec else {
        return Err(Error::Input("--spec SPEC says where to drive; or give --protocol barn and --worlds DIR".into()));
    };
    let asked = Asked::of(args)?;
    let grid = Grid::load(path, &asked.assignments(args))?;
    let cell = cell::choose(&grid, asked.policy(), args)?;
    args.plot.as_deref().map_or(Ok(()), check_folder)?;
    let spec = &cell.spec;
    let candidate = asked.candidate(spec);
    let mut results = Vec::new();
    let worlds = chosen_worlds(args, spec)?;
    let set_up = |world: &EvaluateWorld| {
        let (mdp, driver) = candidate.set_up(spec.evaluation(world))?;
        let n_episodes = args.episodes.map_or(spec.evaluate.n_episodes, NonZeroUsize::get);
        let set = ScenarioSet::new(&mdp, n_episodes, args.seed.unwrap_or(spec.evaluate.seed))?;
        Ok::<_, Error>((mdp, driver, set))
    };
    let mut drawing = None;
    for world in worlds {
        let (mdp, mut driver, set) = set_up(world)?;
        if let Some(path) = args.plot.as_ref().filter(|_| results.is_empty()) {
            let title = |index| format!("{}, episode {index}", world.name);
            drawing = Some((path, picture(args, |index| set.trajectory(&mdp, &mut *driver, index, title(index)))?));
        }
        results.push((world.name.as_str(), set.drive_all(&mdp, &mut *driver)?));
    }
    // Written when nothing can fail any more.
    if let Some((path, svg)) = drawing {
        write(path, &svg)?;
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

/// Who is asked for by POLICY.
pub(super) enum Asked {
    Driver(Box<DriverSpec>),
    Policy(Arc<Policy>),
}

impl Asked {
    /// The classical driver of that name, or else the policy of that file.
    pub(super) fn of(args: &EvaluateArgs) -> Result<Self, Error> {
        if let Some(driver) = args.policy.to_str().and_then(DriverSpec::named) {
            return Ok(Self::Driver(Box::new(driver)));
        }
        if !args.policy.exists() {
            return Err(Error::Input(format!(
                "`{}` is no policy file, and no driver has that name; there are {}",
                args.policy.display(),
                DriverSpec::TYPES.join(", ")
            )));
        }
        let policy = Policy::load(&args.policy).map_err(|error| Error::Input(error.to_string()))?;
        Ok(Self::Policy(Arc::new(policy)))
    }

    pub(super) fn policy(&self) -> Option<&Policy> {
        match self {
            Self::Driver(_) => None,
            Self::Policy(policy) => Some(policy),
        }
    }

    /// What is set in the spec: the driver's name, the shield, and then what the command line sets.
    pub(super) fn assignments(&self, args: &EvaluateArgs) -> Vec<Assignment> {
        let set = |text: String| text.parse().expect("a path and a value");
        let driver = match self {
            Self::Driver(driver) => Some(set(format!("policy.type={}", driver.name()))),
            Self::Policy(_) => None,
        };
        let shield = args.shield.then(|| set("evaluate.shield={}".to_owned()));
        driver.into_iter().chain(shield).chain(args.set.iter().cloned()).collect()
    }

    /// Who drives under a spec that was made with these assignments.
    pub(super) fn candidate(self, spec: &RunSpec) -> Candidate {
        let candidate = match self {
            Self::Driver(driver) => Candidate::driver_of(spec.policy.driver().unwrap_or(*driver)),
            Self::Policy(policy) => Candidate::policy(policy),
        };
        candidate.shielded(spec.shield())
    }
}

/// The episodes that `--plot-episodes` names, as one picture.
fn picture(args: &EvaluateArgs, drive: impl FnMut(usize) -> Result<Trajectory, Error>) -> Result<String, Error> {
    let drives: Vec<_> = args.plot_episodes.iter().copied().map(drive).collect::<Result<_, _>>()?;
    Ok(if let [drive] = &drives[..] { plot::figure(drive) } else { plot::small_multiples(&drives) })
}

/// The same, written to a file.
pub(super) fn draw(
    path: &Path,
    args: &EvaluateArgs,
    drive: impl FnMut(usize) -> Result<Trajectory, Error>,
) -> Result<(), Error> {
    write(path, &picture(args, drive)?)
}

fn write(path: &Path, svg: &str) -> Result<(), Error> {
    std::fs::write(path, svg).map_err(|error| Error::io("write", path, error))
}

/// Refuses a path in a folder that does not exist before anything is driven.
pub(super) fn check_folder(path: &Path) -> Result<(), Error> {
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
