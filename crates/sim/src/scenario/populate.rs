//! Crowds in scenarios.

use rand_chacha::ChaCha8Rng;

use super::Scenario;
use crate::{CrowdSpec, FieldError, Footprint, SimError};

/// Checks the numbers of a crowd, if there is to be one.
pub(super) fn check_crowd(spec: Option<&CrowdSpec>) -> Result<(), FieldError> {
    spec.map_or(Ok(()), |crowd| crowd.check().map_err(|e| e.under("crowd")))
}

/// A scenario with its crowd, if it is to have one: nobody is near the start or the goal at first. What stands still, the
/// start and the goal stay as they are.
pub(super) fn populate(
    scenario: Scenario,
    spec: Option<&CrowdSpec>,
    footprint: &Footprint,
    rng: &mut ChaCha8Rng,
) -> Result<Scenario, SimError> {
    let Some(spec) = spec else { return Ok(scenario) };
    let Scenario { mut world, start, goal, .. } = scenario;
    let ends = [start.translation.vector.into(), goal].map(|end| (end, footprint.circumradius()));
    let crowd = spec.build(&mut world, &ends, rng).map_err(|e| e.under("crowd"))?;
    Ok(Scenario { world, crowd: Some(crowd), ..scenario })
}
