//! `experiments list`: what a spec can choose from.

use std::io::Write;

use headway_planning::DriverSpec;
use headway_reward::Entry;
use headway_sim::{BarnSpec, FilesSpec, RoomSpec, VehiclePreset, WorldSpec};
use serde::Serialize;
use toml::Table;

use super::args::ListArgs;
use super::print;
use crate::Error;
use crate::spec::{ShieldOption, choices};

/// The choices other than rewards and worlds: what they are, and their path in a spec.
const CHOICES: &[(&str, &str)] = &[
    ("vehicle outlines", "vehicle.footprint.type"),
    ("drives", "vehicle.drive.type"),
    ("routes that drivers are shown", "env.route.type"),
    ("who drives", "policy.type"),
    ("a reached goal", "env.goal"),
    ("what the agent controls", "env.control.type"),
    ("actions", "env.actions.type"),
    ("lidar encodings", "env.observation.encoding"),
    ("target rules", "agent.target"),
    ("losses", "agent.loss.type"),
    ("gradient clipping", "agent.grad_clip.type"),
    ("the target network's updates", "agent.target_network.type"),
];

/// Columns that names take, and that lines have.
const INDENT: usize = 30;
const WIDTH: usize = 120;

/// Prints rewards with their fields and defaults, worlds with their sizes, and the words that other keys take.
///
/// # Errors
/// If two linked rewards share a name, or the output cannot be written.
pub fn execute(_: &ListArgs, out: &mut dyn Write) -> Result<(), Error> {
    print(out, &text()?)
}

fn text() -> Result<String, Error> {
    let rewards = headway_reward::registry().map_err(|error| Error::Input(error.to_string()))?;
    let mut text = String::from("Rewards, as [reward] and as terms of a sum: type, then keys with their defaults\n");
    for entry in rewards {
        push(&mut text, entry.tag, &reward_keys(&entry));
    }
    text.push_str("\nWorlds, as [world] and in evaluate.worlds: type, then keys with their defaults\n");
    for tag in WorldSpec::TYPES {
        push(&mut text, tag, &world_keys(tag));
    }
    text.push_str("\nClassical drivers, as [policy] and by name in `evaluate`: type, then keys with their defaults\n");
    for driver in DriverSpec::TYPES.iter().filter_map(|name| DriverSpec::named(name)) {
        push(&mut text, driver.name(), &keys(&driver));
    }
    text.push_str("\nA shield around whoever drives, as [evaluate.shield]: keys with their defaults\n");
    push(&mut text, "evaluate.shield", &keys(&ShieldOption::default()));
    text.push_str("\nVehicles, as vehicle = { preset = \"...\" }: preset, then what it stands for\n");
    for (name, preset) in VehiclePreset::ALL {
        push(&mut text, name, &keys(&preset.spec()));
    }
    text.push_str("\nOther keys that take one of several words\n");
    for (what, path) in CHOICES {
        push(&mut text, path, &[format!("{}   ({what})", choices(path).join(" | "))]);
    }
    Ok(text)
}

fn reward_keys(entry: &Entry) -> Vec<String> {
    match &entry.default {
        Ok(reward) => keys(reward),
        Err(error) => vec![error.to_string()],
    }
}

/// The keys of a kind of world, or the room that a preset stands for.
fn world_keys(tag: &str) -> Vec<String> {
    let preset = |room: RoomSpec| {
        let mut keys = keys(&room);
        keys[0].insert_str(0, "no keys; stands for a `room` of ");
        keys
    };
    match tag {
        "room" => keys(&RoomSpec::default()),
        "room_10x15" => preset(RoomSpec::room_10x15()),
        "room_25x25" => preset(RoomSpec::room_25x25()),
        "barn" => keys(&BarnSpec::default()),
        "files" => keys(&FilesSpec::default()),
        _ => vec!["worlds = [{ weight = 0.5, world = { type = \"room_10x15\" } }, ...]".into()],
    }
}

/// The keys of `spec` with their values, in its own order.
fn keys(spec: &impl Serialize) -> Vec<String> {
    let Ok(table) = Table::try_from(spec) else {
        return vec!["cannot be written as TOML".into()];
    };
    let pairs = table.iter().filter(|(key, _)| *key != "type");
    let pairs: Vec<String> = pairs.map(|(key, value)| format!("{key} = {value}")).collect();
    if pairs.is_empty() { vec!["no keys".into()] } else { pairs }
}

/// Adds `name` and a list, wrapped at [`WIDTH`] columns.
fn push(text: &mut String, name: &str, items: &[String]) {
    let mut line = format!("  {name:<INDENT$}");
    for (index, item) in items.iter().enumerate() {
        let comma = if index + 1 < items.len() { "," } else { "" };
        if index > 0 && line.len() + item.len() >= WIDTH {
            text.push_str(line.trim_end());
            line = format!("\n  {:<INDENT$}", "");
        }
        line += &format!("{item}{comma} ");
    }
    text.push_str(line.trim_end_matches(' '));
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_listed() {
        let text = text().unwrap();
        for word in [
            "r_couple",
            "desired_speed = 1.2",
            "room_25x25",
            "width = 25.0",
            "double_dqn",
            "set_points",
            "n_smoothings = ",
            "pure_pursuit",
            "occdist_scale = 0.1",
            "jackal",
        ] {
            assert!(text.contains(word), "{word} is missing in\n{text}");
        }
    }

    #[test]
    fn every_choice_has_words() {
        for (what, path) in CHOICES {
            assert!(!choices(path).is_empty(), "{what}: nothing to choose at {path}");
        }
    }
}
