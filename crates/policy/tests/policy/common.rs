//! A policy, and its file taken apart to be put together wrongly.

use std::collections::HashMap;

use headway_policy::{Header, Layer, Policy};
use safetensors::tensor::{Dtype, SafeTensors, TensorView, serialize};
use serde_json::Value;

/// A policy of layers 42 -> 16 -> 12 with weights that follow a rule.
pub(crate) fn policy() -> Policy {
    let rule = |n: usize, step: usize| (0..n).map(|k| 0.02 * ((k * step % 101) as f32 - 50.0)).collect::<Vec<_>>();
    let hidden = Layer { weight: rule(16 * 42, 37), bias: rule(16, 11) };
    let last = Layer { weight: rule(12 * 16, 53), bias: rule(12, 7) };
    Policy::new(Header::default(), vec![hidden, last]).unwrap()
}

/// The parts of a policy file.
pub(crate) struct Parts {
    /// The metadata's only entry: `format` and `header`.
    pub(crate) metadata: Value,
    /// Name, type, shape and bytes.
    pub(crate) tensors: Vec<(String, Dtype, Vec<usize>, Vec<u8>)>,
}

impl Parts {
    pub(crate) fn of(policy: &Policy) -> Self {
        let bytes = policy.to_bytes().unwrap();
        let (_, metadata) = SafeTensors::read_metadata(&bytes).unwrap();
        let json = &metadata.metadata().as_ref().unwrap()["headway.policy"];
        let tensors = SafeTensors::deserialize(&bytes).unwrap();
        let tensors =
            tensors.iter().map(|(name, t)| (name.to_owned(), t.dtype(), t.shape().to_vec(), t.data().to_vec()));
        Self { metadata: serde_json::from_str(json).unwrap(), tensors: tensors.collect() }
    }

    pub(crate) fn tensor(&mut self, name: &str) -> &mut (String, Dtype, Vec<usize>, Vec<u8>) {
        self.tensors.iter_mut().find(|tensor| tensor.0 == name).unwrap()
    }

    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let views = self
            .tensors
            .iter()
            .map(|(name, dtype, shape, bytes)| (name.as_str(), TensorView::new(*dtype, shape.clone(), bytes).unwrap()));
        let metadata = HashMap::from([("headway.policy".to_owned(), self.metadata.to_string())]);
        serialize(views.collect::<Vec<_>>(), Some(metadata)).unwrap()
    }
}

/// The bytes of a policy file after an edit.
pub(crate) fn edited(edit: impl FnOnce(&mut Parts)) -> Vec<u8> {
    let mut parts = Parts::of(&policy());
    edit(&mut parts);
    parts.to_bytes()
}
