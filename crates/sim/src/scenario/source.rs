//! Where scenarios come from.

use rand::RngExt;

use super::{RoomSpec, Scenario, generate};
use crate::{Footprint, SimError, stream};

/// A checked source of scenarios for one footprint.
#[derive(Debug, Clone)]
pub struct WorldSource {
    /// The rooms, each with its share of all scenarios.
    rooms: Vec<(f64, RoomSpec)>,
    footprint: Footprint,
}

impl WorldSource {
    pub(super) fn new(rooms: Vec<(f64, RoomSpec)>, footprint: Footprint) -> Self {
        Self { rooms, footprint }
    }

    /// The scenario number `index` of a seed.
    ///
    /// The choice of the world, its size and its obstacles come from the random stream "layout", the start
    /// with its yaw and the goal from "start-goal", the crowd, if there is one, from "crowd". So the layout stays what it is under another goal rule or
    /// footprint, or with a crowd, unless there is no start and goal, or no place for the crowd, in it: then the obstacles are placed anew.
    ///
    /// # Errors
    /// Says what could not be placed, if the spec leaves too little room.
    ///
    /// ```
    /// use headway_sim::{Footprint, Shape, WorldSpec};
    /// let vehicle = Footprint::new(&Shape::Disc { radius: 0.25 })?;
    /// let source = WorldSpec::Room10x15 {}.build(&vehicle)?;
    /// let scenario = source.scenario(0, 0)?;
    /// assert_eq!(scenario.world.obstacles().len(), 12);
    /// assert!(!scenario.world.collides(&vehicle, &scenario.start));
    /// # Ok::<(), headway_sim::SimError>(())
    /// ```
    pub fn scenario(&self, seed: u64, index: u64) -> Result<Scenario, SimError> {
        let mut layout = stream(seed, "layout", index);
        let room = self.choose(&mut layout);
        let [ends, crowd] = ["start-goal", "crowd"].map(|name| stream(seed, name, index));
        generate::scenario(room, &self.footprint, layout, ends, crowd)
    }

    /// One of the rooms, by their shares.
    fn choose(&self, rng: &mut impl RngExt) -> &RoomSpec {
        let mut share = if self.rooms.len() > 1 { rng.random_range(0.0..1.0) } else { 0.0 };
        let mut chosen = &self.rooms[0].1;
        for (weight, room) in &self.rooms {
            chosen = room;
            if share < *weight {
                break;
            }
            share -= weight;
        }
        chosen
    }
}
