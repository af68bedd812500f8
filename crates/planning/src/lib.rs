//! Who drives and by which route: the [`Controller`] seam, maps from worlds and from scans, A* search, pure pursuit (plain and
//! regulated), the dynamic window approach, VFH+, and a braking shield around any driver.
//!
//! The crate knows no reward and no learning. A [`Controller`] turns what a vehicle perceives
//! ([`Sensed`]) into a [`headway_sim::Command`]; learned policies and classical planners are the same to
//! those who let them drive.
//!
//! # Example
//! ```
//! use headway_planning::{GridMap, PurePursuit, plan};
//! use headway_sim::{Obstacle, Point, Room, Shape, World};
//!
//! let pillar = Obstacle { shape: Shape::Disc { radius: 1.0 }, x: 5.0, y: 5.0, yaw: 0.0 };
//! let world = World::new(Room::new(10.0, 10.0), vec![pillar])?;
//! let map = GridMap::from_world(&world, 0.1, 0.3);
//! let route = plan(&map, &Point::new(1.0, 5.0), &Point::new(9.0, 5.0)).expect("there is room to both sides");
//! assert!(route.length() > 8.0 && route.length() < 9.0);
//! # Ok::<(), headway_sim::SimError>(())
//! ```

mod controller;
mod costmap;
mod driver_spec;
mod dwa;
mod grid;
mod outline;
mod planned;
mod pure_pursuit;
mod regulated_pursuit;
mod route;
mod scan_map;
mod scan_planner;
mod search;
mod shield;
mod sweep;
#[cfg(test)]
mod trial;
mod vfh;

pub use controller::{Controller, Interventions, Sensed};
pub use costmap::{Costmap, CostmapSpec, INSCRIBED, LETHAL};
pub use driver_spec::DriverSpec;
pub use dwa::{Dwa, DwaSpec, Escape, ObstacleCost};
pub use grid::GridMap;
pub use planned::Planned;
pub use pure_pursuit::PurePursuit;
pub use regulated_pursuit::{RegulatedPursuit, RegulatedPursuitSpec};
pub use route::Route;
pub use scan_map::{CellState, ScanMap, ScanMapSpec};
pub use scan_planner::{ScanPlanner, ScanPlannerSpec};
pub use search::plan;
pub use shield::{Shield, ShieldSpec};
pub use vfh::{Vfh, VfhSpec};
