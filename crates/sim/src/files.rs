//! World files: worlds from elsewhere, and ours for elsewhere.
//!
//! Two kinds are read and written: SDF worlds (`.world`, `.sdf`: what Gazebo loads) and maps of ROS's map_server
//! (`.yaml` beside a PGM or PNG image). Coordinates are kept: a [`Room`](crate::Room) lies where the file puts it. What
//! a file holds and a plane world cannot is never passed over in silence: it is refused by its name, or, where
//! the spec says so, listed in [`WorldFile::unsupported`].
//!
//! Files are not trusted. Their size is limited before they are read, and every number, name and picture is checked:
//! the worst that a file can do is to be refused with a [`FileError`]. The parsers themselves ([`parse_sdf`],
//! [`parse_map`]) are functions of bytes that open nothing.
//!
//! ```
//! use headway_sim::files::{FileSpec, list, read};
//! # let folder = tempfile::tempdir()?;
//! # let dir = folder.path();
//! let sdf = "<sdf version='1.6'><world name='yard'><model name='tree'><pose>2 3 0 0 0 0</pose><link name='l'>
//!     <collision name='trunk'><geometry><cylinder><radius>0.4</radius><length>3</length></cylinder></geometry>
//!     </collision></link></model></world></sdf>";
//! std::fs::write(dir.join("yard.world"), sdf)?;
//! let paths = list(dir)?;
//! let yard = read(&paths[0], &FileSpec::default())?;
//! assert_eq!((yard.name.as_str(), yard.world.obstacles()[0].x), ("yard", 2.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod disk;
mod error;
mod folder;
mod map;
mod sdf;
mod start_goal;

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::{Obstacle, Point, Pose, Scenario, World};
use disk::Kind;

pub use error::{FileError, FileProblem};
pub use folder::list;
pub use map::{MapFiles, MapSpec, UnknownCells, parse_map, to_map};
pub use sdf::{SdfSpec, Unsupported, parse_sdf, to_sdf};

/// How world files are read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FileSpec {
    /// The largest file that is read, bytes.
    pub max_bytes: u64,
    /// SDF worlds.
    pub sdf: SdfSpec,
    /// Maps of map_server.
    pub map: MapSpec,
}

impl Default for FileSpec {
    /// Files of up to 64 MiB.
    fn default() -> Self {
        Self { max_bytes: 64 << 20, sdf: SdfSpec::default(), map: MapSpec::default() }
    }
}

/// What a world file holds.
#[derive(Debug, Clone)]
pub struct WorldFile {
    /// The file's name without its ending; from bytes alone, the name that the world has within.
    pub name: String,
    /// The room and what stands in it.
    pub world: World,
    /// Where a vehicle is to start, if the file says so: only ours do.
    pub start: Option<Pose>,
    /// Where it is to go, likewise.
    pub goal: Option<Point>,
    /// What the file holds and the world does not, each by its name: only where the spec allows it. Of a scenario, what
    /// moves in it.
    pub unsupported: Vec<String>,
}

impl WorldFile {
    /// A scenario, to be written: its world without movers, which a file cannot hold and which are listed as unsupported.
    #[must_use]
    pub fn of_scenario(name: impl Into<String>, scenario: &Scenario) -> Self {
        let Scenario { world, start, goal, .. } = scenario;
        let movers = world.movers().iter().enumerate();
        let unsupported = movers.map(|(k, Obstacle { x, y, .. })| format!("mover {k} at ({x}, {y})")).collect();
        let world = world.without_movers().into_owned();
        Self { name: name.into(), world, start: Some(*start), goal: Some(*goal), unsupported }
    }
}

/// Reads a world file of the kind that its ending tells: `.world` and `.sdf`, or `.yaml` and `.yml`.
///
/// # Errors
/// Names the file, the place in it, the value and what is allowed.
pub fn read(path: &Path, spec: &FileSpec) -> Result<WorldFile, FileError> {
    let kind = Kind::of(path)?;
    let bytes = disk::read(path, spec.max_bytes)?;
    let file = match kind {
        Kind::Sdf => parse_sdf(&bytes, &spec.sdf),
        Kind::Map => parse_map(&bytes, &spec.map, |image| disk::read(&disk::beside(path, image), spec.max_bytes)),
    };
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    file.map(|file| WorldFile { name, ..file }).map_err(|error| error.in_file(path))
}

/// Writes an SDF world: [`to_sdf`].
///
/// # Errors
/// If the file cannot be written.
pub fn write_sdf(path: &Path, file: &WorldFile) -> Result<(), FileError> {
    disk::write(path, to_sdf(file).as_bytes())
}

/// Writes a map with cells of `resolution` metres: its YAML to `path`, its image beside it as PGM. See [`to_map`].
///
/// # Errors
/// If the resolution is not allowed or a file cannot be written.
pub fn write_map(path: &Path, file: &WorldFile, resolution: f64) -> Result<(), FileError> {
    let image = path.with_extension("pgm");
    let image_name = image.file_name().unwrap_or_default().to_string_lossy();
    let MapFiles { yaml, pgm } = to_map(file, resolution, &image_name).map_err(|error| error.in_file(path))?;
    disk::write(&image, &pgm)?;
    disk::write(path, yaml.as_bytes())
}
