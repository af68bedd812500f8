//! Policies as files: safetensors with one entry of metadata.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

use safetensors::tensor::{Dtype, SafeTensors, TensorView, serialize};
use serde::{Deserialize, Serialize};

use crate::{Header, Layer, Policy, PolicyError};

/// The name of the entry. A single one, for the order of several in a file is not defined, and the same
/// policy is to give the same bytes.
const KEY: &str = "headway.policy";
/// The version of the file format that is written and read.
const FORMAT: u32 = 1;

#[derive(Serialize, Deserialize)]
struct Metadata<'a> {
    format: u32,
    header: Cow<'a, Header>,
}

impl Policy {
    /// The policy as the bytes of a file; equal policies give equal bytes.
    ///
    /// # Errors
    /// [`PolicyError::Format`] if the header cannot be written as JSON.
    pub fn to_bytes(&self) -> Result<Vec<u8>, PolicyError> {
        let metadata = Metadata { format: FORMAT, header: Cow::Borrowed(self.header()) };
        let json = serde_json::to_string(&metadata).map_err(|e| PolicyError::Format(e.to_string()))?;
        let mut tensors = Vec::new();
        for (index, Layer { weight, bias }) in self.layers().iter().enumerate() {
            let n_inputs = weight.len() / bias.len();
            tensors.push((name(index, "weight"), vec![bias.len(), n_inputs], to_le_bytes(weight)));
            tensors.push((name(index, "bias"), vec![bias.len()], to_le_bytes(bias)));
        }
        let views = tensors.iter().map(|(name, shape, bytes)| {
            let view = TensorView::new(Dtype::F32, shape.clone(), bytes)?;
            Ok((name.as_str(), view))
        });
        let views: Vec<_> = views.collect::<Result<_, _>>().map_err(format_error)?;
        serialize(views, Some(HashMap::from([(KEY.to_owned(), json)]))).map_err(format_error)
    }

    /// A policy from the bytes of a file.
    ///
    /// # Errors
    /// Says what is not as it must be.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PolicyError> {
        let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(format_error)?;
        let json = metadata.metadata().as_ref().and_then(|entries| entries.get(KEY));
        let json = json.ok_or_else(|| PolicyError::Format(format!("its metadata have no entry `{KEY}`")))?;
        #[derive(Deserialize)]
        struct Version {
            format: u32,
        }
        let bad_json = |e: serde_json::Error| PolicyError::Format(format!("its metadata `{KEY}`: {e}"));
        let Version { format } = serde_json::from_str(json).map_err(bad_json)?;
        if format != FORMAT {
            let message = format!("its format is version {format}, this program reads version {FORMAT}");
            return Err(PolicyError::Format(message));
        }
        let Metadata { header, .. } = serde_json::from_str(json).map_err(bad_json)?;
        let tensors = SafeTensors::deserialize(bytes).map_err(format_error)?;
        let n_layers = tensors.len() / 2;
        let read = |index| {
            let [weight, bias] = ["weight", "bias"].map(|part| read_f32(&tensors, &name(index, part)));
            Ok(Layer { weight: weight?, bias: bias? })
        };
        Self::new(header.into_owned(), (0..n_layers).map(read).collect::<Result<_, PolicyError>>()?)
    }

    /// Writes the policy to a file, whole or not at all.
    ///
    /// # Errors
    /// Names the file.
    pub fn save(&self, path: &Path) -> Result<(), PolicyError> {
        let bytes = self.to_bytes()?;
        let partial = path.with_extension("partial");
        let io = |source| PolicyError::Io { path: path.display().to_string(), source };
        std::fs::write(&partial, bytes).map_err(io)?;
        std::fs::rename(&partial, path).map_err(io)
    }

    /// Reads a policy from a file.
    ///
    /// # Errors
    /// Names the file and says what is not as it must be.
    pub fn load(path: &Path) -> Result<Self, PolicyError> {
        let io = |source| PolicyError::Io { path: path.display().to_string(), source };
        Self::from_bytes(&std::fs::read(path).map_err(io)?).map_err(|error| match error {
            PolicyError::Format(message) => PolicyError::Format(format!("{}: {message}", path.display())),
            other => other,
        })
    }
}

fn name(layer: usize, part: &str) -> String {
    format!("layers.{layer}.{part}")
}

fn format_error(error: safetensors::SafeTensorError) -> PolicyError {
    PolicyError::Format(error.to_string())
}

fn to_le_bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn read_f32(tensors: &SafeTensors<'_>, name: &str) -> Result<Vec<f32>, PolicyError> {
    let tensor = tensors.tensor(name).map_err(format_error)?;
    if tensor.dtype() != Dtype::F32 {
        return Err(PolicyError::Format(format!("tensor {name} is of {:?}, must be F32", tensor.dtype())));
    }
    let words = tensor.data().chunks_exact(4);
    Ok(words.map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect())
}
