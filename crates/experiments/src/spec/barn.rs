//! The conditions of the BARN challenge as a spec.

use std::f64::consts::PI;

use headway_env::{EnvSpec, RouteSource};
use headway_planning::{CostmapSpec, DwaSpec, Escape, ScanPlannerSpec};
use headway_sensors::LidarSpec;
use headway_sim::{BarnSpec, Shape, VehiclePreset, VehicleSpec, WorldSpec};

use super::resolved::Resolved;
use super::{Assignment, EvaluateSpec, EvaluateWorld, Place, PolicySpec, RunSpec, SpecError};
use crate::protocol::barn::{REACH_RADIUS, TIME_LIMIT};

impl RunSpec {
    /// The conditions of the BARN challenge for classical drivers: a Jackal with 20 commands a second and a lidar of 720 beams over
    /// 270 degrees; a planner over what that shows, and the dynamic window approach, both with the costmap that the
    /// challenge published (a footprint of 0.42 x 0.33 m, padded by 0.1 m).
    ///
    /// The vehicle does what it is told at once. [`VehiclePreset::JackalGazebo`] does not, and comes near the figures published
    /// from Gazebo.
    #[must_use]
    pub fn barn() -> Self {
        let costmap =
            CostmapSpec { footprint: Some(Shape::Box { length: 0.42, width: 0.33 }), ..CostmapSpec::default() };
        let planner = ScanPlannerSpec { costmap: costmap.clone(), ..ScanPlannerSpec::default() };
        let world = WorldSpec::Barn(BarnSpec::default());
        let evaluate = EvaluateWorld { name: "barn".into(), time_limit: TIME_LIMIT, world: world.clone() };
        Self {
            world,
            vehicle: VehicleSpec { control_period: 0.05, ..VehiclePreset::Jackal.spec() },
            lidar: LidarSpec {
                n_beams: 720,
                field_of_view: 1.5 * PI,
                min_range: 0.1,
                max_range: 10.0,
                ..LidarSpec::default()
            },
            env: EnvSpec {
                reach_radius: REACH_RADIUS,
                time_limit: TIME_LIMIT,
                route: RouteSource::Scans(planner),
                ..EnvSpec::default()
            },
            policy: PolicySpec::Dwa(DwaSpec { costmap, escape: Escape::Always, ..DwaSpec::default() }),
            evaluate: EvaluateSpec { worlds: vec![evaluate], ..EvaluateSpec::default() },
            ..Self::default()
        }
    }

    /// The same after assignments, checked.
    ///
    /// # Errors
    /// Names the path, the value, and what is allowed there.
    pub fn assigned(self, sets: &[Assignment]) -> Result<Self, SpecError> {
        let error = |refusal: super::resolved::Refusal| SpecError {
            place: Box::new(Place::CommandLine),
            path: Some(refusal.path),
            value: refusal.value,
            problem: refusal.problem,
        };
        let mut run = Resolved::of(self).map_err(error)?;
        sets.iter().try_for_each(|set| run.set(&set.path, set.value.clone())).map_err(error)?;
        run.spec.check().map_err(|fault| error(fault.in_tree(&run.tree)))?;
        Ok(run.spec)
    }
}
