//! Who is evaluated.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use headway_env::{Control, Mdp, NavSpec};
use headway_planning::{Controller, DriverSpec, ShieldSpec};
use headway_policy::{Driver, Policy};
use serde::Serialize;
use toml::Value;

use crate::Error;
use crate::difference::changes;
use crate::evaluate::adapt;

/// A policy or a classical driver, with or without a shield around it: a driver as often as one is needed.
#[derive(Debug, Clone)]
pub struct Candidate {
    who: Who,
    shield: Option<ShieldSpec>,
}

#[derive(Debug, Clone)]
enum Who {
    Policy { policy: Arc<Policy>, file: Option<PathBuf> },
    Driver(Box<DriverSpec>),
}

/// Who drives, as a report has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Identity {
    /// A policy.
    Policy {
        /// Its file, where it came from one.
        file: Option<PathBuf>,
        /// What it controls.
        control: Control,
        /// Where it comes from, as its file has it.
        provenance: BTreeMap<String, String>,
    },
    /// A classical driver.
    Driver {
        /// Its name.
        name: &'static str,
        /// Its parameters where they are not the defaults of [`DriverSpec::named`], by dotted paths.
        changed: BTreeMap<String, Option<Value>>,
    },
}

impl Candidate {
    /// A policy.
    #[must_use]
    pub fn policy(policy: Arc<Policy>) -> Self {
        Self { who: Who::Policy { policy, file: None }, shield: None }
    }

    /// A policy that was read from a file.
    #[must_use]
    pub fn policy_of(policy: Arc<Policy>, file: &Path) -> Self {
        Self { who: Who::Policy { policy, file: Some(file.to_owned()) }, shield: None }
    }

    /// A classical driver.
    #[must_use]
    pub fn driver_of(spec: DriverSpec) -> Self {
        Self { who: Who::Driver(Box::new(spec)), shield: None }
    }

    /// The same with a shield around it, if one is given.
    #[must_use]
    pub fn shielded(self, shield: Option<ShieldSpec>) -> Self {
        Self { shield, ..self }
    }

    /// The policy of a file.
    ///
    /// # Errors
    /// If it cannot be read or is no policy.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let policy = Policy::load(path).map_err(|error| Error::Input(error.to_string()))?;
        Ok(Self::policy_of(Arc::new(policy), path))
    }

    /// Who it is.
    ///
    /// ```
    /// use headway_experiments::candidate::{Candidate, Identity};
    /// use headway_planning::{DriverSpec, DwaSpec};
    /// let faster = DriverSpec::Dwa(DwaSpec { max_speed: 1.0, ..DwaSpec::default() });
    /// let Identity::Driver { name, changed } = Candidate::driver_of(faster).identity() else { panic!("a driver") };
    /// assert_eq!((name, changed.len()), ("dwa", 1));
    /// assert_eq!(changed["max_speed"], Some(1.0.into()));
    /// ```
    #[must_use]
    pub fn identity(&self) -> Identity {
        match &self.who {
            Who::Policy { policy, file } => {
                let header = policy.header();
                Identity::Policy { file: file.clone(), control: header.control, provenance: header.provenance.clone() }
            }
            Who::Driver(spec) => {
                let tree = |spec: &DriverSpec| Value::try_from(spec).expect("numbers and names have a TOML form");
                let default = DriverSpec::named(spec.name()).unwrap_or_else(|| DriverSpec::clone(spec));
                Identity::Driver { name: spec.name(), changed: changes(&tree(&default), &tree(spec)) }
            }
        }
    }

    /// The shield around it, if there is one.
    #[must_use]
    pub fn shield(&self) -> Option<ShieldSpec> {
        self.shield
    }

    /// Replaces in `rules` what a policy brings along: the route that it is shown, what it observes and controls.
    ///
    /// # Errors
    /// If the policy was made for another vehicle or lidar than `rules` have.
    pub fn rules(&self, mut rules: NavSpec) -> Result<NavSpec, Error> {
        if let Who::Policy { policy, .. } = &self.who {
            policy.check(&rules.vehicle, &rules.lidar).map_err(|error| Error::Input(error.to_string()))?;
            adapt(&mut rules.env, policy);
        }
        Ok(rules)
    }

    /// The decision process of `rules` with what a policy brings along, and a driver in it.
    ///
    /// # Errors
    /// As [`Self::rules`] and [`Self::driver`], or if the decision process cannot be built.
    pub fn set_up(&self, rules: NavSpec) -> Result<(Arc<Mdp>, Box<dyn Controller + Send>), Error> {
        let mdp = self.rules(rules)?.build().map_err(Error::failure)?;
        let driver = self.driver(&mdp)?;
        Ok((mdp, driver))
    }

    /// A driver that has seen nothing, for the vehicle and the lidar of `mdp`.
    ///
    /// # Errors
    /// If the policy was made for others, or a parameter is not allowed.
    pub fn driver(&self, mdp: &Mdp) -> Result<Box<dyn Controller + Send>, Error> {
        let (vehicle, lidar) = (mdp.vehicle().spec(), mdp.lidar().spec());
        let input = |error: &dyn std::error::Error| Error::Input(error.to_string());
        let driver = match &self.who {
            Who::Policy { policy, .. } => {
                Box::new(Driver::new(Arc::clone(policy), vehicle, lidar).map_err(|error| input(&error))?)
            }
            Who::Driver(spec) => {
                spec.suits(vehicle).map_err(|error| input(&error.under("vehicle")))?;
                spec.build().map_err(|error| input(&error.under("policy")))?
            }
        };
        match &self.shield {
            None => Ok(driver),
            Some(shield) => Ok(Box::new(shield.build(driver).map_err(|error| input(&error.under("evaluate.shield")))?)),
        }
    }
}
