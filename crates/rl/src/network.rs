//! The Q-network: a multilayer perceptron on candle tensors.

use candle_core::{Device, Result, Tensor, Var};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::dense::{Activation, dense};
use crate::inplace::{MoveTowards, read};

/// The weights of one layer, as plain numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// `[n_out, n_in]`, row-major.
    pub weight: Vec<f32>,
    /// `[n_out]`.
    pub bias: Vec<f32>,
}

impl Layer {
    /// Zeros in the same shape.
    pub(crate) fn zeros_like(&self) -> Self {
        Self { weight: vec![0.0; self.weight.len()], bias: vec![0.0; self.bias.len()] }
    }
}

/// A multilayer perceptron: ReLU after every layer but the last.
#[derive(Debug)]
pub(crate) struct Mlp {
    /// Weight `[n_out, n_in]` and bias `[n_out]` of each layer.
    layers: Vec<(Tensor, Tensor)>,
}

/// The sizes of a network's layers, from `obs_dim` through the hidden ones to `n_actions`.
pub(crate) fn widths(obs_dim: usize, hidden: &[usize], n_actions: usize) -> Vec<usize> {
    [&[obs_dim], hidden, &[n_actions]].concat()
}

/// Draws initial weights: Kaiming (He) uniform by fan-in, biases zero.
///
/// He et al. (2015): `U(-a, a)` with `a = gain sqrt(3 / n_in)`; the gain is `sqrt(2)` before a ReLU and 1 at the output.
pub(crate) fn initialise(widths: &[usize], rng: &mut ChaCha8Rng) -> Vec<Layer> {
    let n_layers = widths.len() - 1;
    let layer = |(i, pair): (usize, &[usize])| {
        let gain_squared = if i + 1 < n_layers { 2.0 } else { 1.0 };
        let a = (3.0 * gain_squared / pair[0] as f32).sqrt();
        let weight = (0..pair[0] * pair[1]).map(|_| rng.random_range(-a..a)).collect();
        Layer { weight, bias: vec![0.0; pair[1]] }
    };
    widths.windows(2).enumerate().map(layer).collect()
}

impl Mlp {
    /// A network whose weights collect gradients.
    pub(crate) fn trainable(layers: &[Layer]) -> Result<Self> {
        Self::build(layers, |values, shape| Ok(Var::from_slice(values, shape, &Device::Cpu)?.into_inner()))
    }

    /// A network that no graph is built for.
    pub(crate) fn frozen(layers: &[Layer]) -> Result<Self> {
        Self::build(layers, |values, shape| Tensor::from_slice(values, shape, &Device::Cpu))
    }

    fn build(layers: &[Layer], tensor: impl Fn(&[f32], &[usize]) -> Result<Tensor>) -> Result<Self> {
        let layers = layers.iter().map(|layer| {
            let n_out = layer.bias.len();
            let weight = tensor(&layer.weight, &[n_out, layer.weight.len() / n_out])?;
            Ok((weight, tensor(&layer.bias, &[n_out])?))
        });
        Ok(Self { layers: layers.collect::<Result<_>>()? })
    }

    /// The same weights, in the same memory, without a graph.
    pub(crate) fn detached(&self) -> Self {
        Self { layers: self.layers.iter().map(|(w, b)| (w.detach(), b.detach())).collect() }
    }

    /// Q-values `[n, n_actions]` of observations `[n, obs_dim]`.
    pub(crate) fn forward(&self, obs: &Tensor) -> Result<Tensor> {
        let (last, hidden) = self.layers.split_last().expect("a network has an output layer");
        let mut x = obs.clone();
        for (w, b) in hidden {
            x = dense(&x, w, b, Activation::Relu)?;
        }
        dense(&x, &last.0, &last.1, Activation::Identity)
    }

    /// All tensors, in the order weight, bias, weight, bias, ...
    pub(crate) fn tensors(&self) -> impl Iterator<Item = &Tensor> {
        self.layers.iter().flat_map(|(w, b)| [w, b])
    }

    /// Moves every weight a fraction `rate` of the way to another network's; 1 copies.
    pub(crate) fn move_towards(&self, other: &Self, rate: f32) -> Result<()> {
        let op = MoveTowards { rate };
        self.tensors().zip(other.tensors()).try_for_each(|(mine, other)| mine.inplace_op2(other, &op))
    }

    /// Overwrites every weight.
    pub(crate) fn assign(&self, layers: &[Layer]) -> Result<()> {
        self.move_towards(&Self::frozen(layers)?, 1.0)
    }

    /// The weights as plain numbers.
    pub(crate) fn layers(&self) -> Result<Vec<Layer>> {
        let numbers = |tensor| read(tensor, <[f32]>::to_vec);
        self.layers.iter().map(|(w, b)| Ok(Layer { weight: numbers(w)?, bias: numbers(b)? })).collect()
    }
}

/// All weights in a row: weight, bias, weight, bias, ...
pub(crate) fn flatten(layers: &[Layer]) -> Vec<f32> {
    layers.iter().flat_map(|layer| [&layer.weight, &layer.bias]).flatten().copied().collect()
}

/// The inverse of [`flatten`] for layers of these sizes, or nothing if the number of weights is another.
pub(crate) fn unflatten(mut values: &[f32], widths: &[usize]) -> Option<Vec<Layer>> {
    let mut take = |n: usize| {
        let (head, tail) = values.split_at_checked(n)?;
        values = tail;
        Some(head.to_vec())
    };
    let mut layers = Vec::new();
    for pair in widths.windows(2) {
        layers.push(Layer { weight: take(pair[0] * pair[1])?, bias: take(pair[1])? });
    }
    values.is_empty().then_some(layers)
}

/// Rows of numbers as a tensor `[n, n_columns]`.
pub(crate) fn matrix(values: Vec<f32>, n_columns: usize) -> Result<Tensor> {
    let n = values.len() / n_columns;
    Tensor::from_vec(values, (n, n_columns), &Device::Cpu)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::stream;

    #[test]
    fn a_network_by_hand() {
        let layers = [
            Layer { weight: vec![1.0, 2.0, -1.0, 0.5], bias: vec![0.5, 0.0] },
            Layer { weight: vec![3.0, 7.0], bias: vec![-1.0] },
        ];
        // Hidden: 1 + 2*2 + 0.5 = 5.5 and relu(-1 + 0.5*2) = 0; output: 3*5.5 - 1 = 15.5.
        let q = Mlp::frozen(&layers).unwrap().forward(&matrix(vec![1.0, 2.0], 2).unwrap()).unwrap();
        assert_eq!(q.to_vec2::<f32>().unwrap(), [[15.5]]);
    }

    #[test]
    fn detached_weights_follow_and_build_no_graph() {
        let rng = &mut stream(1, "weights");
        let online = Mlp::trainable(&initialise(&[3, 4, 2], rng)).unwrap();
        let view = online.detached();
        let others = initialise(&[3, 4, 2], rng);
        online.assign(&others).unwrap();
        assert_eq!(view.layers().unwrap(), others);
        let obs = matrix(vec![1.0; 3], 3).unwrap();
        assert!(online.forward(&obs).unwrap().track_op());
        assert!(!view.forward(&obs).unwrap().track_op());
    }

    #[test]
    fn initial_weights_have_the_variance_of_he() {
        let layers = initialise(&[300, 200, 50], &mut stream(1, "weights"));
        for (layer, bound_squared) in layers.iter().zip([6.0 / 300.0, 3.0 / 200.0]) {
            let variance = layer.weight.iter().map(|w| w * w).sum::<f32>() / layer.weight.len() as f32;
            assert!((variance / (bound_squared / 3.0) - 1.0).abs() < 0.05);
            assert!(layer.weight.iter().all(|w| w * w <= bound_squared));
            assert!(layer.bias.iter().all(|&b| b == 0.0));
        }
    }
}
