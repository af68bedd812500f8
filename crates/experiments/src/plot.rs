//! Drives as pictures: the room with the path coloured by speed, and the speed over time, as SVG.
//!
//! After the third figure of Liu et al., "Adaptive speed planning for Unmanned Vehicle Based on Deep Reinforcement
//! Learning". The pictures are plain SVG without scripts or outside parts: any browser, Inkscape or `rsvg-convert` shows
//! them.

pub(crate) mod colour;
mod figure;
mod png;
mod room;
pub(crate) mod scale;
mod speed;
pub(crate) mod svg;

pub use figure::{figure, small_multiples};
pub use png::{Picture, PngError, PngRenderer};

use crate::episode::Outcome;

/// A drive to be drawn: where, past what, and how. Lengths in m, angles in radians; the room, or the part of it that is
/// shown, is `[x, x + width] x [y, y + height]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// What stands above the room, such as the world and the scenario.
    pub title: String,
    /// Left end of the room, m.
    pub x: f64,
    /// Lower end of the room, m.
    pub y: f64,
    /// Extent of the room in x, m, positive.
    pub width: f64,
    /// Extent of the room in y, m, positive.
    pub height: f64,
    /// The obstacles that stand still.
    pub obstacles: Vec<Outline>,
    /// Those that move.
    pub movers: Vec<Track>,
    /// The goal, m.
    pub goal: [f64; 2],
    /// Distance from the goal at which it counts as reached, m.
    pub reach_radius: f64,
    /// Radius of the disc that stands for the vehicle, m.
    pub footprint_radius: f64,
    /// The drive, in the order of time.
    pub samples: Vec<PathSample>,
    /// How it ended.
    pub outcome: Outcome,
}

/// The vehicle at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathSample {
    /// Time since the start, s.
    pub t: f64,
    /// Position, m.
    pub x: f64,
    /// Position, m.
    pub y: f64,
    /// Heading, rad, counter-clockwise from x.
    pub yaw: f64,
    /// Forward speed, m/s.
    pub speed: f64,
}

/// The outline of an obstacle, m.
#[derive(Debug, Clone, PartialEq)]
pub enum Outline {
    /// A disc.
    Disc {
        /// The centre.
        x: f64,
        /// The centre.
        y: f64,
        /// The radius.
        radius: f64,
    },
    /// A polygon.
    Polygon {
        /// The vertices, in either direction round.
        points: Vec<[f64; 2]>,
    },
}

/// An obstacle that moves, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Its outline when the drive began.
    pub first: Outline,
    /// Its outline when the drive ended.
    pub last: Outline,
    /// Where it was, in the order of time.
    pub places: Vec<[f64; 2]>,
}

impl Track {
    /// That of an obstacle which has not moved yet.
    #[must_use]
    pub fn new(first: Outline) -> Self {
        Self { last: first.clone(), first, places: Vec::new() }
    }
}

impl Trajectory {
    /// The duration of the drive, s.
    fn duration(&self) -> f64 {
        match (self.samples.first(), self.samples.last()) {
            (Some(first), Some(last)) => last.t - first.t,
            _ => 0.0,
        }
    }

    /// The length of the path as drawn, m.
    fn distance(&self) -> f64 {
        self.samples.windows(2).map(|pair| (pair[1].x - pair[0].x).hypot(pair[1].y - pair[0].y)).sum()
    }

    /// The greatest speed, m/s; zero if the vehicle never moved forward.
    fn top_speed(&self) -> f64 {
        self.samples.iter().map(|sample| sample.speed).fold(0.0, f64::max)
    }
}
