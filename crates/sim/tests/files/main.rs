//! World files.

mod bad_maps;
mod bad_sdf;
mod barn;
mod common;
mod disk;
mod map;
mod round_trip;
mod sdf;
mod specs;
