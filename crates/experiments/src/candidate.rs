//! Who is evaluated.

use std::path::Path;
use std::sync::Arc;

use headway_env::{Mdp, NavSpec};
use headway_planning::{Controller, DriverSpec, ShieldSpec};
use headway_policy::{Driver, Policy};

use crate::Error;
use crate::evaluate::adapt;

/// A policy or a classical driver, with or without a shield around it: a driver as often as one is needed.
#[derive(Debug, Clone)]
pub struct Candidate {
    who: Who,
    shield: Option<ShieldSpec>,
}

#[derive(Debug, Clone)]
enum Who {
    Policy(Arc<Policy>),
    Driver(Box<DriverSpec>),
}

impl Candidate {
    /// A policy.
    #[must_use]
    pub fn policy(policy: Arc<Policy>) -> Self {
        Self { who: Who::Policy(policy), shield: None }
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
        Ok(Self::policy(Arc::new(policy)))
    }

    /// Replaces in `rules` what a policy brings along: the route that it is shown, what it observes and controls.
    ///
    /// # Errors
    /// If the policy was made for another vehicle or lidar than `rules` have.
    pub fn rules(&self, mut rules: NavSpec) -> Result<NavSpec, Error> {
        if let Who::Policy(policy) = &self.who {
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
            Who::Policy(policy) => {
                Box::new(Driver::new(Arc::clone(policy), vehicle, lidar).map_err(|error| input(&error))?)
            }
            Who::Driver(spec) => {
                spec.suits(vehicle).map_err(|error| input(&error.under("policy")))?;
                spec.build().map_err(|error| input(&error.under("policy")))?
            }
        };
        match &self.shield {
            None => Ok(driver),
            Some(shield) => Ok(Box::new(shield.build(driver).map_err(|error| input(&error.under("evaluate.shield")))?)),
        }
    }
}
