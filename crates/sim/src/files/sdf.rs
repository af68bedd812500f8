//! SDF worlds: what Gazebo loads.

mod body;
mod frame;
mod polygon;
mod reader;
mod scope;
mod slice;
mod solid_parts;
mod write;
mod xml;

use serde::{Deserialize, Serialize};

use super::{FileError, WorldFile};
use crate::FieldError;
use crate::check::within;

pub use write::to_sdf;

/// How an SDF world becomes a plane one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SdfSpec {
    /// Where the world is cut, metres above z = 0, from -1000 to 1000: obstacles are the cross-sections there.
    pub slice_height: f64,
    /// From the box around all obstacles to the room's walls, metres, from 0 to 100 000; not used where the file has a
    /// room.
    pub margin: f64,
    /// What to do with geometry that cannot be represented.
    pub unsupported: Unsupported,
}

/// What to do with what cannot be represented.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unsupported {
    /// The file is refused, with a list.
    #[default]
    Refuse,
    /// It is left out and listed in [`WorldFile::unsupported`].
    Ignore,
}

impl Default for SdfSpec {
    /// A cut 0.2 m above the ground, as a small robot's lidar sees it, and walls 10 m away, as good as none.
    fn default() -> Self {
        Self { slice_height: 0.2, margin: 10.0, unsupported: Unsupported::default() }
    }
}

impl SdfSpec {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the field.
    pub fn check(&self) -> Result<(), FieldError> {
        within("slice_height", self.slice_height, -1000.0, 1000.0)?;
        within("margin", self.margin, 0.0, 1e5)
    }
}

/// The world that an SDF document (versions 1.4 to 1.12) holds, cut at a height.
///
/// The document holds one `<world>`, or models without a world. Read are the collisions of all links of all models,
/// nested ones too, movable ones where they stand, with their poses in three dimensions (`relative_to` a model,
/// link, joint or frame of the same scope, or of a model in it, as in `a::b`; `placement_frame`; `degrees`; quaternions).
/// A joint lies by default in its child link.
///
/// | geometry | becomes |
/// |---|---|
/// | sphere, upright cylinder, upright capsule | a disc |
/// | box | a box if it is upright, else the polygon of its cross-section |
/// | tilted cylinder or capsule, cone | a polygon around its cross-section; 64 facets, at most 0.13 % outside |
/// | polyline | convex polygons that cover its area; its cross-section if it is tilted |
/// | plane at 45 degrees or more | a wall: the cross-section of a sheet of the plane's size, 1 cm thick |
/// | plane flatter than that | nothing: the ground |
///
/// What the cut does not meet, or meets in less than a micrometre, is left out; visuals, lights, `<state>` (which
/// repeats all models) and the like are no obstacles. Includes, actors, populations, meshes, height maps and all other
/// geometry are [`SdfSpec::unsupported`]. Refused, whatever the spec says, are frames that are not followed, lest things
/// stand elsewhere than meant: names that are not of the scope or of a model in it, and `<pose frame>` of SDF 1.4 to 1.6;
/// and a second shape of a geometry or a second `<pose>`.
///
/// The room is the box around all obstacles (and around start and goal), grown by the margin; in an empty world, the
/// margin around the origin. A world that [`to_sdf`] wrote says its room, start and goal itself.
///
/// # Errors
/// Names the line, the model, link and collision, the value and what is allowed.
///
/// ```
/// use headway_sim::files::{SdfSpec, parse_sdf};
/// let collision = "<collision name='c'><geometry><sphere><radius>0.5</radius></sphere></geometry></collision>";
/// let model = format!("<model name='ball'><pose>1 2 0.2 0 0 0</pose><link name='l'>{collision}</link></model>");
/// let sdf = format!("<sdf version='1.9'><world name='w'>{model}</world></sdf>");
/// let file = parse_sdf(sdf.as_bytes(), &SdfSpec::default())?;
/// assert_eq!((file.world.obstacles()[0].x, file.world.room().x), (1.0, -9.5));
/// # Ok::<(), headway_sim::files::FileError>(())
/// ```
pub fn parse_sdf(bytes: &[u8], spec: &SdfSpec) -> Result<WorldFile, FileError> {
    spec.check().map_err(|e| FileError::at("", e.under("sdf")))?;
    let text = std::str::from_utf8(bytes).map_err(|e| FileError::malformed("", "UTF-8", e))?;
    reader::read(&xml::parse(text)?, spec)
}
