//! The network: a multi-layer perceptron with rectified hidden units.

use headway_sensors::LidarSpec;
use headway_sim::VehicleSpec;

use crate::{Header, PolicyError};

/// A linear layer, `y = W x + b`.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// `W`, row-major, shape `[n_outputs, n_inputs]`.
    pub weight: Vec<f32>,
    /// `b`, shape `[n_outputs]`.
    pub bias: Vec<f32>,
}

/// A trained policy: action values by a network, and what its inputs and outputs mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    header: Header,
    layers: Vec<Layer>,
    /// The weights again, `[n_inputs, n_outputs]`: a product then adds whole rows, which vectorises.
    columns: Vec<Vec<f32>>,
}

impl Policy {
    /// A policy from its parts, checked to fit each other.
    ///
    /// # Errors
    /// If the header is not allowed, there is no layer, the layers do not fit the header or each other, or a
    /// weight is not finite.
    pub fn new(header: Header, layers: Vec<Layer>) -> Result<Self, PolicyError> {
        let (encoder, actions) = header.build()?;
        if layers.is_empty() {
            return Err(none("layers".to_owned()));
        }
        let mut n_inputs = encoder.obs_dim();
        let mut columns = Vec::with_capacity(layers.len());
        for (index, Layer { weight, bias }) in layers.iter().enumerate() {
            if bias.is_empty() {
                return Err(none(format!("outputs of layer {index}")));
            }
            check(format!("weights of layer {index}"), weight.len(), n_inputs * bias.len())?;
            if !weight.iter().chain(bias).all(|x| x.is_finite()) {
                return Err(PolicyError::NotFinite { layer: index });
            }
            columns.push((0..weight.len()).map(|k| weight[k % bias.len() * n_inputs + k / bias.len()]).collect());
            n_inputs = bias.len();
        }
        check("outputs of the last layer".to_owned(), n_inputs, actions.len())?;
        Ok(Self { header, layers, columns })
    }

    /// What its inputs and outputs mean.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The weights.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Refuses another robot than the one it was trained on. What a simulation alone knows (substeps, noise
    /// and dropout) may differ.
    ///
    /// # Errors
    /// Lists every number that differs.
    pub fn check(&self, vehicle: &VehicleSpec, lidar: &LidarSpec) -> Result<(), PolicyError> {
        let differences = self.header.differences(vehicle, lidar);
        if differences.is_empty() { Ok(()) } else { Err(PolicyError::Mismatch { differences }) }
    }

    /// The value of every action, shape `[n_actions]`, for one observation, shape `[obs_dim]`. `buffers` are
    /// overwritten and keep their memory from call to call; the result lies in one of them.
    ///
    /// # Panics
    /// If the observation has another length.
    pub fn values<'a>(&self, obs: &[f32], buffers: &'a mut [Vec<f32>; 2]) -> &'a [f32] {
        let [input, output] = buffers;
        input.clear();
        input.extend_from_slice(obs);
        for (index, (layer, columns)) in self.layers.iter().zip(&self.columns).enumerate() {
            assert_eq!(input.len() * layer.bias.len(), columns.len(), "the observation's length");
            output.clear();
            output.extend_from_slice(&layer.bias);
            for (x, column) in input.iter().zip(columns.chunks_exact(layer.bias.len())) {
                output.iter_mut().zip(column).for_each(|(y, w)| *y += w * x);
            }
            if index + 1 < self.layers.len() {
                output.iter_mut().for_each(|y| *y = y.max(0.0));
            }
            std::mem::swap(input, output);
        }
        input
    }
}

/// The number of the greatest value; the first of several.
#[must_use]
pub(crate) fn argmax(values: &[f32]) -> u32 {
    let mut best = 0;
    for (index, value) in values.iter().enumerate() {
        if *value > values[best] {
            best = index;
        }
    }
    best as u32
}

fn check(what: String, found: usize, expected: usize) -> Result<(), PolicyError> {
    if found == expected {
        return Ok(());
    }
    Err(PolicyError::Shape { what, found: found.to_string(), expected: expected.to_string() })
}

fn none(what: String) -> PolicyError {
    PolicyError::Shape { what, found: "0".to_owned(), expected: "1 or more".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two layers with weights that follow a rule, 42 inputs.
    fn policy() -> Policy {
        let rule = |n: usize, scale: f32| (0..n).map(|k| scale * ((k * 37 % 101) as f32 - 50.0)).collect::<Vec<_>>();
        let hidden = Layer { weight: rule(5 * 42, 0.01), bias: rule(5, 0.02) };
        let last = Layer { weight: rule(12 * 5, 0.03), bias: rule(12, 0.04) };
        Policy::new(Header::default(), vec![hidden, last]).unwrap()
    }

    #[test]
    fn values_agree_with_the_definition() {
        let policy = policy();
        let obs: Vec<f32> = (0..42).map(|k| (k as f32 * 0.7).sin()).collect();
        let mut x: Vec<f64> = obs.iter().copied().map(f64::from).collect();
        for (index, layer) in policy.layers().iter().enumerate() {
            let row = |j: usize| &layer.weight[j * x.len()..(j + 1) * x.len()];
            let dot = |j: usize| row(j).iter().zip(&x).map(|(w, x)| f64::from(*w) * x).sum::<f64>();
            let y: Vec<f64> = (0..layer.bias.len()).map(|j| dot(j) + f64::from(layer.bias[j])).collect();
            x = if index == 0 { y.into_iter().map(|y| y.max(0.0)).collect() } else { y };
        }
        let mut buffers = Default::default();
        let values = policy.values(&obs, &mut buffers);
        assert_eq!(values.len(), 12);
        for (value, expected) in values.iter().zip(&x) {
            assert!((f64::from(*value) - expected).abs() < 1e-4);
        }
    }

    #[test]
    fn parts_must_fit() {
        let layer = |n_inputs: usize, n_outputs: usize| Layer {
            weight: vec![0.0; n_inputs * n_outputs],
            bias: vec![0.0; n_outputs],
        };
        let refused = |layers| Policy::new(Header::default(), layers).unwrap_err().to_string();
        assert_eq!(refused(vec![layer(41, 12)]), "weights of layer 0: found 492, must be 504");
        assert_eq!(refused(vec![layer(42, 11)]), "outputs of the last layer: found 11, must be 12");
        assert_eq!(
            refused(vec![layer(42, 0), layer(0, 12)]),
            "outputs of layer 0: found 0, must be 1 or more",
            "a hidden layer of zero width"
        );
        let mut broken = layer(42, 12);
        broken.weight[7] = f32::NAN;
        assert_eq!(refused(vec![broken]), "layer 0 holds a weight that is not a finite number");
        let mut header = Header::default();
        header.lidar.n_beams = 0;
        let message = Policy::new(header, vec![layer(42, 12)]).unwrap_err().to_string();
        assert!(message.starts_with("the policy's header: lidar.n_beams = 0: must be "), "{message}");
    }

    /// With as many inputs as actions, no layer at all used to pass as the identity.
    #[test]
    fn a_network_has_a_layer() {
        let mut header = Header::default();
        header.lidar.n_beams = 6;
        let message = Policy::new(header, vec![]).unwrap_err().to_string();
        assert_eq!(message, "layers: found 0, must be 1 or more");
    }

    #[test]
    fn the_first_of_equal_values_wins() {
        assert_eq!(argmax(&[1.0, 3.0, 3.0]), 1);
        assert_eq!(argmax(&[0.0]), 0);
    }
}
