//! `experiments audit`: what the rewards of a spec really pay for.

use std::io::Write;
use std::process::ExitCode;

use toml::Value;

use super::args::{AuditArgs, AuditFormat};
use super::{cell, print};
use crate::Error;
use crate::audit::{Audit, Case, Entry, table};
use crate::spec::{Axis, Cell, Grid};

/// The exit code where a reward pays best for a driver that does not arrive.
const FAILS: u8 = 3;

/// Audits every reward of a spec under every discount and process that its cells train with; cells that differ in nothing
/// that an audit depends on are audited once.
///
/// The exit code says whether all of them pay best for arriving.
///
/// # Errors
/// Whatever is wrong with the spec; or if no cell trains anything, or a reward cannot be audited.
pub fn execute(args: &AuditArgs, out: &mut dyn Write) -> Result<ExitCode, Error> {
    let grid = Grid::load(&args.spec, &args.set)?;
    let cells = cell::asked(&grid, &args.cell)?;
    let cells: Vec<&Cell> = cells.into_iter().filter(|cell| cell.spec.policy.is_learned()).collect();
    if cells.is_empty() {
        return Err(Error::Input("policy: no cell trains a policy, so no reward is ever paid".into()));
    }
    let mut entries = Vec::new();
    for (case, cells) in cases(&cells, args.distance)? {
        let audit = Audit::of(&case)?;
        check_distance(args.distance, &audit)?;
        let axes = levels(&grid.axes, &cells);
        let label = |levels: fn(&[&str]) -> String| {
            let words = axes.iter().map(|(axis, names)| format!("{axis}={}", levels(names)));
            words.collect::<Vec<_>>().join(" ")
        };
        entries.push(Entry {
            cells: label(|names| names.join("|")),
            short_cells: label(shortened),
            reward_in_words: case.reward_in_words(),
            case,
            audit,
        });
    }
    print(
        out,
        &match args.format {
            AuditFormat::Table => table(&grid.name, &entries),
            AuditFormat::Json => {
                let text = serde_json::to_string_pretty(&entries);
                text.map_err(Error::failure)? + "\n"
            }
        },
    )?;
    let passes = entries.iter().all(|entry| entry.audit.passes);
    Ok(if passes { ExitCode::SUCCESS } else { ExitCode::from(FAILS) })
}

/// The cases that there are, each with its cells, in the order of the cells.
fn cases<'a>(cells: &[&'a Cell], distance: Option<f64>) -> Result<Vec<(Case, Vec<&'a Cell>)>, Error> {
    let mut cases: Vec<(Value, Case, Vec<&Cell>)> = Vec::new();
    for cell in cells.iter().copied() {
        let mut case = Case::of(&cell.spec);
        case.goal_distance = distance.unwrap_or(case.goal_distance);
        if case.goal_distance <= case.reach_radius {
            let (distance, radius) = (case.goal_distance, case.reach_radius);
            return Err(Error::Input(format!("--distance {distance}: must be above env.reach_radius, {radius} m")));
        }
        let key = Value::try_from(&case).map_err(Error::failure)?;
        match cases.iter_mut().find(|(other, _, _)| *other == key) {
            Some((_, _, cells)) => cells.push(cell),
            None => cases.push((key, case, vec![cell])),
        }
    }
    Ok(cases.into_iter().map(|(_, case, cells)| (case, cells)).collect())
}

/// Refuses a goal so near that an orbit would touch it.
fn check_distance(asked: Option<f64>, audit: &Audit) -> Result<(), Error> {
    match asked {
        Some(asked) if audit.goal_distance > asked => Err(Error::Input(format!(
            "--distance {asked}: must be {:.2} m or more: beside the way, this vehicle needs that much room to orbit an obstacle",
            (audit.goal_distance * 100.0).ceil() / 100.0
        ))),
        _ => Ok(()),
    }
}

/// The axes that tell these cells from others, each with the levels that they have of it: an axis all of whose levels are among them is
/// left out.
fn levels<'a>(axes: &'a [Axis], cells: &[&Cell]) -> Vec<(&'a str, Vec<&'a str>)> {
    let of_axis = |(k, axis): (usize, &'a Axis)| {
        let held = |level: &&String| cells.iter().any(|cell| cell.axes[k].1 == **level);
        let levels: Vec<&str> = axis.levels.keys().filter(held).map(String::as_str).collect();
        (levels.len() < axis.levels.len()).then_some((axis.name.as_str(), levels))
    };
    axes.iter().enumerate().filter_map(of_axis).collect()
}

/// The first of several levels, and how many more there are.
fn shortened(levels: &[&str]) -> String {
    match levels {
        [first, rest @ ..] if !rest.is_empty() => format!("{first} (and {} more)", rest.len()),
        few => few.concat(),
    }
}
