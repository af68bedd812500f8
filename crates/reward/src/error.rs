/// What can be wrong with a reward: its fields, its tag, or its behaviour.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RewardError {
    /// A field holds a number it must not.
    #[error("{field} = {value}: must be {allowed}")]
    Field {
        /// The field's name.
        field: &'static str,
        /// What it holds.
        value: f64,
        /// What it may hold.
        allowed: &'static str,
    },

    /// A term of a [`Sum`](crate::Sum) is wrong.
    #[error("terms[{index}]: {source}")]
    Term {
        /// Which term, from 0.
        index: usize,
        /// What is wrong with it.
        source: Box<RewardError>,
    },

    /// No reward of this name is linked into the binary.
    #[error(
        "unknown reward `{tag}`: this binary knows {}. A plugin's rewards are known only to a binary that links the \
         plugin and names it, as in `use my_rewards as _;` in its main.rs: without that line the linker drops the plugin",
        known.join(", ")
    )]
    Unknown {
        /// The name that was asked for.
        tag: String,
        /// All names there are, sorted.
        known: Vec<&'static str>,
    },

    /// Two rewards claim the same name, so that neither can be loaded.
    #[error(
        "two rewards are named `{tag}`; rename one: a plugin's names begin with its own, as in `my_rewards/overspeed`"
    )]
    Duplicate {
        /// The name they share.
        tag: &'static str,
    },

    /// A reward cannot be loaded from its name alone.
    #[error("`type = \"{tag}\"` alone does not load: {reason}; give the reward `Default` and `#[serde(default)]`")]
    NoDefault {
        /// The reward's name.
        tag: String,
        /// What serde had to say.
        reason: String,
    },

    /// A reward does not survive being written to a spec and read back.
    #[error("cannot be {what}: {reason}")]
    Serde {
        /// What failed: "written to a spec" or "read back from its spec".
        what: &'static str,
        /// What serde had to say.
        reason: String,
    },

    /// A reward ignores a field that it does not have, so that a misspelt field would pass unnoticed.
    #[error("`{tag}` accepts a field it does not have; give it `#[serde(deny_unknown_fields)]`")]
    AcceptsUnknownField {
        /// The reward's name.
        tag: String,
    },

    /// A reward pays infinity or NaN.
    #[error("pays {value}, which is not finite, for {case}")]
    NotFinite {
        /// What it pays.
        value: f64,
        /// The transition.
        case: String,
    },

    /// A reward pays differently for the same transition.
    #[error("is not pure: pays {first}, then {second} for the same {case}")]
    NotPure {
        /// What it paid first.
        first: f64,
        /// What it paid later.
        second: f64,
        /// The transition.
        case: String,
    },

    /// A reward read back from its own spec pays differently: a field that matters is not in the spec.
    #[error("pays {original}, but {reloaded} once written to a spec and read back, for {case}")]
    RoundTrip {
        /// What it pays.
        original: f64,
        /// What its copy pays.
        reloaded: f64,
        /// The transition.
        case: String,
    },

    /// A reward read back from its own spec has another version.
    #[error("has version {original}, but {reloaded} once written to a spec and read back")]
    Version {
        /// Its version.
        original: u32,
        /// Its copy's version.
        reloaded: u32,
    },
}

impl RewardError {
    /// `Ok` where `ok` holds, else the [`Field`](Self::Field) error: the one line per field of
    /// [`Reward::validate`](crate::Reward::validate).
    ///
    /// ```
    /// use headway_reward::RewardError;
    ///
    /// let margin = -1.0;
    /// let error = RewardError::require(margin > 0.0, "margin", margin, "positive").unwrap_err();
    /// assert_eq!(error.to_string(), "margin = -1: must be positive");
    /// ```
    ///
    /// # Errors
    /// [`RewardError::Field`] where `ok` is false.
    pub fn require(ok: bool, field: &'static str, value: f64, allowed: &'static str) -> Result<(), Self> {
        if ok { Ok(()) } else { Err(Self::Field { field, value, allowed }) }
    }

    /// `Ok` where `value` is finite, else the [`Field`](Self::Field) error.
    ///
    /// # Errors
    /// [`RewardError::Field`] where `value` is infinite or NaN.
    pub fn require_finite(field: &'static str, value: f64) -> Result<(), Self> {
        Self::require(value.is_finite(), field, value, "finite")
    }
}
