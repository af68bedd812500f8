//! Collapse: a policy that does not drive to goals, or cannot learn to, found in numbers.
//!
//! A run can end without an error and be worthless: its policy spins on the spot, parks until the time is up, always does the same.
//! It may have learned what it is paid for: `experiments audit` tells. [`of_training`] judges the rows of a run's metrics,
//! [`of_evaluation`] the episodes that its policy drove in a world; both are pure, and the numbers that led to a verdict stand in it. [`Watchdog`] says it while the training goes on.

mod episodes;
mod training;

pub use episodes::{TIMEOUTS, of_evaluation};
pub use training::{
    ARRIVED, DEAD_UNITS, ENTROPY, EPSILON, N_RECENT, PROGRESS, Q_EXCESS, SPINNING, Watchdog, of_training,
};

use serde::{Deserialize, Serialize};

/// One way in which a policy has collapsed, with the numbers that show it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Collapse {
    /// It turns in circles: the greatest part of the time it does a full turn within ten seconds and gets nowhere.
    Spinning {
        /// Share of time spent so, in \[0, 1\].
        share: f64,
    },
    /// It neither arrives nor comes nearer to its goal.
    NoProgress {
        /// Mean speed of approach to the goal, m/s.
        progress: f64,
        /// Mean of its absolute value, m/s: large for one that goes to and fro, small for one that parks.
        abs_progress: f64,
        /// Share of goals that it reached, in \[0, 1\].
        arrived: f64,
    },
    /// Nearly all units of a hidden layer are closed whatever it observes.
    DeadUnits {
        /// The layer, counted from 1.
        layer: usize,
        /// Share of its units, in \[0, 1\].
        share: f64,
    },
    /// Its values are greater than rewards can add up to.
    ExplodingQ {
        /// Greatest `|Q|`, in scaled rewards.
        max_abs_q: f64,
        /// Greatest return that the rewards seen can give, in scaled rewards.
        bound: f64,
    },
    /// It chooses the same action whatever it observes.
    OneAction {
        /// Entropy of its actions, in \[0, 1\].
        entropy: f64,
    },
    /// It runs out of time in nearly all evaluation episodes of a world.
    TimesOut {
        /// The name of the world.
        world: String,
        /// Share of its episodes, in \[0, 1\].
        timeouts: f64,
        /// The mean speed in it: all distance over all time, m/s.
        mean_speed: f64,
    },
}

impl Collapse {
    /// The name of its kind in JSON.
    ///
    /// ```
    /// use headway_experiments::collapse::Collapse;
    /// assert_eq!(Collapse::OneAction { entropy: 0.0 }.kind(), "one_action");
    /// ```
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Spinning { .. } => "spinning",
            Self::NoProgress { .. } => "no_progress",
            Self::DeadUnits { .. } => "dead_units",
            Self::ExplodingQ { .. } => "exploding_q",
            Self::OneAction { .. } => "one_action",
            Self::TimesOut { .. } => "times_out",
        }
    }

    /// What it does, for a table's cell: `spins`.
    pub fn short(&self) -> &'static str {
        match self {
            Self::Spinning { .. } => "spins",
            Self::NoProgress { .. } => "makes no progress",
            Self::DeadUnits { .. } => "has dead units",
            Self::ExplodingQ { .. } => "has exploding Q",
            Self::OneAction { .. } => "has one action",
            Self::TimesOut { .. } => "times out",
        }
    }

    /// The name of the evaluation world that it was found in; `None` of what the training shows, which holds in every world.
    pub fn world(&self) -> Option<&str> {
        if let Self::TimesOut { world, .. } = self { Some(world) } else { None }
    }

    /// Whether it was found in this evaluation world, or holds in every one.
    pub fn concerns(&self, world: &str) -> bool {
        self.world().is_none_or(|own| own == world)
    }

    /// What it does, where, and the numbers that show it: `spins (78 % of the time)`.
    pub fn describe(&self) -> String {
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        let numbers = match self {
            Self::Spinning { share } => format!("{} of the time", percent(*share)),
            Self::NoProgress { progress, abs_progress, arrived } => {
                format!("{progress:.2} m/s to the goal, {abs_progress:.2} m/s to and fro, {} arrive", percent(*arrived))
            }
            Self::DeadUnits { layer, share } => format!("{} of hidden layer {layer}", percent(*share)),
            Self::ExplodingQ { max_abs_q, bound } => format!("|Q| up to {max_abs_q:.3}, returns up to {bound:.3}"),
            Self::OneAction { entropy } => format!("entropy {entropy:.3}"),
            Self::TimesOut { timeouts, mean_speed, .. } => {
                format!("{} of evaluation episodes, at {mean_speed:.2} m/s", percent(*timeouts))
            }
        };
        let place = self.world().map_or_else(String::new, |world| format!(" in {world}"));
        format!("{}{place} ({numbers})", self.short())
    }
}

/// The verdicts on one run without their numbers, each kind once: `spins`, `times out in 10x15 and 25x25`.
pub(crate) fn kinds(found: &[Collapse]) -> Vec<String> {
    let mut kinds: Vec<(&str, Vec<&str>)> = Vec::new();
    for collapse in found {
        match kinds.iter_mut().find(|(kind, _)| *kind == collapse.short()) {
            Some((_, worlds)) => worlds.extend(collapse.world()),
            None => kinds.push((collapse.short(), collapse.world().into_iter().collect())),
        }
    }
    let told = |(kind, worlds): &(&str, Vec<&str>)| match &worlds[..] {
        [] => (*kind).to_owned(),
        [others @ .., last] if !others.is_empty() => format!("{kind} in {} and {last}", others.join(", ")),
        [world, ..] => format!("{kind} in {world}"),
    };
    kinds.iter().map(told).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_told_once_with_their_worlds() {
        let times_out = |world: &str| Collapse::TimesOut { world: world.into(), timeouts: 1.0, mean_speed: 0.5 };
        let spins = Collapse::Spinning { share: 0.8 };
        assert_eq!(kinds(&[]), Vec::<String>::new());
        assert_eq!(kinds(&[spins.clone(), times_out("a")]), ["spins", "times out in a"]);
        assert_eq!(kinds(&[times_out("a"), spins.clone(), times_out("b")]), ["times out in a and b", "spins"]);
        assert_eq!(kinds(&["a", "b", "c"].map(times_out)), ["times out in a, b and c"]);
        assert!(spins.concerns("a") && times_out("a").concerns("a") && !times_out("a").concerns("b"));
    }
}
