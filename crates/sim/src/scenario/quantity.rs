//! Numbers of which a part is drawn: ranges, counts, kinds.

use std::fmt;
use std::ops::RangeInclusive;

use rand::RngExt;
use serde::{Deserialize, Serialize};

use crate::FieldError;
use crate::check::{non_negative, positive};

/// A number, or a range from which one is drawn uniformly: `2.5` or `[2.0, 3.0]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a number or a range [low, high]")]
pub enum Interval {
    /// Always this.
    Fixed(f64),
    /// Anything from the first to the second.
    Range([f64; 2]),
}

impl Interval {
    /// The least and the greatest value.
    #[must_use]
    pub fn bounds(&self) -> RangeInclusive<f64> {
        match *self {
            Self::Fixed(value) => value..=value,
            Self::Range([low, high]) => low..=high,
        }
    }

    /// A draw.
    pub fn sample(&self, rng: &mut impl RngExt) -> f64 {
        match *self {
            Self::Fixed(value) => value,
            Self::Range(_) => rng.random_range(self.bounds()),
        }
    }

    /// Checks both ends as a number would be, and their order.
    ///
    /// # Errors
    /// What `number` says of an end under the name of the field, or that the upper end comes first.
    ///
    /// ```
    /// use headway_sim::{Interval, check::non_negative};
    /// let check = |interval: Interval| interval.check("speed", non_negative).map_err(|error| error.to_string());
    /// assert_eq!(check(Interval::Range([0.0, 1.0])), Ok(()));
    /// assert_eq!(check(Interval::Range([2.0, 1.0])).unwrap_err(), "speed = [2, 1]: must be a range with its lower end first");
    /// ```
    pub fn check(&self, field: &str, number: fn(&str, f64) -> Result<(), FieldError>) -> Result<(), FieldError> {
        let (low, high) = self.bounds().into_inner();
        number(field, low)?;
        number(field, high)?;
        if low > high {
            return Err(FieldError::new(field, self, "a range with its lower end first"));
        }
        Ok(())
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed(value) => write!(f, "{value}"),
            Self::Range([low, high]) => write!(f, "[{low}, {high}]"),
        }
    }
}

/// How many obstacles: `{ count = 12 }` or `{ density = 0.08 }`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// This many, at most 10 000.
    Count(usize),
    /// This many per square metre of the room, at most 100, rounded to the nearest whole number.
    Density(Interval),
}

/// Relative frequencies of the kinds of obstacles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Kinds {
    /// Discs.
    pub disc: f64,
    /// Rectangles of random proportions and yaw.
    pub r#box: f64,
    /// Convex polygons with three to seven corners on a circle.
    pub polygon: f64,
}

impl Default for Kinds {
    fn default() -> Self {
        Self { disc: 1.0, r#box: 0.0, polygon: 0.0 }
    }
}

impl Kinds {
    /// Checks the weights of a spec's field `kinds`.
    pub(crate) fn check(&self) -> Result<(), FieldError> {
        let Self { disc, r#box, polygon } = *self;
        for (field, weight) in [("kinds.disc", disc), ("kinds.box", r#box), ("kinds.polygon", polygon)] {
            non_negative(field, weight)?;
        }
        positive("kinds (their sum)", disc + r#box + polygon)
    }
}
