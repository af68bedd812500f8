//! Classical drivers by name.

use headway_sim::{Drive, FieldError, VehicleSpec};
use serde::{Deserialize, Serialize};

use crate::{Controller, DwaSpec, PurePursuit, RegulatedPursuitSpec, VfhSpec};

/// A classical driver as data: its name and its parameters, of which any may be left out.
///
/// ```
/// use headway_planning::DriverSpec;
/// assert!(DriverSpec::TYPES.into_iter().all(|name| DriverSpec::named(name).is_some_and(|spec| spec.build().is_ok())));
/// let bad = DriverSpec::Vfh(headway_planning::VfhSpec { n_sectors: 1, ..Default::default() });
/// assert_eq!(bad.build().err().map(|error| error.field), Some("n_sectors".to_owned()));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
#[allow(clippy::large_enum_variant, reason = "there are few specs, and a box would be in everybody's way")]
pub enum DriverSpec {
    /// The dynamic window approach: [`crate::Dwa`].
    Dwa(DwaSpec),
    /// Regulated pure pursuit, what robots use under that name: [`crate::RegulatedPursuit`].
    PurePursuit(RegulatedPursuitSpec),
    /// Pure pursuit at one speed, which looks at no scan: [`PurePursuit`].
    PlainPursuit(PurePursuit),
    /// The vector field histogram, VFH+: [`crate::Vfh`].
    Vfh(VfhSpec),
}

impl DriverSpec {
    /// The names of all drivers.
    pub const TYPES: [&str; 4] = ["dwa", "pure_pursuit", "plain_pursuit", "vfh"];

    /// The driver of a name with its default parameters, if there is one.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "dwa" => Some(Self::Dwa(DwaSpec::default())),
            "pure_pursuit" => Some(Self::PurePursuit(RegulatedPursuitSpec::default())),
            "plain_pursuit" => Some(Self::PlainPursuit(PurePursuit::default())),
            "vfh" => Some(Self::Vfh(VfhSpec::default())),
            _ => None,
        }
    }

    /// Its name.
    ///
    /// ```
    /// use headway_planning::DriverSpec;
    /// for name in DriverSpec::TYPES {
    ///     assert_eq!(DriverSpec::named(name).unwrap().name(), name);
    /// }
    /// ```
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Dwa(_) => "dwa",
            Self::PurePursuit(_) => "pure_pursuit",
            Self::PlainPursuit(_) => "plain_pursuit",
            Self::Vfh(_) => "vfh",
        }
    }

    /// Checks that it can drive a vehicle: all but pure pursuit, regulated and plain, turn on the spot now and then.
    ///
    /// # Errors
    /// Names the vehicle's drive if that cannot do it, and who could drive it.
    ///
    /// ```
    /// use headway_planning::DriverSpec;
    /// let car = headway_sim::VehiclePreset::F1tenth.spec();
    /// let refusal = DriverSpec::named("vfh").unwrap().suits(&car).unwrap_err();
    /// assert_eq!((&refusal.field[..], &refusal.value[..]), ("drive.type", "ackermann"));
    /// assert!(DriverSpec::named("pure_pursuit").unwrap().suits(&car).is_ok());
    /// ```
    pub fn suits(&self, vehicle: &VehicleSpec) -> Result<(), FieldError> {
        match self {
            Self::Dwa(_) | Self::Vfh(_) if matches!(vehicle.drive, Drive::Ackermann { .. }) => {
                let allowed = format!(
                    "differential or omnidirectional for {}, which turns on the spot; of the classical drivers, \
                     pure_pursuit and plain_pursuit can drive Ackermann vehicles",
                    self.name()
                );
                Err(FieldError::new("drive.type", "ackermann", allowed))
            }
            _ => Ok(()),
        }
    }

    /// Checks the numbers and makes a driver that has seen nothing.
    ///
    /// # Errors
    /// Names the field that is not allowed.
    pub fn build(&self) -> Result<Box<dyn Controller + Send>, FieldError> {
        Ok(match self {
            Self::Dwa(spec) => Box::new(spec.build()?),
            Self::PurePursuit(spec) => Box::new(spec.build()?),
            Self::PlainPursuit(spec) => {
                spec.check()?;
                Box::new(*spec)
            }
            Self::Vfh(spec) => Box::new(spec.build()?),
        })
    }
}
