//! The YAML of a map.

use serde::Deserialize;

use crate::check::{fraction, within};
use crate::files::error::quoted;
use crate::files::{FileError, start_goal};
use crate::{FieldError, Point, Pose};

/// The largest YAML file, bytes: it holds ten lines.
const MOST_BYTES: usize = 1 << 20;

/// What a map's YAML says.
#[derive(Debug, Deserialize)]
pub(super) struct Header {
    pub(super) image: String,
    pub(super) resolution: f64,
    origin: Vec<f64>,
    pub(super) occupied_thresh: f64,
    pub(super) free_thresh: f64,
    #[serde(default)]
    negate: Switch,
    #[serde(default)]
    pub(super) mode: Mode,
    #[serde(default)]
    headway: Ends,
}

/// How lightness becomes occupancy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Mode {
    #[default]
    Trinary,
    Scale,
    Raw,
}

/// A truth value as ROS writes it.
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "negate must be 0, 1, false or true")]
enum Switch {
    Truth(bool),
    Number(u8),
}

impl Default for Switch {
    fn default() -> Self {
        Self::Truth(false)
    }
}

/// Where to drive.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Ends {
    start: Option<Vec<f64>>,
    goal: Option<Vec<f64>>,
}

impl Header {
    pub(super) fn parse(yaml: &[u8]) -> Result<Self, FileError> {
        if yaml.len() > MOST_BYTES {
            let allowed = format!("at most {MOST_BYTES} bytes of YAML");
            return Err(FileError::at("", FieldError::new("size", yaml.len(), allowed)));
        }
        let text = std::str::from_utf8(yaml).map_err(|e| FileError::malformed("", "UTF-8", e))?;
        let options = serde_saphyr::options! {
            budget: serde_saphyr::budget! { max_nodes: 10_000, max_events: 100_000, max_documents: 1 },
            with_snippet: false,
        };
        let header: Self = serde_saphyr::from_str_with_options(text, options)
            .map_err(|e| FileError::malformed("", "map of map_server", e))?;
        header.check().map_err(|e| FileError::at("", e))?;
        Ok(header)
    }

    fn check(&self) -> Result<(), FieldError> {
        if self.image.trim().is_empty() {
            return Err(FieldError::new("image", quoted(&self.image), "the name of a PGM or PNG file"));
        }
        within("resolution", self.resolution, 1e-4, 1e3)?;
        if self.origin.len() != 3 {
            return Err(FieldError::new("origin", format!("{} numbers", self.origin.len()), "[x, y, yaw]"));
        }
        for (field, value) in ["origin.x", "origin.y"].iter().zip(&self.origin) {
            within(field, *value, -1e6, 1e6)?;
        }
        start_goal::checked("origin.yaw", self.origin[2])?;
        fraction("occupied_thresh", self.occupied_thresh)?;
        fraction("free_thresh", self.free_thresh)?;
        if self.free_thresh > self.occupied_thresh {
            let allowed = format!("at most occupied_thresh = {}: are the two swapped?", self.occupied_thresh);
            return Err(FieldError::new("free_thresh", self.free_thresh, allowed));
        }
        match self.negate {
            Switch::Number(number) if number > 1 => Err(FieldError::new("negate", number, "0, 1, false or true")),
            _ => Ok(()),
        }
    }

    /// The lower left corner.
    pub(super) fn corner(&self) -> [f64; 2] {
        [self.origin[0], self.origin[1]]
    }

    pub(super) fn yaw(&self) -> f64 {
        self.origin[2]
    }

    pub(super) fn is_negated(&self) -> bool {
        matches!(self.negate, Switch::Truth(true) | Switch::Number(1))
    }

    pub(super) fn start(&self) -> Result<Option<Pose>, FileError> {
        self.headway.start.as_deref().map(start_goal::start).transpose().map_err(|e| FileError::at("headway", e))
    }

    pub(super) fn goal(&self) -> Result<Option<Point>, FileError> {
        self.headway.goal.as_deref().map(start_goal::goal).transpose().map_err(|e| FileError::at("headway", e))
    }
}
