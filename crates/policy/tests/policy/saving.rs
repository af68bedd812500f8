//! Saving: whole or not at all, and nothing besides.

use std::fs;

use headway_policy::{Header, Layer, Policy};

use crate::common::policy;

/// Another policy than the common one.
fn other() -> Policy {
    Policy::new(Header::default(), vec![Layer { weight: vec![0.5; 12 * 42], bias: vec![0.0; 12] }]).unwrap()
}

/// The temporary used to stay, on a full disk or wherever else the file could not be put into its place.
#[test]
fn nothing_is_left_where_saving_fails() {
    let folder = tempfile::tempdir().unwrap();
    let taken = folder.path().join("policy.safetensors");
    fs::create_dir(&taken).unwrap();
    fs::write(taken.join("inside"), "so that no file can take the folder's place").unwrap();
    let message = policy().save(&taken).unwrap_err().to_string();
    assert!(message.starts_with(&format!("{}: ", taken.display())), "{message}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(fs::read_dir(&taken).unwrap().count(), 1);
}

/// `a.x` and `a.y` used to share the temporary `a.partial`.
#[test]
fn files_that_differ_in_their_extension_do_not_meet() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("a.partial"), "another program's").unwrap();
    fs::write(path("a.x.0.partial"), "left by a crash").unwrap();
    std::thread::scope(|scope| {
        for (name, policy) in [("a.x", policy()), ("a.y", other())] {
            let path = path(name);
            scope.spawn(move || {
                for _ in 0..50 {
                    policy.save(&path).unwrap();
                    assert_eq!(Policy::load(&path).unwrap(), policy);
                }
            });
        }
    });
    assert_eq!(fs::read_to_string(path("a.partial")).unwrap(), "another program's");
    assert_eq!(fs::read_to_string(path("a.x.0.partial")).unwrap(), "left by a crash");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4);
}

#[test]
fn two_writers_of_one_file_leave_the_whole_of_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("policy.safetensors");
    std::thread::scope(|scope| {
        for policy in [policy(), other()] {
            let path = &path;
            scope.spawn(move || (0..50).for_each(|_| policy.save(path).unwrap()));
        }
    });
    let read = Policy::load(&path).unwrap();
    assert!(read == policy() || read == other());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// A path that ends in `.partial` used to be its own temporary, and was written in place.
#[test]
fn a_file_of_any_name_is_replaced_and_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let [path, old] = ["policy.partial", "old"].map(|name| folder.path().join(name));
    policy().save(&path).unwrap();
    fs::hard_link(&path, &old).unwrap();
    other().save(&path).unwrap();
    assert_eq!(Policy::load(&old).unwrap(), policy());
    assert_eq!(Policy::load(&path).unwrap(), other());
}
