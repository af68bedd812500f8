//! Adam (Kingma and Ba 2015, algorithm 1) with its whole state in the open.

use candle_core::{Result, Tensor, backprop::GradStore};

use crate::inplace::{AdamMove, FirstMoment, SecondMoment, read, sum_of_squares};
use crate::network::{Layer, Mlp};
use crate::spec::AdamSpec;

/// The optimiser: both moments of every weight, in the shape of the network.
///
/// `m <- b1 m + (1 - b1) g`, `v <- b2 v + (1 - b2) g^2`, `w <- w - rate m / (1 - b1^t) / (sqrt(v / (1 - b2^t)) + eps)`.
#[derive(Debug)]
pub(crate) struct Adam {
    spec: AdamSpec,
    first: Mlp,
    second: Mlp,
    n_steps: u64,
}

impl Adam {
    pub(crate) fn new(spec: AdamSpec, like: &[Layer]) -> Result<Self> {
        let zeros: Vec<Layer> = like.iter().map(Layer::zeros_like).collect();
        Ok(Self { spec, first: Mlp::frozen(&zeros)?, second: Mlp::frozen(&zeros)?, n_steps: 0 })
    }

    /// Takes step `t = n_steps + 1` along gradients that are multiplied by `scale` first (for clipping).
    pub(crate) fn step(&mut self, network: &Mlp, grads: &GradStore, scale: f32, learning_rate: f32) -> Result<()> {
        self.n_steps += 1;
        let AdamSpec { beta1, beta2, eps } = self.spec;
        let correction = |beta: f64| 1.0 - beta.powf(self.n_steps as f64);
        let scale = f64::from(scale);
        let to_first = FirstMoment { keep: beta1 as f32, take: ((1.0 - beta1) * scale) as f32 };
        let to_second = SecondMoment { keep: beta2 as f32, take: ((1.0 - beta2) * scale * scale) as f32 };
        let step = (f64::from(learning_rate) / correction(beta1)) as f32;
        let v_scale = correction(beta2).sqrt().recip() as f32;
        let move_weight = AdamMove { step, v_scale, eps: eps as f32 };
        for ((w, m), v) in network.tensors().zip(self.first.tensors()).zip(self.second.tensors()) {
            let grad = gradient(grads, w);
            m.inplace_op2(grad, &to_first)?;
            v.inplace_op2(grad, &to_second)?;
            w.inplace_op3(m, v, &move_weight)?;
        }
        Ok(())
    }

    /// The number of steps taken, and both moments.
    pub(crate) fn state(&self) -> Result<(u64, Vec<Layer>, Vec<Layer>)> {
        Ok((self.n_steps, self.first.layers()?, self.second.layers()?))
    }

    /// Continues from a state.
    pub(crate) fn set_state(&mut self, n_steps: u64, first: &[Layer], second: &[Layer]) -> Result<()> {
        self.first.assign(first)?;
        self.second.assign(second)?;
        self.n_steps = n_steps;
        Ok(())
    }
}

/// The Euclidean norm of the gradient of all of a network's weights.
pub(crate) fn gradient_norm(network: &Mlp, grads: &GradStore) -> Result<f32> {
    let squares = network.tensors().map(|w| read(gradient(grads, w), sum_of_squares));
    Ok(squares.sum::<Result<f64>>()?.sqrt() as f32)
}

fn gradient<'a>(grads: &'a GradStore, weight: &Tensor) -> &'a Tensor {
    grads.get(weight).expect("every weight takes part in the Q-values")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::matrix;

    /// A network of one weight and one bias; with input x and output gradient 1, dw = x and db = 1.
    fn network() -> Mlp {
        Mlp::trainable(&[Layer { weight: vec![0.5], bias: vec![-0.5] }]).unwrap()
    }

    fn grads(network: &Mlp, x: f32) -> GradStore {
        network.forward(&matrix(vec![x], 1).unwrap()).unwrap().sum_all().unwrap().backward().unwrap()
    }

    fn weight(network: &Mlp) -> f32 {
        network.layers().unwrap()[0].weight[0]
    }

    #[test]
    fn two_steps_by_hand() {
        let network = network();
        let spec = AdamSpec { beta1: 0.5, beta2: 0.75, eps: 0.1 };
        let mut adam = Adam::new(spec, &network.layers().unwrap()).unwrap();
        // t = 1, g = 2: m = 1, v = 1; m^ = 2, v^ = 4; w = 0.5 - 0.21 * 2 / (2 + 0.1) = 0.3.
        adam.step(&network, &grads(&network, 2.0), 1.0, 0.21).unwrap();
        assert!((weight(&network) - 0.3).abs() < 1e-6);
        // t = 2, g = -1: m = 0, v = 1; the weight stays.
        adam.step(&network, &grads(&network, -1.0), 1.0, 0.21).unwrap();
        assert!((weight(&network) - 0.3).abs() < 1e-6);
        let (n_steps, first, second) = adam.state().unwrap();
        assert_eq!((n_steps, first[0].weight[0], second[0].weight[0]), (2, 0.0, 1.0));
    }

    #[test]
    fn the_scale_is_applied_to_the_gradient() {
        let (one, other) = (network(), network());
        let spec = AdamSpec { beta1: 0.9, beta2: 0.999, eps: 1.0 };
        let mut adam = [&one, &other].map(|network| Adam::new(spec, &network.layers().unwrap()).unwrap());
        adam[0].step(&one, &grads(&one, 4.0), 0.5, 0.1).unwrap();
        adam[1].step(&other, &grads(&other, 2.0), 1.0, 0.1).unwrap();
        assert_eq!(weight(&one), weight(&other));
    }

    #[test]
    fn the_norm_is_of_the_whole_gradient() {
        let network = network();
        // dw = 3, db = 1.
        assert_eq!(gradient_norm(&network, &grads(&network, 3.0)).unwrap(), 10f32.sqrt());
    }
}
