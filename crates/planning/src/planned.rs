//! A driver with a planner of its own.

use headway_sim::Command;

use crate::{Controller, Interventions, Route, ScanPlanner, Sensed};

/// A driver that follows routes, and a [`ScanPlanner`] that gives it one: the same planner for any driver.
///
/// ```
/// use headway_planning::{Controller, Planned, PurePursuit, ScanPlannerSpec, Sensed};
/// use headway_sim::{Point, Pose, Twist, VehicleSpec};
///
/// let vehicle = VehicleSpec::default();
/// let mut driver = Planned::new(ScanPlannerSpec::default().build()?, PurePursuit::default());
/// let (scan, beam_angles) = ([5.0], [0.0]);
/// let (pose, twist, goal) = (Pose::identity(), Twist::zeros(), Point::new(4.0, 0.0));
/// let sensed =
///     Sensed { vehicle: &vehicle, scan: &scan, beam_angles: &beam_angles, max_range: 5.0, pose, twist, goal, route: None, last_command: headway_sim::Command::default(), movers: &[] };
/// assert_eq!(driver.command(&sensed).speed, 1.0);
/// assert!((driver.route().expect("a way is free").length() - 4.0).abs() < 1e-9);
/// # Ok::<(), headway_sim::FieldError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Planned<C> {
    planner: ScanPlanner,
    driver: C,
}

impl<C> Planned<C> {
    /// A driver and its planner.
    pub fn new(planner: ScanPlanner, driver: C) -> Self {
        Self { planner, driver }
    }

    /// The planner, with its map.
    pub fn planner(&self) -> &ScanPlanner {
        &self.planner
    }

    /// The route at present.
    pub fn route(&self) -> Option<&Route> {
        self.planner.route()
    }

    /// The driver.
    pub fn driver(&self) -> &C {
        &self.driver
    }
}

impl<C: Controller> Controller for Planned<C> {
    fn reset(&mut self) {
        self.planner.reset();
        self.driver.reset();
    }

    /// The driver's command for what is sensed, with the planner's route in place of the one given.
    fn command(&mut self, sensed: &Sensed<'_>) -> Command {
        let route = self.planner.update(sensed);
        self.driver.command(&Sensed { route, ..*sensed })
    }

    fn interventions(&self) -> Interventions {
        self.driver.interventions()
    }
}
