//! The fifty public worlds of the Benchmark for Autonomous Robot Navigation (`world_3`, `world_9`, ... `world_297`), where they are at
//! hand: in the folder `worlds` of the one that HEADWAY_BARN names, or of `shared/barn` beside the repository.

use std::path::PathBuf;

use headway_sim::files::{FileSpec, list, read};
use headway_sim::{Obstacle, Shape};

/// The folder, if it is there.
fn folder() -> Option<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/barn");
    let folder = std::env::var_os("HEADWAY_BARN").map_or_else(|| beside.into(), PathBuf::from).join("worlds");
    folder.is_dir().then_some(folder)
}

/// The cylinders of a world by looking for tags from line to line, up to `<state>`.
fn cylinders_by_eye(text: &str) -> Vec<Obstacle> {
    let text = &text[..text.find("<state").unwrap()];
    let between = |text: &str, from: &str, to: &str| {
        let begin = text.find(from).unwrap() + from.len();
        text[begin..begin + text[begin..].find(to).unwrap()].to_owned()
    };
    let models = text.split("<model name='unit_cylinder").skip(1);
    let cylinder = |model: &str| {
        let pose = between(model, "<pose frame=''>", "</pose>");
        let mut pose = pose.split(' ').map(|number| number.parse::<f64>().unwrap());
        let (x, y) = (pose.next().unwrap(), pose.next().unwrap());
        assert!(pose.all(|number| number == 0.0));
        let radius = between(model, "<radius>", "</radius>").parse().unwrap();
        Obstacle { shape: Shape::Disc { radius }, x, y, yaw: 0.0 }
    };
    models.map(cylinder).collect()
}

#[test]
#[allow(clippy::print_stderr, reason = "a test that is skipped says so")]
fn all_worlds_load_as_they_are() {
    let Some(folder) = folder() else {
        eprintln!("skipped: barn::all_worlds_load_as_they_are (no BARN worlds here: set HEADWAY_BARN)");
        return;
    };
    let names: Vec<_> = (0..50).map(|k| format!("world_{}", 3 + 6 * k)).collect();
    let mut paths = list(&folder).unwrap();
    // There may be others beside them.
    paths.retain(|path| names.iter().any(|name| path.file_stem().is_some_and(|stem| stem == name.as_str())));
    assert_eq!(paths.len(), names.len());
    let mut n_cylinders = 0;
    for (path, name) in paths.iter().zip(&names) {
        let file = read(path, &FileSpec::default()).unwrap();
        let by_eye = cylinders_by_eye(&std::fs::read_to_string(path).unwrap());
        assert_eq!(&file.name, name);
        // The ground is none of them.
        assert_eq!(file.world.obstacles(), by_eye, "{}", path.display());
        n_cylinders += by_eye.len();
    }
    assert_eq!(n_cylinders, 13012);
}
