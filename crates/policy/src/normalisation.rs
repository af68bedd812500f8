//! The constants by which observations are scaled.

use headway_env::Encoder;
use headway_sim::FieldError;
use serde::{Deserialize, Serialize};

/// The constants of the [`Encoder`] by which metres become inputs of the network.
///
/// They are part of the program, not of any spec; the default is what this program encodes by. A policy that
/// was trained with others would read wrong inputs and is refused.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Normalisation {
    /// [`Encoder::FAR`], metres.
    pub far: f64,
    /// [`Encoder::NEAR`], metres.
    pub near: f64,
    /// [`Encoder::HALF_CLEARANCE`], metres.
    pub half_clearance: f32,
}

impl Default for Normalisation {
    fn default() -> Self {
        Self { far: Encoder::FAR, near: Encoder::NEAR, half_clearance: Encoder::HALF_CLEARANCE }
    }
}

impl Normalisation {
    /// Refuses other constants than this program's.
    pub(crate) fn check(&self) -> Result<(), FieldError> {
        let own = Self::default();
        same("far", self.far, own.far)?;
        same("near", self.near, own.near)?;
        same("half_clearance", self.half_clearance, own.half_clearance)
    }
}

fn same<T: PartialEq + ToString>(field: &str, found: T, own: T) -> Result<(), FieldError> {
    if found == own {
        return Ok(());
    }
    Err(FieldError::new(field, found, format!("{}, by which this program encodes observations", own.to_string())))
}
