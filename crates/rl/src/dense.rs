//! One layer of the network as one differentiable operation.

use candle_core::{CpuStorage, CustomOp3, Device, Layout, Result, Shape, Tensor};

use crate::inplace::{read, values};
use crate::kernel::{Matrix, Store, matmul};

/// What a layer applies to its sums.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Activation {
    /// `max(x, 0)`.
    Relu,
    /// Nothing.
    Identity,
}

/// `activation(x w^T + b)` with `x` `[n, n_in]`, `w` `[n_out, n_in]`, `b` `[n_out]`; the result is `[n, n_out]`.
///
/// Candle's own `matmul`, `broadcast_add` and `relu` give the same numbers with more passes over memory, and their
/// backward pass computes a gradient for the input even where nobody wants one.
pub(crate) fn dense(x: &Tensor, w: &Tensor, b: &Tensor, activation: Activation) -> Result<Tensor> {
    x.apply_op3(w, b, Dense(activation))
}

struct Dense(Activation);

impl CustomOp3 for Dense {
    fn name(&self) -> &'static str {
        "dense"
    }

    fn cpu_fwd(
        &self,
        x: &CpuStorage,
        x_l: &Layout,
        w: &CpuStorage,
        w_l: &Layout,
        b: &CpuStorage,
        b_l: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let ((n, n_in), (n_out, _)) = (x_l.shape().dims2()?, w_l.shape().dims2()?);
        let (x, w) = (Matrix::new(values(x, x_l)?, n_in), Matrix::new(values(w, w_l)?, n_in));
        let mut y = values(b, b_l)?.repeat(n);
        matmul(x, w.t(), &mut y, Store::Add);
        if self.0 == Activation::Relu {
            y.iter_mut().for_each(|y| *y = y.max(0.0));
        }
        Ok((CpuStorage::F32(y), Shape::from((n, n_out))))
    }

    /// With `d = grad * [y > 0]`: `dx = d w`, `dw = d^T x`, `db = sum over rows of d`.
    fn bwd(
        &self,
        x: &Tensor,
        w: &Tensor,
        _b: &Tensor,
        y: &Tensor,
        grad: &Tensor,
    ) -> Result<(Option<Tensor>, Option<Tensor>, Option<Tensor>)> {
        let (n_out, n_in) = w.dims2()?;
        let d = match self.0 {
            Activation::Relu => read(grad, |grad| read(y, |y| mask_positive(grad, y)))??,
            Activation::Identity => read(grad, <[f32]>::to_vec)?,
        };
        let rows = Matrix::new(&d, n_out);
        let dx = if x.track_op() {
            Some(read(w, |w| product(rows, Matrix::new(w, n_in), (x.dim(0)?, n_in)))??)
        } else {
            None
        };
        let dw = read(x, |x| product(rows.t(), Matrix::new(x, n_in), (n_out, n_in)))??;
        let db = Tensor::from_vec(column_sums(&d, n_out), n_out, &Device::Cpu)?;
        Ok((dx, Some(dw), Some(db)))
    }
}

/// `a b` as a tensor of this shape.
fn product(a: Matrix<'_>, b: Matrix<'_>, shape: (usize, usize)) -> Result<Tensor> {
    let mut c = vec![0.0; shape.0 * shape.1];
    matmul(a, b, &mut c, Store::Overwrite);
    Tensor::from_vec(c, shape, &Device::Cpu)
}

/// `grad` where `y > 0`, else 0.
fn mask_positive(grad: &[f32], y: &[f32]) -> Vec<f32> {
    grad.iter().zip(y).map(|(&grad, &y)| if y > 0.0 { grad } else { 0.0 }).collect()
}

fn column_sums(values: &[f32], n_columns: usize) -> Vec<f32> {
    let mut sums = vec![0.0; n_columns];
    for row in values.chunks_exact(n_columns) {
        sums.iter_mut().zip(row).for_each(|(sum, x)| *sum += x);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use candle_core::{Device, Var};

    fn close(a: &Tensor, b: &Tensor) {
        let [a, b] = [a, b].map(|t| t.flatten_all().unwrap().to_vec1::<f32>().unwrap());
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-6), "{a:?} {b:?}");
    }

    /// Values and gradients against candle's own operations.
    #[test]
    fn dense_equals_matmul_add_relu() {
        let numbers = |n: usize, k: f32| (0..n).map(|i| (k * i as f32).sin()).collect::<Vec<_>>();
        let var = |n: usize, k, shape: &[usize]| Var::from_vec(numbers(n, k), shape, &Device::Cpu).unwrap();
        let (x, w, b) = (var(15, 1.3, &[5, 3]), var(6, 0.7, &[2, 3]), var(2, 2.1, &[2]));
        let weights = Tensor::from_vec(numbers(10, 0.9), (5, 2), &Device::Cpu).unwrap();
        for activation in [Activation::Relu, Activation::Identity] {
            let fused = dense(&x, &w, &b, activation).unwrap();
            let sums = x.matmul(&w.t().unwrap()).unwrap().broadcast_add(&b).unwrap();
            let plain = if activation == Activation::Relu { sums.relu().unwrap() } else { sums };
            close(&fused, &plain);
            let grads = |y: &Tensor| (y * &weights).unwrap().sum_all().unwrap().backward().unwrap();
            let (fused, plain) = (grads(&fused), grads(&plain));
            for var in [&x, &w, &b] {
                close(fused.get(var).unwrap(), plain.get(var).unwrap());
            }
        }
    }
}
