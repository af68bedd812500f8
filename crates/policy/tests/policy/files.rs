//! Policy files, read back and refused.

use headway_policy::{Header, Policy};

use crate::common::{edited, policy};

#[test]
fn a_file_gives_the_policy_back_and_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("policy.safetensors");
    policy().save(&path).unwrap();
    let read = Policy::load(&path).unwrap();
    assert_eq!(read, policy());
    assert_eq!(read.to_bytes().unwrap(), std::fs::read(&path).unwrap());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no partial file is left");
}

#[test]
fn bad_files_are_refused_with_a_reason() {
    let bytes = policy().to_bytes().unwrap();
    let refused = |bytes: &[u8]| Policy::from_bytes(bytes).unwrap_err().to_string();
    for end in [0, 4, 100, bytes.len() - 1] {
        assert!(refused(&bytes[..end]).starts_with("not a policy file: "), "{}", refused(&bytes[..end]));
    }
    let replaced = |from: &str, to: &str| {
        let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
        let mut other = bytes.clone();
        other[at..at + from.len()].copy_from_slice(to.as_bytes());
        other
    };
    assert_eq!(
        refused(&replaced("headway.policy", "another.policy")),
        "not a policy file: its metadata have no entry `headway.policy`"
    );
    assert_eq!(
        refused(&replaced(r#"\"format\":2"#, r#"\"format\":7"#)),
        "not a policy file: its format is version 7, this program reads version 2"
    );
    assert!(refused(&replaced("max_speed", "max_sqeed")).contains("unknown field `max_sqeed`"));
    assert!(refused(&replaced("layers.1.bias", "layers.7.bias")).contains("layers.1.bias"));
    let missing = Policy::load(std::path::Path::new("no/such.safetensors")).unwrap_err().to_string();
    assert!(missing.starts_with("no/such.safetensors: "), "{missing}");
    // Only some of the errors used to name the file.
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), replaced("max_speed", "max_sqeed")).unwrap();
    let message = Policy::load(file.path()).unwrap_err().to_string();
    let place = file.path().display();
    assert!(message.starts_with(&format!("{place}: not a policy file: ")), "{message}");
    std::fs::write(file.path(), edited(|parts| parts.metadata["header"]["lidar"]["n_beams"] = 24.into())).unwrap();
    let message = Policy::load(file.path()).unwrap_err().to_string();
    assert_eq!(message, format!("{place}: shape of tensor `layers.0.weight`: found [16, 42], must be [16, 30]"));
}

/// One in ten numbers of 17 digits used to be read as its neighbour; the policy then refused its own robot.
#[test]
fn a_robot_of_odd_numbers_knows_its_policy_again() {
    let mut header = Header::default();
    header.vehicle.max_acceleration = 0.18294879041143974;
    header.lidar.field_of_view = 0.49741861672637644;
    let policy = Policy::new(header, policy().layers().to_vec()).unwrap();
    let read = Policy::from_bytes(&policy.to_bytes().unwrap()).unwrap();
    assert_eq!(read, policy);
    read.check(&policy.header().vehicle, &policy.header().lidar).unwrap();
}
