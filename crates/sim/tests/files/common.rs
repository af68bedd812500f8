//! Documents to read.

use headway_sim::files::{FileError, MapSpec, SdfSpec, WorldFile, parse_map, parse_sdf};

/// An SDF document of a world.
pub(crate) fn document(world: &str) -> String {
    format!("<sdf version='1.6'><world name='w'>{world}</world></sdf>")
}

/// A model of one collision at a pose.
pub(crate) fn model(name: &str, pose: &str, geometry: &str) -> String {
    format!(
        "<model name='{name}'><pose>{pose}</pose><link name='link'><collision name='collision'><geometry>{geometry}</geometry>\
         </collision></link></model>"
    )
}

pub(crate) fn cylinder(radius: f64, length: f64) -> String {
    format!("<cylinder><radius>{radius}</radius><length>{length}</length></cylinder>")
}

pub(crate) fn read(world: &str) -> WorldFile {
    parse_sdf(document(world).as_bytes(), &SdfSpec::default()).unwrap()
}

/// A map of one picture, with lines of YAML besides.
pub(crate) fn read_map(yaml: &str, picture: &[u8], spec: &MapSpec) -> Result<WorldFile, FileError> {
    parse_map(yaml.as_bytes(), spec, |_| Ok(picture.to_vec()))
}

pub(crate) const YAML: &str =
    "image: a.pgm\nresolution: 0.5\norigin: [-1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
