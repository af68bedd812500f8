//! Files and folders.

use std::fs;

use headway_sim::files::{FileSpec, list, read, write_sdf};

use crate::common::{YAML, cylinder, document, model};

#[test]
fn a_folder_is_listed_in_natural_order() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["world_15.world", "world_3.world", "notes.txt", "b.SDF", "a.yaml", "a.pgm"];
    for name in names {
        fs::write(folder.path().join(name), "").unwrap();
    }
    fs::create_dir(folder.path().join("folder.world")).unwrap();
    let listed = list(folder.path()).unwrap();
    let listed: Vec<_> = listed.iter().map(|path| path.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(listed, ["a.yaml", "b.SDF", "world_3.world", "world_15.world"]);
}

#[test]
fn pictures_lie_beside_their_yaml() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("maps")).unwrap();
    let path = folder.path().join("maps/hall.yaml");
    fs::write(&path, YAML).unwrap();
    fs::write(folder.path().join("maps/a.pgm"), "P2 2 1 255 0 254").unwrap();
    let file = read(&path, &FileSpec::default()).unwrap();
    assert_eq!((file.name.as_str(), file.world.obstacles().len()), ("hall", 1));
}

#[test]
fn refusals_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("a.yaml"), YAML).unwrap();
    fs::write(at("a.txt"), "").unwrap();
    fs::create_dir(at("b.world")).unwrap();
    fs::write(at("bad.world"), document(&model("tree", "0 0 0 0 0 0", &cylinder(-1.0, 1.0)))).unwrap();
    let big = FileSpec { max_bytes: 100, ..FileSpec::default() };
    let error = |name: &str, spec: &FileSpec| read(&at(name), spec).unwrap_err().to_string();
    let normal = FileSpec::default();
    for (got, file, what) in [
        (error("a.yaml", &normal), "a.pgm: ", "cannot be read: No such file"),
        (error("none.sdf", &normal), "none.sdf: ", "cannot be read: No such file"),
        (error("a.txt", &normal), "a.txt: ", "its ending must be .world or .sdf (SDF), .yaml or .yml (map_server)"),
        (error("b.world", &normal), "b.world: ", "cannot be read: not a file"),
        (error("bad.world", &big), "bad.world: ", "bytes: must be at most 100 bytes (max_bytes)"),
        (error("bad.world", &normal), "bad.world: line 1, model 'tree'", "radius = -1: must be from"),
        (list(&at("nowhere")).unwrap_err().to_string(), "nowhere: ", "cannot be read: No such file"),
    ] {
        assert!(got.contains(file) && got.contains(what), "{got}");
    }
    let file = read(&at("bad.world"), &normal).map(|_| ());
    assert!(file.is_err());
    fs::write(at("good.world"), document("")).unwrap();
    let good = read(&at("good.world"), &normal).unwrap();
    let error = write_sdf(&at("no/such/folder.sdf"), &good).unwrap_err().to_string();
    assert!(error.contains("folder.sdf: cannot be written: No such file"), "{error}");
}

#[test]
fn specs_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.world");
    fs::write(&path, document("")).unwrap();
    let mut spec = FileSpec::default();
    spec.sdf.slice_height = f64::NAN;
    assert!(
        read(&path, &spec).unwrap_err().to_string().ends_with("sdf.slice_height = NaN: must be from -1000 to 1000")
    );
    spec.sdf.slice_height = 0.2;
    spec.sdf.margin = -1.0;
    assert!(read(&path, &spec).unwrap_err().to_string().ends_with("sdf.margin = -1: must be from 0 to 100000"));
    assert!(toml::from_str::<FileSpec>("max_bytes = 10\n[sdf]\nmargin = 2.0\nunsupported = 'ignore'\n").is_ok());
    assert!(toml::from_str::<FileSpec>("[sdf]\nmargins = 2.0\n").is_err());
}
