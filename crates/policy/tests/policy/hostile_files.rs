//! Files that are nearly policies: each is refused with what is wrong, and costs no memory to speak of.

use headway_policy::Policy;
use safetensors::tensor::Dtype;

use crate::common::{Parts, edited, policy};

fn refused(edit: impl FnOnce(&mut Parts)) -> String {
    Policy::from_bytes(&edited(edit)).unwrap_err().to_string()
}

/// Only the number of elements used to be compared: a transposed export was read as it lay.
#[test]
fn a_transposed_weight_is_refused() {
    for (name, found, expected) in [
        ("layers.0.weight", vec![42, 16], "[16, 42]"),
        ("layers.1.weight", vec![16, 12], "[12, 16]"),
        ("layers.0.weight", vec![16 * 42], "[16, 42]"),
        ("layers.1.bias", vec![1, 12], "[12]"),
    ] {
        assert_eq!(
            refused(|parts| parts.tensor(name).2.clone_from(&found)),
            format!("shape of tensor `{name}`: found {found:?}, must be {expected}")
        );
    }
}

/// An odd tensor used to be ignored, and so did two or more under other names.
#[test]
fn the_tensors_are_the_layers_and_no_others() {
    let more = |parts: &mut Parts, names: &[&str]| {
        for name in names {
            parts.tensors.push(((*name).to_owned(), Dtype::F32, vec![1], vec![0; 4]));
        }
    };
    let stranger = "not a policy file: tensor `optimiser` belongs to none of its 2 layers";
    assert_eq!(refused(|parts| more(parts, &["optimiser"])), stranger);
    assert_eq!(refused(|parts| more(parts, &["optimiser", "step"])), stranger);
    let gap = "not a policy file: tensor `layers.3.bias` belongs to none of its 2 layers";
    assert_eq!(refused(|parts| more(parts, &["layers.3.weight", "layers.3.bias"])), gap);
    assert_eq!(
        refused(|parts| more(parts, &["layers.2.bias"])),
        "not a policy file: tensor `layers.2.weight` not found"
    );
    assert_eq!(refused(|parts| parts.tensors.clear()), "layers: found 0, must be 1 or more");
    let type_of_integers = refused(|parts| parts.tensor("layers.0.bias").1 = Dtype::I32);
    assert_eq!(type_of_integers, "not a policy file: tensor `layers.0.bias` is of I32, must be F32");
}

#[test]
fn a_hidden_layer_of_zero_width_is_refused() {
    let no_units = |parts: &mut Parts| {
        for (name, shape) in
            [("layers.0.weight", vec![0, 42]), ("layers.0.bias", vec![0]), ("layers.1.weight", vec![12, 0])]
        {
            let tensor = parts.tensor(name);
            (tensor.2, tensor.3) = (shape, Vec::new());
        }
    };
    assert_eq!(refused(no_units), "outputs of layer 0: found 0, must be 1 or more");
}

/// The table of a controller that steers used to be taken unseen.
#[test]
fn the_control_is_checked() {
    let message = refused(|parts| {
        let header = &mut parts.metadata["header"];
        header["control"] = serde_json::json!({ "type": "speed_only", "pursuit": { "lookahead": -1.0 } });
        header["actions"]["yaw_rates"] = serde_json::json!([0.0]);
    });
    assert_eq!(message, "the policy's header: control.pursuit.lookahead = -1: must be a finite number above 0");
}

/// The observation's constants used to be in the program alone.
#[test]
fn another_normalisation_is_refused() {
    let table = Parts::of(&policy()).metadata["header"]["normalisation"].clone();
    assert_eq!(table, serde_json::json!({ "far": 3.0, "near": 2.0, "half_clearance": 0.25 }));
    for (field, own) in [("far", "3"), ("near", "2"), ("half_clearance", "0.25")] {
        let message = refused(|parts| parts.metadata["header"]["normalisation"][field] = 4.5.into());
        let expected = format!(
            "the policy's header: normalisation.{field} = 4.5: must be {own}, by which this program encodes observations"
        );
        assert_eq!(message, expected);
    }
    let absent = refused(|parts| {
        parts.metadata["header"].as_object_mut().unwrap().remove("normalisation");
    });
    assert!(absent.contains("missing field `normalisation`"), "{absent}");
}

#[test]
fn as_many_beams_as_no_lidar_has_are_refused_before_they_are_made() {
    for n_beams in [100_001, 1_000_000_000_000_000_000, u64::MAX] {
        let message = refused(|parts| parts.metadata["header"]["lidar"]["n_beams"] = n_beams.into());
        assert!(message.starts_with("the policy's header: lidar.n_beams = "), "{message}");
    }
}

#[test]
fn sizes_and_depths_that_a_file_only_claims_are_refused() {
    let file = |header: &str| [&(header.len() as u64).to_le_bytes(), header.as_bytes()].concat();
    let deep = "[".repeat(100_000);
    let nested = refused(|parts| parts.metadata["header"]["provenance"] = serde_json::json!({ "run": [[[[]]]] }));
    assert!(nested.starts_with("not a policy file: its metadata `headway.policy`: invalid type: "), "{nested}");
    let inner =
        serde_json::json!({ "__metadata__": { "headway.policy": format!("{{\"format\":2,\"header\":{deep}") } });
    let claim = |shape: &str, end: u64| {
        file(&format!(r#"{{"layers.0.bias":{{"dtype":"F32","shape":{shape},"data_offsets":[0,{end}]}}}}"#))
    };
    for bytes in [
        u64::MAX.to_le_bytes().to_vec(),
        1_000_000_000_u64.to_le_bytes().to_vec(),
        file(&deep),
        file(&inner.to_string()),
        claim("[4611686018427387904]", 16),
        claim("[4294967296, 4294967296]", 0),
        claim("[1073741824]", 4_294_967_296),
    ] {
        let message = Policy::from_bytes(&bytes).unwrap_err().to_string();
        assert!(message.starts_with("not a policy file: "), "{message}");
    }
}
