//! The Q-network: its sizes, its weights as plain numbers, and how they begin.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// The weights of one layer, as plain numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// `[n_out, n_in]`, row-major.
    pub weight: Vec<f32>,
    /// `[n_out]`.
    pub bias: Vec<f32>,
}

/// The sizes of a multilayer perceptron, with ReLU after every layer but the last, and where its numbers lie.
///
/// All weights lie in one flat row: layer by layer the matrix `[n_in, n_out]`, row-major, then the bias `[n_out]`. A
/// product of rows of observations with such a matrix reads both along their rows. The activations of `n` rows lie in
/// another: layer by layer `[n, n_out]`, the Q-values `[n, n_actions]` last.
#[derive(Debug, Clone)]
pub(crate) struct Network {
    pub(crate) widths: Vec<usize>,
    pub(crate) layers: Vec<LayerShape>,
}

/// The sizes of one layer and its place among the others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LayerShape {
    pub(crate) n_in: usize,
    pub(crate) n_out: usize,
    pub(crate) is_last: bool,
    /// The number of weights, and of units, in the layers before.
    n_weights_before: usize,
    n_units_before: usize,
}

impl LayerShape {
    /// This layer's matrix and bias among all weights.
    pub(crate) fn weights<'a>(&self, all: &'a [f32]) -> (&'a [f32], &'a [f32]) {
        all[self.n_weights_before..][..self.n_weights()].split_at(self.n_in * self.n_out)
    }

    /// This layer's matrix and bias among all weights, to write.
    pub(crate) fn weights_mut<'a>(&self, all: &'a mut [f32]) -> (&'a mut [f32], &'a mut [f32]) {
        all[self.n_weights_before..][..self.n_weights()].split_at_mut(self.n_in * self.n_out)
    }

    /// All activations of `n` rows, split where those of this layer begin.
    pub(crate) fn split<'a>(&self, activations: &'a [f32], n: usize) -> (&'a [f32], &'a [f32]) {
        let (before, rest) = activations.split_at(n * self.n_units_before);
        (before, &rest[..n * self.n_out])
    }

    /// All activations of `n` rows, split where those of this layer begin, to write.
    pub(crate) fn split_mut<'a>(&self, activations: &'a mut [f32], n: usize) -> (&'a mut [f32], &'a mut [f32]) {
        let (before, rest) = activations.split_at_mut(n * self.n_units_before);
        (before, &mut rest[..n * self.n_out])
    }

    fn n_weights(&self) -> usize {
        (self.n_in + 1) * self.n_out
    }
}

impl Network {
    /// A network from `obs_dim` numbers through the hidden layers to `n_actions` Q-values.
    pub(crate) fn new(obs_dim: usize, hidden: &[usize], n_actions: usize) -> Self {
        let widths = [&[obs_dim], hidden, &[n_actions]].concat();
        let (mut n_weights_before, mut n_units_before) = (0, 0);
        let shape = |(i, pair): (usize, &[usize])| {
            let is_last = i + 2 == widths.len();
            let layer = LayerShape { n_in: pair[0], n_out: pair[1], is_last, n_weights_before, n_units_before };
            n_weights_before += layer.n_weights();
            n_units_before += layer.n_out;
            layer
        };
        Self { layers: widths.windows(2).enumerate().map(shape).collect(), widths }
    }

    pub(crate) fn obs_dim(&self) -> usize {
        self.widths[0]
    }

    pub(crate) fn n_actions(&self) -> usize {
        self.last().n_out
    }

    /// The number of weights and biases.
    pub(crate) fn n_weights(&self) -> usize {
        self.last().n_weights_before + self.last().n_weights()
    }

    /// The number of activations per row.
    pub(crate) fn n_units(&self) -> usize {
        self.last().n_units_before + self.last().n_out
    }

    /// The Q-values among the activations of `n` rows.
    pub(crate) fn q<'a>(&self, activations: &'a [f32], n: usize) -> &'a [f32] {
        self.last().split(activations, n).1
    }

    /// The same, row by row: `[n_actions]` each.
    pub(crate) fn q_rows<'a>(&self, activations: &'a [f32], n: usize) -> impl Iterator<Item = &'a [f32]> + use<'a> {
        self.q(activations, n).chunks_exact(self.n_actions())
    }

    /// Draws initial weights: Kaiming (He) uniform by fan-in, biases zero.
    ///
    /// He et al. (2015): `U(-a, a)` with `a = gain sqrt(3 / n_in)`; the gain is `sqrt(2)` before a ReLU and 1 at the
    /// output.
    pub(crate) fn initialise(&self, rng: &mut ChaCha8Rng) -> Vec<Layer> {
        let layer = |shape: &LayerShape| {
            let gain_squared = if shape.is_last { 1.0 } else { 2.0 };
            let a = (3.0 * gain_squared / shape.n_in as f32).sqrt();
            let weight = (0..shape.n_in * shape.n_out).map(|_| rng.random_range(-a..a)).collect();
            Layer { weight, bias: vec![0.0; shape.n_out] }
        };
        self.layers.iter().map(layer).collect()
    }

    /// All weights of these layers in one flat row.
    pub(crate) fn flatten(&self, layers: &[Layer]) -> Vec<f32> {
        let mut all = vec![0.0; self.n_weights()];
        for (shape, layer) in self.layers.iter().zip(layers) {
            let (weight, bias) = shape.weights_mut(&mut all);
            transpose(&layer.weight, shape.n_in, weight);
            bias.copy_from_slice(&layer.bias);
        }
        all
    }

    /// The inverse of [`Self::flatten`].
    pub(crate) fn unflatten(&self, all: &[f32]) -> Vec<Layer> {
        let layer = |shape: &LayerShape| {
            let (values, bias) = shape.weights(all);
            let mut weight = vec![0.0; values.len()];
            transpose(values, shape.n_out, &mut weight);
            Layer { weight, bias: bias.to_vec() }
        };
        self.layers.iter().map(layer).collect()
    }

    fn last(&self) -> &LayerShape {
        self.layers.last().expect("a network has an output layer")
    }
}

/// Writes the transpose of rows of `n_columns` numbers.
fn transpose(from: &[f32], n_columns: usize, to: &mut [f32]) {
    let n_rows = from.len() / n_columns;
    for (i, row) in from.chunks_exact(n_columns).enumerate() {
        for (j, &value) in row.iter().enumerate() {
            to[j * n_rows + i] = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::stream;

    #[test]
    fn a_flat_row_by_hand() {
        let network = Network::new(2, &[3], 1);
        let layers = [
            Layer { weight: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0], bias: vec![7.0, 8.0, 9.0] },
            Layer { weight: vec![10.0, 11.0, 12.0], bias: vec![13.0] },
        ];
        let all = network.flatten(&layers);
        assert_eq!(all, [1.0, 3.0, 5.0, 2.0, 4.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0]);
        assert_eq!(network.unflatten(&all), layers);
        assert_eq!((network.n_weights(), network.n_units()), (13, 4));
        assert_eq!(network.q(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0], 2), [6.0, 7.0]);
    }

    #[test]
    fn initial_weights_have_the_variance_of_he() {
        let layers = Network::new(300, &[200], 50).initialise(&mut stream(1, "weights"));
        for (layer, bound_squared) in layers.iter().zip([6.0 / 300.0, 3.0 / 200.0]) {
            let variance = layer.weight.iter().map(|w| w * w).sum::<f32>() / layer.weight.len() as f32;
            assert!((variance / (bound_squared / 3.0) - 1.0).abs() < 0.05);
            assert!(layer.weight.iter().all(|w| w * w <= bound_squared));
            assert!(layer.bias.iter().all(|&b| b == 0.0));
        }
    }
}
