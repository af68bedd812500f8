//! Worlds as data.

use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::source::Part;
use super::{BarnSpec, FilesSpec, RoomSpec, WorldSource};
use crate::check::positive;
use crate::{FieldError, Footprint, SimError, stream};

/// How many scenarios of a room are tried when it is built.
const N_TRIALS: u64 = 16;

/// Where scenarios come from, as data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
#[allow(clippy::large_enum_variant, reason = "there are few specs, and a box would be in everybody's way")]
pub enum WorldSpec {
    /// A room with every number given.
    Room(RoomSpec),
    /// The paper's small room: [`RoomSpec::room_10x15`].
    #[serde(rename = "room_10x15")]
    Room10x15 {},
    /// The paper's large room: [`RoomSpec::room_25x25`].
    #[serde(rename = "room_25x25")]
    Room25x25 {},
    /// A corridor and a field of posts, drawn like the worlds of the BARN challenge.
    Barn(BarnSpec),
    /// Worlds from files.
    Files(FilesSpec),
    /// Each scenario from one of several worlds, drawn by weight.
    Mixture {
        /// The worlds.
        worlds: Vec<WeightedWorld>,
    },
}

impl Default for WorldSpec {
    fn default() -> Self {
        Self::Room10x15 {}
    }
}

/// A part of a mixture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WeightedWorld {
    /// Relative frequency, above 0.
    pub weight: f64,
    /// The world.
    pub world: WorldSpec,
}

impl WorldSpec {
    /// The tags of all kinds of worlds.
    pub const TYPES: [&str; 6] = ["room", "room_10x15", "room_25x25", "barn", "files", "mixture"];

    /// Checks the numbers, and makes some scenarios of every part for `footprint`, so that what cannot be
    /// placed, or often cannot, is found out now.
    ///
    /// # Errors
    /// Names the field, or says what does not fit.
    pub fn build(&self, footprint: &Footprint) -> Result<WorldSource, SimError> {
        let mut parts = Vec::new();
        self.collect(1.0, footprint, &mut parts)?;
        for (_, part) in &parts {
            for index in 0..N_TRIALS {
                let names = ["trial-layout", "trial-ends", "trial-crowd"];
                let [layout, ends, crowd] = names.map(|name| stream(0, name, index));
                part.scenario(footprint, layout, ends, crowd)?;
            }
        }
        Ok(WorldSource::new(parts, footprint.clone()))
    }

    /// The parts that are no mixtures, each with its share of all scenarios.
    fn collect(&self, share: f64, footprint: &Footprint, parts: &mut Vec<(f64, Part)>) -> Result<(), SimError> {
        match self {
            Self::Room(room) => {
                room.check()?;
                parts.push((share, Part::Room(room.clone())));
            }
            Self::Room10x15 {} => parts.push((share, Part::Room(RoomSpec::room_10x15()))),
            Self::Room25x25 {} => parts.push((share, Part::Room(RoomSpec::room_25x25()))),
            Self::Barn(barn) => {
                barn.check()?;
                parts.push((share, Part::Barn(barn.clone())));
            }
            Self::Files(files) => parts.push((share, Part::Files(Arc::new(files.build(footprint)?)))),
            Self::Mixture { worlds } => {
                if worlds.is_empty() {
                    return Err(FieldError::new("worlds", "[]", "one world or more").into());
                }
                let place = |i: usize, field: &str| format!("worlds.{i}.{field}");
                for (i, part) in worlds.iter().enumerate() {
                    positive(&place(i, "weight"), part.weight)?;
                }
                let total: f64 = worlds.iter().map(|part| part.weight).sum();
                positive("worlds (the sum of their weights)", total)?;
                for (i, part) in worlds.iter().enumerate() {
                    let share = share * part.weight / total;
                    part.world.collect(share, footprint, parts).map_err(|e| e.under(&place(i, "world")))?;
                }
            }
        }
        Ok(())
    }

    /// All files that scenarios come from, in the order of their mention.
    ///
    /// # Errors
    /// If a folder cannot be listed.
    pub fn files(&self) -> Result<Vec<PathBuf>, SimError> {
        match self {
            Self::Files(files) => files.files(),
            Self::Mixture { worlds } => {
                let parts = worlds.iter().map(|part| part.world.files()).collect::<Result<Vec<_>, _>>()?;
                Ok(parts.concat())
            }
            _ => Ok(Vec::new()),
        }
    }
}
