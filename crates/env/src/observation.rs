//! Observations as data.

use headway_sim::FieldError;
use headway_sim::check::{positive, within};
use serde::{Deserialize, Serialize};

/// What is observed, and how it is encoded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ObservationSpec {
    /// How a lidar range becomes a number.
    pub encoding: ScanEncoding,
    /// Into how many sectors of as many beams each the scan is summed up, each showing its nearest return; 0 for every beam
    /// by itself. A divisor of the number of beams.
    pub n_sectors: usize,
    /// Whether scenes with the goal on the right are shown as in a mirror, so that it always lies on the
    /// left; actions are mirrored back. Halves what there is to learn.
    pub mirror: bool,
    /// Distances ahead on the planned route at which its points are shown by their bearings, metres; needs `env.route`.
    pub look_ahead: Vec<f64>,
    /// Times ago at which the vehicle's own places are shown, seconds: a memory of where it has been. Rounded to control
    /// periods, up to 600 s.
    pub trail: Vec<f64>,
    /// Whether the last command is shown: with a latency it is still on its way.
    pub last_command: bool,
    /// How many of the moving obstacles are shown, the nearest first, by place and velocity; at most 100. Where they are takes
    /// a tracker, which is taken for exact.
    pub n_movers: usize,
}

impl Default for ObservationSpec {
    fn default() -> Self {
        Self {
            encoding: ScanEncoding::Clearance,
            n_sectors: 0,
            mirror: true,
            look_ahead: Vec::new(),
            trail: Vec::new(),
            last_command: false,
            n_movers: 0,
        }
    }
}

/// How a range `r` in metres becomes a number in [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ScanEncoding {
    /// `r / max_range`.
    Linear,
    /// `1 - sqrt(r / max_range)`.
    Root,
    /// `0.25 / (c + 0.25)` with the clearance `c = max(0, r - e)`, where `e` is the footprint's extent
    /// towards the beam: 1 at contact, half at 25 cm.
    Clearance,
}

/// Whether an observation shows the scene as it is or as in a mirror.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Side {
    /// As it is.
    #[default]
    AsSeen,
    /// Left and right exchanged.
    Mirrored,
}

impl ObservationSpec {
    /// Most entries of a list.
    const MOST: usize = 100;

    /// Checks the numbers against the lidar that scans.
    pub(crate) fn check(&self, n_beams: usize) -> Result<(), FieldError> {
        if self.n_sectors > 0 && !n_beams.is_multiple_of(self.n_sectors) {
            return Err(FieldError::new("n_sectors", self.n_sectors, format!("0 or a divisor of the {n_beams} beams")));
        }
        for (field, list, most) in [("look_ahead", &self.look_ahead, 1000.0), ("trail", &self.trail, 600.0)] {
            within(&format!("{field}.len"), list.len() as f64, 0.0, Self::MOST as f64)?;
            for (index, number) in list.iter().enumerate() {
                let field = format!("{field}.{index}");
                positive(&field, *number)?;
                within(&field, *number, 0.0, most)?;
            }
        }
        within("n_movers", self.n_movers as f64, 0.0, Self::MOST as f64)
    }
}
