//! Maps of ROS's map_server: a YAML file beside a picture.

mod cells;
mod header;
mod merge;
mod picture;
mod write;

use serde::{Deserialize, Serialize};

use super::{FileError, WorldFile};
use crate::check::within;
use crate::{FieldError, Obstacle, Pose, Room, Shape, World};
use header::Header;
use merge::{Block, blocks};

pub use write::{MapFiles, to_map};

/// The most boxes that a map may become.
const MOST_BOXES: usize = 100_000;

/// How a map becomes a world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MapSpec {
    /// What stands in cells of which the map knows nothing.
    pub unknown: UnknownCells,
    /// The most cells of a map, at most 400 million.
    pub max_cells: u64,
}

/// What stands in cells of which a map knows nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UnknownCells {
    /// Nothing, as ROS's planners take it: one drives there and looks.
    #[default]
    Free,
    /// Obstacles: one drives only where the map is known to be free.
    Occupied,
}

impl Default for MapSpec {
    /// Up to 64 million cells, 400 x 400 m in cells of 5 cm.
    fn default() -> Self {
        Self { unknown: UnknownCells::default(), max_cells: 64_000_000 }
    }
}

impl MapSpec {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the field.
    pub fn check(&self) -> Result<(), FieldError> {
        within("max_cells", self.max_cells as f64, 1.0, 4e8)
    }
}

/// The world that a map of map_server holds: its YAML, and its picture (PGM or PNG), which `load` fetches by the name
/// that the YAML has for it.
///
/// The YAML has `image`, `resolution` (metres), `origin` (x, y, yaw of the lower left corner), `occupied_thresh`,
/// `free_thresh`, and may have `negate` (0, 1, false, true) and `mode`; other keys are passed over, but for ours,
/// `headway`, with `start` and `goal`. With the lightness x of a cell from 0 to 1, the mean of its colours, p = 1 - x
/// (x if negated), and a cell is
///
/// - mode `trinary` (the default): occupied if p > `occupied_thresh`, free if p < `free_thresh`, else unknown;
/// - mode `scale`: the same; what is between the thresholds is no obstacle for sure, and counts as unknown;
/// - mode `raw`: its value of 0 to 255 is the occupancy in percent: occupied from 100 `occupied_thresh` up, free below,
///   unknown above 100.
///
/// A cell that is not fully opaque is unknown. Occupied cells are merged into few boxes, exactly. The map's edge is the
/// room. A map with a yaw becomes boxes of that yaw, and the room is the upright box around the map.
///
/// # Errors
/// Names the key or the picture, the value and what is allowed.
///
/// ```
/// use headway_sim::files::{MapSpec, parse_map};
/// let yaml = "{image: a.pgm, resolution: 0.5, origin: [-1, 0, 0], occupied_thresh: 0.65, free_thresh: 0.2}";
/// let pgm = b"P2 4 2 255  0 0 255 255  255 255 255 255"; // two black cells, upper left
/// let file = parse_map(yaml.as_bytes(), &MapSpec::default(), |_| Ok(pgm.to_vec()))?;
/// let wall = &file.world.obstacles()[0];
/// assert_eq!((file.world.obstacles().len(), wall.x, wall.y), (1, -0.5, 0.75));
/// # Ok::<(), headway_sim::files::FileError>(())
/// ```
pub fn parse_map(
    yaml: &[u8],
    spec: &MapSpec,
    load: impl FnOnce(&str) -> Result<Vec<u8>, FileError>,
) -> Result<WorldFile, FileError> {
    spec.check().map_err(|e| FileError::at("", e.under("map")))?;
    let header = Header::parse(yaml)?;
    let picture = picture::parse(&load(&header.image)?, &header, spec.max_cells)?;
    let cells = picture.cells(&header, spec.unknown);
    let blocks = blocks(&cells, MOST_BOXES).ok_or_else(|| {
        let allowed = format!("at most {MOST_BOXES}: are the thresholds right?");
        FileError::at("image", FieldError::new("boxes", format!("more than {MOST_BOXES}"), allowed))
    })?;
    let map = Placed { corner: header.corner(), yaw: header.yaw(), resolution: header.resolution };
    let obstacles = blocks.iter().map(|block| map.obstacle(block)).collect();
    let room = map.room(cells.n_columns, cells.n_rows);
    let world = World::new(room, obstacles).map_err(|e| FileError::at("map", e))?;
    let name = header.image.rsplit('/').next().unwrap_or_default();
    let name = name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned();
    let (start, goal) = (header.start()?, header.goal()?);
    Ok(WorldFile { name, world, start, goal, unsupported: Vec::new() })
}

/// Where a map lies.
struct Placed {
    corner: [f64; 2],
    yaw: f64,
    resolution: f64,
}

impl Placed {
    fn obstacle(&self, block: &Block) -> Obstacle {
        let Placed { corner, yaw, resolution } = *self;
        let (length, width) = (block.width() as f64 * resolution, block.height() as f64 * resolution);
        let middle = |low: usize, high: usize| (low + high) as f64 / 2.0 * resolution;
        let (x, y) = (middle(block.left, block.right), middle(block.bottom, block.top));
        let place =
            if yaw == 0.0 { [corner[0] + x, corner[1] + y].into() } else { self.pose() * crate::Point::new(x, y) };
        Obstacle { shape: Shape::Box { length, width }, x: place.x, y: place.y, yaw }
    }

    fn pose(&self) -> Pose {
        Pose::new(self.corner.into(), self.yaw)
    }

    /// The map, or the upright box around it.
    fn room(&self, n_columns: usize, n_rows: usize) -> Room {
        let (width, height) = (n_columns as f64 * self.resolution, n_rows as f64 * self.resolution);
        if self.yaw == 0.0 {
            return Room { x: self.corner[0], y: self.corner[1], width, height };
        }
        let corners =
            [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]].map(|c| self.pose() * crate::Point::from(c));
        let low = corners.iter().fold(corners[0].coords, |low, c| low.inf(&c.coords));
        let high = corners.iter().fold(corners[0].coords, |high, c| high.sup(&c.coords));
        Room { x: low.x, y: low.y, width: high.x - low.x, height: high.y - low.y }
    }
}
