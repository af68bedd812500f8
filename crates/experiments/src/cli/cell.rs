//! Which cell of a grid says how a saved policy is evaluated.

use headway_env::{EnvSpec, GoalHandling};
use headway_policy::Policy;
use headway_sensors::LidarSpec;
use headway_sim::VehicleSpec;
use serde::Serialize;
use toml::Value;

use super::args::EvaluateArgs;
use crate::Error;
use crate::difference::in_words;
use crate::evaluate::adapt;
use crate::plan::train_id;
use crate::spec::{Cell, EvaluateSpec, Grid, PolicySpec};
use crate::store::AxisLevel;
use crate::train::{PROVENANCE_SEED, PROVENANCE_TRAIN_ID};

/// All that an evaluation depends on beside the policy, in TOML.
#[derive(Serialize)]
struct Conditions<'a> {
    vehicle: &'a VehicleSpec,
    lidar: &'a LidarSpec,
    env: EnvSpec,
    /// Where there is no policy file.
    #[serde(skip_serializing_if = "Option::is_none")]
    policy: Option<&'a PolicySpec>,
    evaluate: EvaluateSpec,
}

/// The cell by which a policy, or a classical driver, is evaluated: of those asked for, the one whose run made it, or else any whose vehicle and
/// lidar are the policy's, if they agree in all that an evaluation depends on.
///
/// # Errors
/// If there is no cell as asked for, or the cells do not agree.
pub(super) fn choose<'a>(grid: &'a Grid, policy: Option<&Policy>, args: &EvaluateArgs) -> Result<&'a Cell, Error> {
    let asked = asked(grid, &args.cell)?;
    let mut candidates = policy.map_or(Ok(Vec::new()), |policy| makers(&asked, policy))?;
    if candidates.is_empty() {
        let fits =
            |cell: &&&Cell| policy.is_none_or(|policy| policy.check(&cell.spec.vehicle, &cell.spec.lidar).is_ok());
        candidates = asked.iter().filter(fits).copied().collect();
    }
    // Where none fits, what the first differs in will be said when it is to drive.
    let first = *candidates.first().unwrap_or(&asked[0]);
    let conditions = conditions(first, policy, args)?;
    let mut lines = vec![format!("\n  --cell {}", written(first))];
    for cell in candidates.iter().skip(1) {
        let what = in_words(&conditions, &self::conditions(cell, policy, args)?);
        let differ = if what.is_empty() { String::new() } else { format!("    unlike the first: {what}") };
        lines.push(format!("\n  --cell {}{differ}", written(cell)));
    }
    if lines.iter().any(|line| line.contains("unlike the first")) {
        return Err(Error::Input(format!(
            "{} cells of the spec fit this policy and differ in how they evaluate; choose one:{}",
            candidates.len(),
            lines.concat()
        )));
    }
    Ok(first)
}

/// The cells with these levels; not empty.
pub(super) fn asked<'a>(grid: &'a Grid, levels: &[AxisLevel]) -> Result<Vec<&'a Cell>, Error> {
    for AxisLevel { axis, level } in levels {
        let refuse = |what: &str, known: Vec<&str>| {
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            Err(Error::Input(format!("--cell {axis}={level}: unknown {what}; there are: {known}")))
        };
        let Some(known) = grid.axes.iter().find(|known| known.name == *axis) else {
            return refuse("axis", grid.axes.iter().map(|axis| axis.name.as_str()).collect());
        };
        if !known.levels.contains_key(level) {
            return refuse("level", known.levels.keys().map(String::as_str).collect());
        }
    }
    let has = |cell: &Cell, asked: &AxisLevel| {
        cell.axes.iter().any(|(axis, level)| (axis, level) == (&asked.axis, &asked.level))
    };
    let cells: Vec<&Cell> = grid.cells.iter().filter(|cell| levels.iter().all(|level| has(cell, level))).collect();
    if cells.is_empty() {
        return Err(Error::Input("--cell: no cell has two levels of one axis".to_owned()));
    }
    Ok(cells)
}

/// The cells whose run made the policy.
fn makers<'a>(cells: &[&'a Cell], policy: &Policy) -> Result<Vec<&'a Cell>, Error> {
    let provenance = &policy.header().provenance;
    let (Some(id), Some(seed)) = (provenance.get(PROVENANCE_TRAIN_ID), provenance.get(PROVENANCE_SEED)) else {
        return Ok(Vec::new());
    };
    let Ok(seed) = seed.parse() else { return Ok(Vec::new()) };
    let mut makers = Vec::new();
    for cell in cells {
        if train_id(&cell.spec, seed)?.as_str() == id {
            makers.push(*cell);
        }
    }
    Ok(makers)
}

/// What the evaluation of a policy by a cell depends on: neither what the policy nor what the command line brings.
fn conditions(cell: &Cell, policy: Option<&Policy>, args: &EvaluateArgs) -> Result<Value, Error> {
    let spec = &cell.spec;
    let mut env = EnvSpec {
        goal: GoalHandling::Terminate,
        time_limit: 1.0,                    // each world has its own
        obstacle_angle: Default::default(), // for rewards
        ..spec.env.clone()
    };
    if let Some(policy) = policy {
        adapt(&mut env, policy);
    }
    let mut evaluate = spec.evaluate.clone();
    if args.episodes.is_some() {
        evaluate.n_episodes = 1;
    }
    if args.seed.is_some() {
        evaluate.seed = 0;
    }
    if let Some(name) = &args.world {
        evaluate.worlds.retain(|world| world.name == *name);
    }
    Value::try_from(Conditions {
        vehicle: &spec.vehicle,
        lidar: &spec.lidar,
        env,
        policy: if policy.is_none() { Some(&spec.policy) } else { None },
        evaluate,
    })
    .map_err(Error::failure)
}

/// The levels of a cell as the option takes them.
fn written(cell: &Cell) -> String {
    let levels: Vec<String> = cell.axes.iter().map(|(axis, level)| format!("{axis}={level}")).collect();
    levels.join(",")
}
