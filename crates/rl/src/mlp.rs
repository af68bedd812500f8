//! The network's passes as operations on candle tensors: each fuses a whole pass, in place, without a graph.
//!
//! Weights, activations and derivatives are flat tensors laid out as [`Network`] says; observations are borrowed rows.
//! Candle's own operations give the same numbers with a pass over memory, an allocation and a node of the graph for
//! each product, sum and ReLU, and compute a gradient for the observations, which nobody wants.

use candle_core::{CpuStorage, InplaceOp2, InplaceOp3, Layout, Result, bail};

use crate::kernel::{Loop, Matrix, matmul, vectorised};
use crate::network::{LayerShape, Network};
use crate::tensors::{values, values_mut};

/// Sets activations `[n, n_units]` to those of observations `[n, obs_dim]`, by weights `[n_weights]`.
///
/// Layer by layer `y = max(x w + b, 0)`, and `y = x w + b` for the last, with `x` `[n, n_in]`, `w` `[n_in, n_out]`.
pub(crate) struct Forward<'a> {
    pub(crate) network: &'a Network,
    pub(crate) obs: &'a [f32],
}

/// Sets derivatives `[n, n_units]` from those with respect to the Q-values, by activations and weights.
///
/// From the last layer to the first, with `d_y` the derivative before this layer's ReLU and `x` the activations before
/// the layer: `d_x = d_y w^T` where `x > 0`, else 0.
pub(crate) struct BackPropagate<'a> {
    pub(crate) network: &'a Network,
    /// `[n, n_actions]`.
    pub(crate) d_q: &'a [f32],
}

/// Sets the gradient `[n_weights]` from activations and derivatives: `d_w = x^T d_y`, `d_b = sum over rows of d_y`.
pub(crate) struct Gradient<'a> {
    pub(crate) network: &'a Network,
    pub(crate) obs: &'a [f32],
}

impl InplaceOp2 for Forward<'_> {
    fn name(&self) -> &'static str {
        "forward"
    }

    fn cpu_fwd(&self, y: &mut CpuStorage, y_l: &Layout, w: &CpuStorage, w_l: &Layout) -> Result<()> {
        let (activations, weights) = (values_mut(y, y_l)?, values(w, w_l)?);
        let n = self.obs.len() / self.network.obs_dim();
        check_sizes(self.network, n, activations, weights)?;
        for layer in &self.network.layers {
            let (before, y) = layer.split_mut(activations, n);
            let (w, b) = layer.weights(weights);
            let x = inputs(layer, self.obs, before, n);
            matmul(Matrix::new(x, layer.n_in), Matrix::new(w, layer.n_out), y);
            vectorised(AddBias { y, b, is_last: layer.is_last });
        }
        Ok(())
    }
}

impl InplaceOp3 for BackPropagate<'_> {
    fn name(&self) -> &'static str {
        "back-propagate"
    }

    fn cpu_fwd(
        &self,
        d: &mut CpuStorage,
        d_l: &Layout,
        y: &CpuStorage,
        y_l: &Layout,
        w: &CpuStorage,
        w_l: &Layout,
    ) -> Result<()> {
        let (derivatives, activations, weights) = (values_mut(d, d_l)?, values(y, y_l)?, values(w, w_l)?);
        let n = self.d_q.len() / self.network.n_actions();
        check_sizes(self.network, n, activations, weights)?;
        check_sizes(self.network, n, derivatives, weights)?;
        let [.., last] = &self.network.layers[..] else { return Ok(()) };
        last.split_mut(derivatives, n).1.copy_from_slice(self.d_q);
        for pair in self.network.layers.windows(2).rev() {
            let (before, layer) = (&pair[0], &pair[1]);
            let (earlier, d_y) = layer.split_mut(derivatives, n);
            let d_x = before.split_mut(earlier, n).1;
            let w = Matrix::new(layer.weights(weights).0, layer.n_out);
            matmul(Matrix::new(d_y, layer.n_out), w.t(), d_x);
            vectorised(ZeroWhereClosed { d: d_x, x: before.split(activations, n).1 });
        }
        Ok(())
    }
}

impl InplaceOp3 for Gradient<'_> {
    fn name(&self) -> &'static str {
        "gradient"
    }

    fn cpu_fwd(
        &self,
        g: &mut CpuStorage,
        g_l: &Layout,
        y: &CpuStorage,
        y_l: &Layout,
        d: &CpuStorage,
        d_l: &Layout,
    ) -> Result<()> {
        let (gradient, activations, derivatives) = (values_mut(g, g_l)?, values(y, y_l)?, values(d, d_l)?);
        let n = self.obs.len() / self.network.obs_dim();
        check_sizes(self.network, n, activations, gradient)?;
        check_sizes(self.network, n, derivatives, gradient)?;
        for layer in &self.network.layers {
            let x = inputs(layer, self.obs, layer.split(activations, n).0, n);
            let d_y = layer.split(derivatives, n).1;
            let (d_w, d_b) = layer.weights_mut(gradient);
            matmul(Matrix::new(x, layer.n_in).t(), Matrix::new(d_y, layer.n_out), d_w);
            vectorised(SumRows { rows: d_y, sums: d_b });
        }
        Ok(())
    }
}

/// What a layer sees: the activations just before its own, or the observations.
fn inputs<'a>(layer: &LayerShape, obs: &'a [f32], before: &'a [f32], n: usize) -> &'a [f32] {
    if before.is_empty() { obs } else { &before[before.len() - n * layer.n_in..] }
}

fn check_sizes(network: &Network, n: usize, units: &[f32], weights: &[f32]) -> Result<()> {
    if (units.len(), weights.len()) == (n * network.n_units(), network.n_weights()) {
        return Ok(());
    }
    bail!("{} units and {} weights do not fit {n} rows of a network {:?}", units.len(), weights.len(), network.widths)
}

/// `y <- max(y + b, 0)`, row by row, or `y + b` for the last layer.
struct AddBias<'a> {
    y: &'a mut [f32],
    b: &'a [f32],
    is_last: bool,
}

impl Loop for AddBias<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for row in self.y.chunks_exact_mut(self.b.len()) {
            if self.is_last {
                row.iter_mut().zip(self.b).for_each(|(y, b)| *y += b);
            } else {
                row.iter_mut().zip(self.b).for_each(|(y, b)| *y = (*y + b).max(0.0));
            }
        }
    }
}

/// `d <- d` where `x > 0`, else 0.
struct ZeroWhereClosed<'a> {
    d: &'a mut [f32],
    x: &'a [f32],
}

impl Loop for ZeroWhereClosed<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.d.iter_mut().zip(self.x).for_each(|(d, &x)| *d = if x > 0.0 { *d } else { 0.0 });
    }
}

/// Sets `sums` `[n_columns]` to the sum of all rows.
struct SumRows<'a> {
    rows: &'a [f32],
    sums: &'a mut [f32],
}

impl Loop for SumRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.sums.fill(0.0);
        for row in self.rows.chunks_exact(self.sums.len()) {
            self.sums.iter_mut().zip(row).for_each(|(sum, x)| *sum += x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::Layer;
    use crate::random::stream;
    use crate::tensors::zeros;
    use candle_core::{Device, Tensor, Var};

    fn numbers(n: usize, k: f32) -> Vec<f32> {
        (0..n).map(|i| (k * i as f32 + 0.3).sin()).collect()
    }

    fn flat(tensor: &Tensor) -> Vec<f32> {
        tensor.flatten_all().unwrap().to_vec1().unwrap()
    }

    fn close(a: &[f32], b: &[f32]) {
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5), "{a:?} {b:?}");
    }

    #[test]
    fn a_network_by_hand() {
        let network = Network::new(2, &[2], 1);
        let layers = [
            Layer { weight: vec![1.0, 2.0, -1.0, 0.5], bias: vec![0.5, 0.0] },
            Layer { weight: vec![3.0, 7.0], bias: vec![-1.0] },
        ];
        let weights = Tensor::new(network.flatten(&layers), &Device::Cpu).unwrap();
        let activations = zeros(3).unwrap();
        activations.inplace_op2(&weights, &Forward { network: &network, obs: &[1.0, 2.0] }).unwrap();
        // Hidden: 1 + 2*2 + 0.5 = 5.5 and relu(-1 + 0.5*2) = 0; output: 3*5.5 - 1 = 15.5.
        assert_eq!(flat(&activations), [5.5, 0.0, 15.5]);
    }

    /// Values and gradients against candle's own operations and its automatic differentiation.
    #[test]
    fn passes_equal_candles_own() {
        for (hidden, n) in [(vec![], 3), (vec![7], 1), (vec![17, 9], 5), (vec![64, 64, 3], 33)] {
            let network = Network::new(5, &hidden, 4);
            let layers = network.initialise(&mut stream(1, "weights"));
            let (obs, d_q) = (numbers(n * 5, 1.3), numbers(n * 4, 0.7));
            let vars = |layer: &Layer| {
                let shape = (layer.bias.len(), layer.weight.len() / layer.bias.len());
                let w = Var::from_slice(&layer.weight, shape, &Device::Cpu).unwrap();
                (w, Var::from_slice(&numbers(shape.0, 2.1), shape.0, &Device::Cpu).unwrap())
            };
            let vars: Vec<_> = layers.iter().map(vars).collect();
            let mut q = Tensor::from_slice(&obs, (n, 5), &Device::Cpu).unwrap();
            for (i, (w, b)) in vars.iter().enumerate() {
                q = q.matmul(&w.t().unwrap()).unwrap().broadcast_add(b).unwrap();
                q = if i + 1 < vars.len() { q.relu().unwrap() } else { q };
            }
            let d = Tensor::from_slice(&d_q, (n, 4), &Device::Cpu).unwrap();
            let grads = (&q * d).unwrap().sum_all().unwrap().backward().unwrap();

            let as_layers = |tensors: &[(Tensor, Tensor)]| -> Vec<Layer> {
                tensors.iter().map(|(w, b)| Layer { weight: flat(w), bias: flat(b) }).collect()
            };
            let tensors: Vec<_> = vars.iter().map(|(w, b)| (w.as_tensor().clone(), b.as_tensor().clone())).collect();
            let weights = Tensor::new(network.flatten(&as_layers(&tensors)), &Device::Cpu).unwrap();
            let [y, d_y] = [(); 2].map(|()| zeros(n * network.n_units()).unwrap());
            let gradient = zeros(network.n_weights()).unwrap();
            y.inplace_op2(&weights, &Forward { network: &network, obs: &obs }).unwrap();
            d_y.inplace_op3(&y, &weights, &BackPropagate { network: &network, d_q: &d_q }).unwrap();
            gradient.inplace_op3(&y, &d_y, &Gradient { network: &network, obs: &obs }).unwrap();

            close(network.q(&flat(&y), n), &flat(&q));
            let of = |var: &Var| grads.get(var).unwrap().contiguous().unwrap();
            let expected: Vec<_> = vars.iter().map(|(w, b)| (of(w), of(b))).collect();
            close(&flat(&gradient), &network.flatten(&as_layers(&expected)));
        }
    }

    #[test]
    fn tensors_of_another_size_are_refused() {
        let network = Network::new(2, &[], 1);
        let op = Forward { network: &network, obs: &[0.0; 4] };
        assert!(zeros(2).unwrap().inplace_op2(&zeros(3).unwrap(), &op).is_ok());
        assert!(zeros(3).unwrap().inplace_op2(&zeros(3).unwrap(), &op).is_err());
        assert!(zeros(2).unwrap().inplace_op2(&zeros(4).unwrap(), &op).is_err());
    }
}
