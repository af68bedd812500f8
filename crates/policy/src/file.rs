//! Policies as files: safetensors with one entry of metadata.

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use safetensors::tensor::{Dtype, SafeTensors, TensorView, serialize};
use serde::{Deserialize, Serialize};

use crate::{Header, Layer, Policy, PolicyError, atomic};

/// The name of the entry. A single one, for the order of several in a file is not defined, and the same
/// policy is to give the same bytes.
const KEY: &str = "headway.policy";
/// The version of the file format that is written and read.
const FORMAT: u32 = 2;

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
        let header = read_header(bytes)?;
        let tensors = SafeTensors::deserialize(bytes).map_err(format_error)?;
        let layers = read_layers(&tensors, header.obs_dim()?)?;
        Self::new(header, layers)
    }

    /// Writes the policy to a file, whole or not at all.
    ///
    /// # Errors
    /// Names the file.
    pub fn save(&self, path: &Path) -> Result<(), PolicyError> {
        let bytes = self.to_bytes()?;
        atomic::write(path, &bytes).map_err(|source| PolicyError::Io { path: path.display().to_string(), source })
    }

    /// Reads a policy from a file.
    ///
    /// # Errors
    /// Names the file and says what is not as it must be.
    pub fn load(path: &Path) -> Result<Self, PolicyError> {
        let place = || path.display().to_string();
        let bytes = std::fs::read(path).map_err(|source| PolicyError::Io { path: place(), source })?;
        Self::from_bytes(&bytes).map_err(|error| PolicyError::File { path: place(), source: Box::new(error) })
    }
}

fn read_header(bytes: &[u8]) -> Result<Header, PolicyError> {
    #[derive(Deserialize)]
    struct Version {
        format: u32,
    }
    let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(format_error)?;
    let json = metadata.metadata().as_ref().and_then(|entries| entries.get(KEY));
    let json = json.ok_or_else(|| PolicyError::Format(format!("its metadata have no entry `{KEY}`")))?;
    let bad_json = |e: serde_json::Error| PolicyError::Format(format!("its metadata `{KEY}`: {e}"));
    let Version { format } = serde_json::from_str(json).map_err(bad_json)?;
    if format != FORMAT {
        let message = format!("its format is version {format}, this program reads version {FORMAT}");
        return Err(PolicyError::Format(message));
    }
    let Metadata { header, .. } = serde_json::from_str(json).map_err(bad_json)?;
    Ok(header.into_owned())
}

/// All layers, every tensor of the shape that the inputs and the number of biases give it.
fn read_layers(tensors: &SafeTensors<'_>, n_inputs: usize) -> Result<Vec<Layer>, PolicyError> {
    let names: BTreeSet<&str> = tensors.names().into_iter().collect();
    let is_there = |index: &usize| ["weight", "bias"].iter().any(|part| names.contains(&*name(*index, part)));
    let n_layers = (0..).take_while(is_there).count();
    let (mut layers, mut n_inputs, mut expected) = (Vec::new(), n_inputs, BTreeSet::new());
    for index in 0..n_layers {
        let [weight_name, bias_name] = ["weight", "bias"].map(|part| name(index, part));
        let (weight, bias) = (f32_tensor(tensors, &weight_name)?, f32_tensor(tensors, &bias_name)?);
        let n_outputs = bias.data().len() / 4;
        check_shape(&weight_name, weight.shape(), &[n_outputs, n_inputs])?;
        check_shape(&bias_name, bias.shape(), &[n_outputs])?;
        layers.push(Layer { weight: from_le_bytes(weight.data()), bias: from_le_bytes(bias.data()) });
        n_inputs = n_outputs;
        expected.extend([weight_name, bias_name]);
    }
    match names.into_iter().find(|name| !expected.contains(*name)) {
        Some(name) => Err(PolicyError::Format(format!("tensor `{name}` belongs to none of its {n_layers} layers"))),
        None => Ok(layers),
    }
}

fn check_shape(name: &str, found: &[usize], expected: &[usize]) -> Result<(), PolicyError> {
    if found == expected {
        return Ok(());
    }
    let [found, expected] = [found, expected].map(|shape| format!("{shape:?}"));
    Err(PolicyError::Shape { what: format!("shape of tensor `{name}`"), found, expected })
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

fn f32_tensor<'a>(tensors: &SafeTensors<'a>, name: &str) -> Result<TensorView<'a>, PolicyError> {
    let tensor = tensors.tensor(name).map_err(format_error)?;
    match tensor.dtype() {
        Dtype::F32 => Ok(tensor),
        other => Err(PolicyError::Format(format!("tensor `{name}` is of {other:?}, must be F32"))),
    }
}

fn from_le_bytes(bytes: &[u8]) -> Vec<f32> {
    let words = bytes.chunks_exact(4);
    words.map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect()
}
