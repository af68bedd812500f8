//! What an observation remembers.

use std::collections::VecDeque;

use headway_sim::{Point, Pose};
use serde::{Deserialize, Serialize};

/// Where a vehicle was in the last control periods of an episode, by its own odometry.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct History {
    /// The newest first.
    places: VecDeque<Point>,
    /// How many places are remembered.
    n_places: usize,
}

impl History {
    /// A memory of the present place and of `n_periods` before it; it remembers nothing if that is 0.
    #[must_use]
    pub fn new(n_periods: usize) -> Self {
        let n_places = if n_periods == 0 { 0 } else { n_periods + 1 };
        Self { places: VecDeque::with_capacity(n_places), n_places }
    }

    /// Forgets the episode.
    pub fn clear(&mut self) {
        self.places.clear();
    }

    /// Remembers where the vehicle is now: once a control period, the start included, before its observation is encoded.
    pub fn remember(&mut self, pose: &Pose) {
        if self.n_places > 0 {
            self.places.truncate(self.n_places - 1);
            self.places.push_front(pose.translation.vector.into());
        }
    }

    /// The place some control periods ago, or the oldest one; `here` where nothing is remembered.
    pub(crate) fn place(&self, n_periods: usize, here: Point) -> Point {
        self.places.get(n_periods).or(self.places.back()).copied().unwrap_or(here)
    }
}
