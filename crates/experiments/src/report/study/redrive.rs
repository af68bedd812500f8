//! Who drove in a run, and where, from what its folder says.

use std::sync::Arc;

use headway_env::{ActionSet, Control, Mdp};
use headway_planning::{Controller, ShieldSpec};
use headway_sim::WorldSpec;
use serde::Deserialize;
use toml::{Table, Value};

use crate::Error;
use crate::candidate::{Candidate, Identity};
use crate::spec::{EvaluateWorld, PolicySpec, RunSpec};
use crate::store::{EvaluationFolder, RunFolder};

/// The part of an evaluation's `spec.toml` that says where to drive.
#[derive(Debug, Deserialize)]
struct Rules {
    seed: u64,
    time_limit: f64,
    shield: Option<ShieldSpec>,
    world: WorldSpec,
}

/// An evaluation, set up as it was.
pub(super) struct Evaluation {
    pub(super) mdp: Arc<Mdp>,
    pub(super) driver: Box<dyn Controller + Send>,
    /// The seed of the scenarios.
    pub(super) seed: u64,
    /// The spec of the run, as far as driving depends on it.
    pub(super) spec: RunSpec,
    /// Whether commands are actions of a policy, as they are unless a path follower steers.
    is_by_actions: bool,
}

impl Evaluation {
    /// That of a run, from their folders.
    ///
    /// # Errors
    /// If a file in them cannot be read, the policy does not fit its own run, or a world file is no longer there.
    pub(super) fn of(run: &RunFolder, evaluation: &EvaluationFolder) -> Result<Self, Error> {
        let spec = run_spec(run.spec()?)?;
        let rules: Rules = Value::Table(evaluation.spec()?).try_into().map_err(Error::failure)?;
        let candidate = match &spec.policy {
            PolicySpec::Learned {} => Candidate::load(&run.policy_path())?,
            PolicySpec::File { path } => Candidate::load(path)?,
            driver => Candidate::driver_of(driver.driver().expect("all others are classical drivers")),
        };
        let is_by_actions = matches!(candidate.identity(), Identity::Policy { control: Control::Full {}, .. });
        let world = EvaluateWorld { name: String::new(), time_limit: rules.time_limit, world: rules.world };
        let (mdp, driver) = candidate.shielded(rules.shield).set_up(spec.evaluation(&world))?;
        Ok(Self { mdp, driver, seed: rules.seed, spec, is_by_actions })
    }

    /// The actions that the driver chooses among; none of what commands freely.
    pub(super) fn actions(&self) -> Option<&ActionSet> {
        self.is_by_actions.then(|| self.mdp.actions())
    }
}

/// The tables of a run that driving depends on; what was paid and how it learned makes no difference any more, and a reward
/// may come from a plugin that is not here.
fn run_spec(mut tables: Table) -> Result<RunSpec, Error> {
    for table in ["files", "world", "reward", "agent", "train"] {
        tables.remove(table);
    }
    Value::Table(tables).try_into().map_err(Error::failure)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rewards_of_plugins_do_not_matter() {
        let tables: Table = toml::from_str(
            "files = [\"ab\"]\n[lidar]\nn_beams = 7\n[reward]\ntype = \"not/here\"\n[policy]\ntype = \"vfh\"",
        )
        .unwrap();
        let spec = run_spec(tables).unwrap();
        assert_eq!(spec.lidar.n_beams, 7);
        assert!(matches!(spec.policy, PolicySpec::Vfh(_)));
    }
}
