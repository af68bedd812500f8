//! The loops that candle has no single operation for: in place, fused, without allocation.

use candle_core::{CpuStorage, InplaceOp2, InplaceOp3, Layout, Result, Tensor, bail};

/// `dst <- (1 - rate) dst + rate src`, elementwise; a copy at `rate = 1`.
pub(crate) struct MoveTowards {
    pub(crate) rate: f32,
}

/// A decaying mean: `m <- keep m + take g`, elementwise.
pub(crate) struct FirstMoment {
    pub(crate) keep: f32,
    pub(crate) take: f32,
}

/// A decaying mean square: `v <- keep v + take g^2`, elementwise.
pub(crate) struct SecondMoment {
    pub(crate) keep: f32,
    pub(crate) take: f32,
}

/// `dst <- dst - step m / (sqrt(v) * v_scale + eps)`, elementwise: Adam, its bias corrections folded into two factors.
pub(crate) struct AdamMove {
    pub(crate) step: f32,
    pub(crate) v_scale: f32,
    pub(crate) eps: f32,
}

impl InplaceOp2 for MoveTowards {
    fn name(&self) -> &'static str {
        "move-towards"
    }

    fn cpu_fwd(&self, dst: &mut CpuStorage, dst_l: &Layout, src: &CpuStorage, src_l: &Layout) -> Result<()> {
        let keep = 1.0 - self.rate;
        for (x, y) in values_mut(dst, dst_l)?.iter_mut().zip(values(src, src_l)?) {
            *x = keep * *x + self.rate * y;
        }
        Ok(())
    }
}

impl InplaceOp2 for FirstMoment {
    fn name(&self) -> &'static str {
        "first-moment"
    }

    fn cpu_fwd(&self, m: &mut CpuStorage, m_l: &Layout, g: &CpuStorage, g_l: &Layout) -> Result<()> {
        for (m, g) in values_mut(m, m_l)?.iter_mut().zip(values(g, g_l)?) {
            *m = flush(self.keep * *m + self.take * g);
        }
        Ok(())
    }
}

impl InplaceOp2 for SecondMoment {
    fn name(&self) -> &'static str {
        "second-moment"
    }

    fn cpu_fwd(&self, v: &mut CpuStorage, v_l: &Layout, g: &CpuStorage, g_l: &Layout) -> Result<()> {
        for (v, g) in values_mut(v, v_l)?.iter_mut().zip(values(g, g_l)?) {
            *v = flush(self.keep * *v + self.take * g * g);
        }
        Ok(())
    }
}

impl InplaceOp3 for AdamMove {
    fn name(&self) -> &'static str {
        "adam-move"
    }

    fn cpu_fwd(
        &self,
        dst: &mut CpuStorage,
        dst_l: &Layout,
        m: &CpuStorage,
        m_l: &Layout,
        v: &CpuStorage,
        v_l: &Layout,
    ) -> Result<()> {
        let moments = values(m, m_l)?.iter().zip(values(v, v_l)?);
        for (x, (m, v)) in values_mut(dst, dst_l)?.iter_mut().zip(moments) {
            *x -= self.step * m / (v.sqrt() * self.v_scale + self.eps);
        }
        Ok(())
    }
}

/// Zero instead of numbers too small to matter.
///
/// The moments of a dead unit's weights decay geometrically into the denormal numbers and stay there, because rounding
/// stops the decay; arithmetic on them is tens of times slower, and doubled the cost of a whole gradient step.
fn flush(x: f32) -> f32 {
    if x.abs() < 1e-30 { 0.0 } else { x }
}

/// The numbers of a contiguous `f32` tensor on the CPU.
pub(crate) fn values<'a>(storage: &'a CpuStorage, layout: &Layout) -> Result<&'a [f32]> {
    match (storage, layout.contiguous_offsets()) {
        (CpuStorage::F32(values), Some((start, end))) => Ok(&values[start..end]),
        _ => bail!("expected a contiguous f32 tensor, got {:?}", layout.shape()),
    }
}

/// The numbers of a contiguous `f32` tensor on the CPU, to write.
pub(crate) fn values_mut<'a>(storage: &'a mut CpuStorage, layout: &Layout) -> Result<&'a mut [f32]> {
    match (storage, layout.contiguous_offsets()) {
        (CpuStorage::F32(values), Some((start, end))) => Ok(&mut values[start..end]),
        _ => bail!("expected a contiguous f32 tensor, got {:?}", layout.shape()),
    }
}

/// Calls `read` with the numbers of a tensor, without copying them.
pub(crate) fn read<T>(tensor: &Tensor, read: impl FnOnce(&[f32]) -> T) -> Result<T> {
    let (storage, layout) = tensor.storage_and_layout();
    match &*storage {
        candle_core::Storage::Cpu(storage) => Ok(read(values(storage, layout)?)),
        _ => bail!("expected a tensor on the CPU"),
    }
}

/// The sum of squares, in sixteen interleaved partial sums: the same on every machine, and fit for vector instructions.
pub(crate) fn sum_of_squares(values: &[f32]) -> f64 {
    let mut sums = [0.0f32; 16];
    let (chunks, rest) = values.as_chunks::<16>();
    for chunk in chunks {
        for (sum, x) in sums.iter_mut().zip(chunk) {
            *sum += x * x;
        }
    }
    let rest = rest.iter().map(|&x| f64::from(x) * f64::from(x));
    sums.iter().map(|&sum| f64::from(sum)).chain(rest).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use candle_core::Device;

    fn tensor(values: &[f32]) -> Tensor {
        Tensor::new(values, &Device::Cpu).unwrap()
    }

    #[test]
    fn soft_and_hard_moves_by_hand() {
        let (dst, src) = (tensor(&[1.0, -2.0]), tensor(&[3.0, 0.3]));
        dst.inplace_op2(&src, &MoveTowards { rate: 0.25 }).unwrap();
        assert_eq!(dst.to_vec1::<f32>().unwrap(), [1.5, -1.425]);
        dst.inplace_op2(&src, &MoveTowards { rate: 1.0 }).unwrap();
        assert_eq!(dst.to_vec1::<f32>().unwrap(), [3.0, 0.3]);
    }

    #[test]
    fn moments_by_hand() {
        let (moment, grad) = (tensor(&[1.0, -2.0]), tensor(&[6.0, 0.0]));
        moment.inplace_op2(&grad, &FirstMoment { keep: 0.75, take: 0.5 }).unwrap();
        assert_eq!(moment.to_vec1::<f32>().unwrap(), [0.75 + 0.5 * 6.0, -1.5]);
        moment.inplace_op2(&grad, &SecondMoment { keep: 0.5, take: 0.25 }).unwrap();
        assert_eq!(moment.to_vec1::<f32>().unwrap(), [1.875 + 0.25 * 36.0, -0.75]);
    }

    #[test]
    fn moments_of_dead_units_end_at_zero_and_not_among_the_denormals() {
        let (moment, grad) = (tensor(&[1e-3]), tensor(&[0.0]));
        for _ in 0..1000 {
            moment.inplace_op2(&grad, &FirstMoment { keep: 0.9, take: 0.1 }).unwrap();
        }
        assert_eq!(moment.to_vec1::<f32>().unwrap(), [0.0]);
    }

    #[test]
    fn sum_of_squares_of_any_length() {
        for n in [0, 1, 15, 16, 17, 100] {
            let values: Vec<f32> = (1..=n).map(|i| i as f32).collect();
            assert_eq!(sum_of_squares(&values), f64::from(n * (n + 1) * (2 * n + 1) / 6));
        }
    }

    #[test]
    fn a_strided_view_is_refused_rather_than_misread() {
        let view = Tensor::zeros((2, 3), candle_core::DType::F32, &Device::Cpu).unwrap().t().unwrap();
        assert!(read(&view, <[f32]>::len).is_err());
    }
}
