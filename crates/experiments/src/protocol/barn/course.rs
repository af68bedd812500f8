//! The worlds that runs are made in.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use headway_env::{GoalHandling, Mdp, NavSpec};
use headway_sim::{FilesSpec, Footprint, WorldSpec, files};

use super::{GOAL, REACH_RADIUS, Reference, START, TIME_LIMIT};
use crate::Error;
use crate::jobs::{self, Display, Job};

/// A world file, and the path file that its runs are measured by.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct World {
    /// The file's name without its ending.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    /// The file of its reference path, if there is one.
    pub reference: Option<PathBuf>,
}

/// The world files of a folder, or of its folder `worlds`, each with its reference path; in the order of their names. No
/// file is read.
///
/// The path of `world_N` is `path_N.npy` in `folder/../paths` or `folder/paths`.
///
/// # Errors
/// If there is no such folder, or no world file in it.
pub fn worlds(folder: &Path) -> Result<Vec<World>, Error> {
    let input = |error: files::FileError| Error::Input(error.to_string());
    if !folder.is_dir() {
        return Err(Error::Input(format!("--worlds {}: there is no such folder", folder.display())));
    }
    let mut paths = files::list(folder).map_err(input)?;
    if paths.is_empty() && folder.join("worlds").is_dir() {
        paths = files::list(&folder.join("worlds")).map_err(input)?;
    }
    if paths.is_empty() {
        return Err(Error::Input(format!(
            "--worlds {}: neither it nor a folder `worlds` in it holds world files (*.world, *.sdf, *.yaml)",
            folder.display()
        )));
    }
    let world = |path: PathBuf| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let reference = Reference::file(&name, [folder, path.parent().unwrap_or(folder)]);
        World { name, path, reference }
    };
    Ok(paths.into_iter().map(world).collect())
}

impl World {
    /// The decision process of a run in this world under given conditions: their vehicle, lidar and route, and the protocol's
    /// start, goal and ends.
    #[must_use]
    pub fn rules(&self, conditions: &NavSpec) -> NavSpec {
        let files =
            FilesSpec { paths: vec![self.path.clone()], start: Some(START), goal: Some(GOAL), ..FilesSpec::default() };
        let mut rules = NavSpec { world: WorldSpec::Files(files), ..conditions.clone() };
        rules.env.goal = GoalHandling::Terminate;
        rules.env.reach_radius = REACH_RADIUS;
        // The protocol's clock is the one that counts; this one, which starts at once, comes after it.
        rules.env.time_limit = 2.0 * TIME_LIMIT + 1.0;
        rules
    }
}

/// A world, read, built and measured: ready to be driven in.
#[derive(Debug, Clone)]
pub struct Course {
    /// The world.
    pub world: World,
    /// The shortest way through it.
    pub reference: Reference,
    /// The decision process of its runs.
    pub mdp: Arc<Mdp>,
}

impl Course {
    /// The course of a world under given conditions.
    ///
    /// # Errors
    /// If a file cannot be read or holds no world or no path, the vehicle does not fit the start, or there is neither a path file
    /// nor a way that could be planned.
    pub fn new(world: World, conditions: &NavSpec) -> Result<Self, Error> {
        let built = world.rules(conditions).build();
        let mdp = built.map_err(|error| Error::Input(format!("{}: {error}", world.path.display())))?;
        let reference = match &world.reference {
            Some(path) => Reference::read(path)?,
            None => planned(&mdp).ok_or_else(|| no_way(&world, mdp.vehicle().footprint()))?,
        };
        Ok(Self { world, reference, mdp })
    }

    /// The courses of several worlds, in their order, made on as many threads.
    ///
    /// # Errors
    /// As [`Self::new`], for one of them.
    pub fn all(worlds: Vec<World>, conditions: &NavSpec, n_jobs: NonZeroUsize) -> Result<Vec<Self>, Error> {
        let worlds: Vec<_> = worlds.into_iter().map(|input| Job { input, work: 1 }).collect();
        jobs::run(&worlds, n_jobs, Display::Silent, |world, _| Self::new(world.clone(), conditions))
    }
}

/// The shortest way through the only world that a process has.
fn planned(mdp: &Mdp) -> Option<Reference> {
    let scenario = mdp.source().scenario(0, 0).ok()?;
    Reference::plan(&scenario.world, mdp.vehicle().footprint())
}

fn no_way(world: &World, footprint: &Footprint) -> Error {
    Error::Input(format!(
        "{}: no way from (-2, 3) to (-2, 13) for a disc of radius {:.3} m, and no path file to measure by",
        world.path.display(),
        footprint.inradius()
    ))
}
