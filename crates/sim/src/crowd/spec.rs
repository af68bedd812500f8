//! Crowds as data.

use serde::{Deserialize, Serialize};

use super::loops;
use crate::check::within;
use crate::{FieldError, Interval, Kinds};

/// Obstacles that move, as data: how many, which, how fast, and by what rule.
///
/// Each mover keeps the disc around it (its circumscribed circle) a millimetre or more from walls, obstacles and
/// other movers, whatever the rule; its yaw stays. Only the vehicle may be hit, by movers that do not regard it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CrowdSpec {
    /// How many, a whole number from 0 to 1000 or a range of them.
    pub n_movers: Interval,
    /// Of which kinds.
    pub kinds: Kinds,
    /// Radius of a mover's circumscribed circle, metres, from 0.001 to 100.
    pub radius: Interval,
    /// Highest speed of a mover, m/s, from 0 to 100.
    pub speed: Interval,
    /// Least gap, metres, at first: to obstacles, walls, each other, and to the vehicle at start and goal; 0.01 to 100.
    pub min_gap: f64,
    /// Whether movers regard the vehicle: reciprocal ones evade it, others stop or turn before it as before an obstacle.
    /// Movers that do not may hit even a vehicle that stands, which is a collision of the vehicle. If not given,
    /// reciprocal movers do and all others do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub avoids_vehicle: Option<bool>,
    /// The rule by which they move.
    pub motion: CrowdMotion,
}

impl Default for CrowdSpec {
    /// Six people walking through the room.
    fn default() -> Self {
        Self {
            n_movers: Interval::Fixed(6.0),
            kinds: Kinds::default(),
            radius: Interval::Range([0.2, 0.3]),
            speed: Interval::Range([0.4, 1.0]),
            min_gap: 0.3,
            avoids_vehicle: None,
            motion: CrowdMotion::default(),
        }
    }
}

/// The rule by which a crowd moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum CrowdMotion {
    /// At constant speed round given loops, or else through random points joined by free straight ways, in a ring if its
    /// last side is free, too, or to and fro. A mover that another one stops turns back.
    Waypoints {
        /// Random points, the first place included; from 2 to 1000, 4 if not given; not used where there are loops. Cramped
        /// movers find fewer, and one that finds none stands.
        #[serde(default = "few_points")]
        n_points: usize,
        /// Loops of points `[x, y]` in metres, up to 1000 of 2 to 1000 points each; the way from the last point leads back to
        /// the first. The first mover walks round the first loop, the second round the second, and so on in turn; it begins
        /// at the first point or, where that is taken, anywhere on its loop. A loop on which something stands in its movers'
        /// way is refused. If none is given, points are random.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        loops: Vec<Vec<[f64; 2]>>,
    },
    /// At constant speed in a direction that diffuses (a Wiener process), mirrored at whatever is in the way.
    RandomWalk {
        /// Standard deviation of the direction after a second, rad/sqrt(s), from 0 to 100.
        turning: f64,
    },
    /// To one random place after another, evading each other by optimal reciprocal collision avoidance (ORCA; van den Berg,
    /// Guy, Lin and Manocha 2011), each doing its half. Before the vehicle, if they regard it, they do the whole.
    Reciprocal {
        /// How far ahead they evade each other and the vehicle, seconds, from 0.01 to 100.
        horizon: f64,
        /// How far ahead they slow down before what stands still, seconds, from 0.01 to 100.
        obstacle_horizon: f64,
    },
}

impl Default for CrowdMotion {
    fn default() -> Self {
        Self::Waypoints { n_points: few_points(), loops: Vec::new() }
    }
}

/// The number of random waypoints where none is given.
fn few_points() -> usize {
    4
}

impl CrowdSpec {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the field, its value and what is allowed.
    ///
    /// ```
    /// use headway_sim::{CrowdMotion, CrowdSpec};
    /// let motion = CrowdMotion::RandomWalk { turning: -0.5 };
    /// let error = CrowdSpec { motion, ..CrowdSpec::default() }.check().unwrap_err();
    /// assert_eq!(error.to_string(), "motion.turning = -0.5: must be from 0 to 100");
    /// ```
    pub fn check(&self) -> Result<(), FieldError> {
        self.n_movers.check("n_movers", |field, n| {
            within(field, n, 0.0, 1000.0)?;
            if n.fract() == 0.0 { Ok(()) } else { Err(FieldError::new(field, n, "a whole number")) }
        })?;
        self.kinds.check()?;
        self.radius.check("radius", |field, x| within(field, x, 1e-3, 100.0))?;
        self.speed.check("speed", |field, x| within(field, x, 0.0, 100.0))?;
        within("min_gap", self.min_gap, 0.01, 100.0)?;
        self.motion.check().map_err(|e| e.under("motion"))
    }

    /// Whether movers regard the vehicle.
    pub(super) fn regards_vehicle(&self) -> bool {
        self.avoids_vehicle.unwrap_or(matches!(self.motion, CrowdMotion::Reciprocal { .. }))
    }
}

impl CrowdMotion {
    fn check(&self) -> Result<(), FieldError> {
        match self {
            Self::Waypoints { n_points, loops } => {
                within("n_points", *n_points as f64, 2.0, 1000.0)?;
                loops::check(loops)
            }
            Self::RandomWalk { turning } => within("turning", *turning, 0.0, 100.0),
            Self::Reciprocal { horizon, obstacle_horizon } => {
                within("horizon", *horizon, 0.01, 100.0)?;
                within("obstacle_horizon", *obstacle_horizon, 0.01, 100.0)
            }
        }
    }
}
