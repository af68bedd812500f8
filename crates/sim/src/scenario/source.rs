//! Where scenarios come from.

use std::sync::Arc;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::files_spec::Files;
use super::{BarnSpec, RoomSpec, Scenario, generate};
use crate::{Footprint, SimError, stream};

/// One kind of world of a source.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant, reason = "a source has few parts")]
pub(super) enum Part {
    Room(RoomSpec),
    Barn(BarnSpec),
    Files(Arc<Files>),
}

impl Part {
    /// A scenario from random streams for the layout, the start and the goal, and the crowd.
    pub(super) fn scenario(
        &self,
        footprint: &Footprint,
        layout: impl RngExt,
        ends: impl RngExt,
        crowd: ChaCha8Rng,
    ) -> Result<Scenario, SimError> {
        match self {
            Self::Room(room) => generate::scenario(room, footprint, layout, ends, crowd),
            Self::Barn(barn) => barn.scenario(footprint, layout, crowd),
            Self::Files(files) => files.scenario(footprint, layout, ends, crowd),
        }
    }
}

/// A checked source of scenarios for one footprint.
#[derive(Debug, Clone)]
pub struct WorldSource {
    /// Each with its share of all scenarios.
    parts: Vec<(f64, Part)>,
    footprint: Footprint,
}

impl WorldSource {
    pub(super) fn new(parts: Vec<(f64, Part)>, footprint: Footprint) -> Self {
        Self { parts, footprint }
    }

    /// The scenario number `index` of a seed.
    ///
    /// The choice of the world, its size and its obstacles come from the random stream "layout", the start
    /// with its yaw and the goal from "start-goal", the crowd, if there is one, from "crowd". So all that stands still, the
    /// start and the goal are the same with and without a crowd; and the layout stays what it is under another goal rule or
    /// footprint, unless there is no start and goal in it: then the obstacles are placed anew.
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
        let part = self.choose(&mut layout);
        let [ends, crowd] = ["start-goal", "crowd"].map(|name| stream(seed, name, index));
        part.scenario(&self.footprint, layout, ends, crowd)
    }

    /// What world files hold and their worlds do not, each as "path: what", where their spec says
    /// `unsupported = "ignore"`.
    ///
    /// ```
    /// let vehicle = headway_sim::Footprint::new(&headway_sim::Shape::Disc { radius: 0.25 })?;
    /// assert!(headway_sim::WorldSpec::Room10x15 {}.build(&vehicle)?.left_out().is_empty());
    /// # Ok::<(), headway_sim::SimError>(())
    /// ```
    #[must_use]
    pub fn left_out(&self) -> Vec<String> {
        let files =
            self.parts.iter().filter_map(|(_, part)| if let Part::Files(files) = part { Some(files) } else { None });
        files.flat_map(|files| files.left_out()).collect()
    }

    /// One of the parts, by their shares.
    fn choose(&self, rng: &mut impl RngExt) -> &Part {
        let mut share = if self.parts.len() > 1 { rng.random_range(0.0..1.0) } else { 0.0 };
        let mut chosen = &self.parts[0].1;
        for (weight, part) in &self.parts {
            chosen = part;
            if share < *weight {
                break;
            }
            share -= weight;
        }
        chosen
    }
}
