//! Checks of plain numbers, made once, when a spec is built.
//!
//! ```
//! use headway_sim::check::within;
//! let refusal = within("dropout", 1.5, 0.0, 1.0).unwrap_err().under("lidar");
//! assert_eq!(refusal.to_string(), "lidar.dropout = 1.5: must be from 0 to 1");
//! ```

/// A field whose value is not allowed: which one, what it is, and what would do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{field} = {value}: must be {allowed}")]
pub struct FieldError {
    /// Dotted path of the field within its spec.
    pub field: String,
    /// The value as given.
    pub value: String,
    /// What is allowed, in words.
    pub allowed: String,
}

impl FieldError {
    /// The refusal of `value` in `field`.
    pub fn new(field: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self { field: field.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// The same refusal seen from a spec that holds this one under `parent`.
    #[must_use]
    pub fn under(mut self, parent: &str) -> Self {
        self.field = format!("{parent}.{}", self.field);
        self
    }
}

fn require(ok: bool, field: &str, value: f64, allowed: impl Into<String>) -> Result<(), FieldError> {
    if ok && value.is_finite() { Ok(()) } else { Err(FieldError::new(field, value, allowed)) }
}

/// Refuses all but finite numbers above 0.
///
/// # Errors
/// Names the field and the value.
pub fn positive(field: &str, value: f64) -> Result<(), FieldError> {
    require(value > 0.0, field, value, "a finite number above 0")
}

/// Refuses all but finite numbers from 0 up.
///
/// # Errors
/// Names the field and the value.
pub fn non_negative(field: &str, value: f64) -> Result<(), FieldError> {
    require(value >= 0.0, field, value, "a finite number, 0 or above")
}

/// Refuses all but numbers from 0 to 1.
///
/// # Errors
/// Names the field and the value.
pub fn fraction(field: &str, value: f64) -> Result<(), FieldError> {
    within(field, value, 0.0, 1.0)
}

/// Refuses all but numbers from `low` to `high`.
///
/// # Errors
/// Names the field, the value and both bounds.
pub fn within(field: &str, value: f64, low: f64, high: f64) -> Result<(), FieldError> {
    let allowed = format!("from {low} to {high}");
    require((low..=high).contains(&value), field, value, allowed)
}

/// Refuses counts below `least`.
///
/// # Errors
/// Names the field, the value and the bound.
pub fn at_least(field: &str, value: usize, least: usize) -> Result<(), FieldError> {
    if value >= least { Ok(()) } else { Err(FieldError::new(field, value, format!("{least} or more"))) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_field_value_and_what_is_allowed() {
        let error = positive("radius", -0.3).unwrap_err().under("footprint");
        assert_eq!(error.to_string(), "footprint.radius = -0.3: must be a finite number above 0");
    }

    #[test]
    fn not_a_number_is_never_allowed() {
        for check in [positive, non_negative, fraction] {
            assert!(check("x", f64::NAN).is_err());
            assert!(check("x", f64::INFINITY).is_err());
        }
    }
}
