//! Adam (Kingma and Ba 2015, algorithm 1) and what follows it, in one pass over everything that learns.

use candle_core::{CpuStorage, Device, InplaceOp2, Layout, Result, Tensor};

use crate::kernel::{Loop, vectorised};
use crate::spec::AdamSpec;
use crate::tensors::{values, values_mut};

/// Everything that learns, in one tensor `[5, n_weights]`: the weights of the online, the target and the averaged
/// network, and both moments of Adam.
#[derive(Debug)]
pub(crate) struct Memory {
    all: Tensor,
    /// Views `[n_weights]` of the first three rows.
    pub(crate) online: Tensor,
    pub(crate) target: Tensor,
    pub(crate) averaged: Tensor,
}

/// The number of rows of a [`Memory`].
pub(crate) const N_ROWS: usize = 5;

impl Memory {
    /// The same weights in all three networks, and no moments.
    pub(crate) fn new(weights: &[f32]) -> Result<Self> {
        Self::from_numbers(&[weights, weights, weights, &vec![0.0; 2 * weights.len()]].concat())
    }

    /// From all five rows.
    pub(crate) fn from_numbers(numbers: &[f32]) -> Result<Self> {
        let all = Tensor::from_slice(numbers, (N_ROWS, numbers.len() / N_ROWS), &Device::Cpu)?;
        let [online, target, averaged] = [0, 1, 2].map(|row| all.get(row));
        Ok(Self { online: online?, target: target?, averaged: averaged?, all })
    }

    /// All five rows.
    pub(crate) fn numbers(&self) -> Result<Vec<f32>> {
        self.all.flatten_all()?.to_vec1()
    }

    /// Takes a step along a gradient `[n_weights]`.
    pub(crate) fn step(&self, gradient: &Tensor, step: &AdamStep) -> Result<()> {
        self.all.inplace_op2(gradient, step)
    }
}

/// One step of Adam, and of the two networks that follow the online one; elementwise, with `g` the gradient:
///
/// `m <- b1 m + (1 - b1) g`, `v <- b2 v + (1 - b2) g^2`, `w <- w - rate m / (1 - b1^t) / (sqrt(v / (1 - b2^t)) + eps)`,
/// `target <- (1 - tau) target + tau w`, `averaged <- (1 - average) averaged + average w`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AdamStep {
    first: Decay,
    second: Decay,
    /// The bias corrections, folded into two factors.
    rate: f32,
    v_scale: f32,
    eps: f32,
    tau: f32,
    average: f32,
}

/// A decaying mean: `x <- keep x + take y`.
#[derive(Debug, Clone, Copy)]
struct Decay {
    keep: f32,
    take: f32,
}

/// By how much the other networks move towards the online one; 0 is not at all, 1 copies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Follow {
    pub(crate) tau: f32,
    pub(crate) average: f32,
}

impl AdamStep {
    /// Step `t`, from 1, along a gradient that is multiplied by `scale` first (for clipping).
    pub(crate) fn new(spec: AdamSpec, t: u64, scale: f32, learning_rate: f32, follow: Follow) -> Self {
        let AdamSpec { beta1, beta2, eps } = spec;
        let correction = |beta: f64| 1.0 - beta.powf(t as f64);
        let scale = f64::from(scale);
        Self {
            first: Decay { keep: beta1 as f32, take: ((1.0 - beta1) * scale) as f32 },
            second: Decay { keep: beta2 as f32, take: ((1.0 - beta2) * scale * scale) as f32 },
            rate: (f64::from(learning_rate) / correction(beta1)) as f32,
            v_scale: correction(beta2).sqrt().recip() as f32,
            eps: eps as f32,
            tau: follow.tau,
            average: follow.average,
        }
    }
}

/// An [`AdamStep`] on the numbers of a [`Memory`].
struct Run<'a> {
    step: AdamStep,
    memory: &'a mut [f32],
    gradient: &'a [f32],
}

impl Loop for Run<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { step, memory, gradient } = self;
        let n = gradient.len();
        let (online, rest) = memory.split_at_mut(n);
        let (target, rest) = rest.split_at_mut(n);
        let (averaged, rest) = rest.split_at_mut(n);
        let (first, second) = rest.split_at_mut(n);
        let second = &mut second[..n];
        for i in 0..n {
            let g = gradient[i];
            first[i] = flush(step.first.of(first[i], g));
            second[i] = flush(step.second.of(second[i], g * g));
            online[i] -= step.rate * first[i] / (second[i].sqrt() * step.v_scale + step.eps);
            target[i] = step.tau * online[i] + (1.0 - step.tau) * target[i];
            averaged[i] = step.average * online[i] + (1.0 - step.average) * averaged[i];
        }
    }
}

impl Decay {
    #[inline(always)]
    fn of(self, x: f32, y: f32) -> f32 {
        self.keep * x + self.take * y
    }
}

impl InplaceOp2 for AdamStep {
    fn name(&self) -> &'static str {
        "adam-step"
    }

    fn cpu_fwd(&self, memory: &mut CpuStorage, memory_l: &Layout, g: &CpuStorage, g_l: &Layout) -> Result<()> {
        let (memory, gradient) = (values_mut(memory, memory_l)?, values(g, g_l)?);
        vectorised(Run { step: *self, memory, gradient });
        Ok(())
    }
}

/// Zero instead of numbers too small to matter.
///
/// The moments of a dead unit's weights decay geometrically into the denormal numbers and stay there, because rounding
/// stops the decay; arithmetic on them is tens of times slower, and doubled the cost of a whole gradient step.
#[inline(always)]
fn flush(x: f32) -> f32 {
    if x.abs() < 1e-30 { 0.0 } else { x }
}

/// The sum of squares, in sixteen interleaved partial sums: the same on every machine, and fit for vector instructions.
pub(crate) fn sum_of_squares(values: &[f32]) -> f64 {
    let (chunks, rest) = values.as_chunks::<16>();
    let sums = vectorised(SumsOfSquares(chunks));
    let rest = rest.iter().map(|&x| f64::from(x) * f64::from(x));
    sums.iter().map(|&sum| f64::from(sum)).chain(rest).sum()
}

struct SumsOfSquares<'a>(&'a [[f32; 16]]);

impl Loop for SumsOfSquares<'_> {
    type Output = [f32; 16];

    #[inline(always)]
    fn run(self) -> [f32; 16] {
        let mut sums = [0.0; 16];
        for chunk in self.0 {
            sums.iter_mut().zip(chunk).for_each(|(sum, x)| *sum += x * x);
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STILL: Follow = Follow { tau: 0.0, average: 0.0 };

    fn step(memory: &Memory, g: f32, step: AdamStep) -> [f32; N_ROWS] {
        memory.step(&Tensor::new(&[g], &Device::Cpu).unwrap(), &step).unwrap();
        memory.numbers().unwrap().try_into().unwrap()
    }

    #[test]
    fn two_steps_by_hand() {
        let memory = Memory::new(&[0.5]).unwrap();
        let spec = AdamSpec { beta1: 0.5, beta2: 0.75, eps: 0.1 };
        // t = 1, g = 2: m = 1, v = 1; m^ = 2, v^ = 4; w = 0.5 - 0.21 * 2 / (2 + 0.1) = 0.3.
        let [w, ..] = step(&memory, 2.0, AdamStep::new(spec, 1, 1.0, 0.21, STILL));
        assert!((w - 0.3).abs() < 1e-6);
        // t = 2, g = -1: m = 0, v = 1; the weight stays.
        let [w, target, averaged, m, v] = step(&memory, -1.0, AdamStep::new(spec, 2, 1.0, 0.21, STILL));
        assert!((w - 0.3).abs() < 1e-6);
        assert_eq!([target, averaged, m, v], [0.5, 0.5, 0.0, 1.0]);
    }

    #[test]
    fn the_other_networks_follow_the_weights_after_the_step() {
        let memory = Memory::from_numbers(&[3.0, 1.0, -1.0, 0.0, 0.0]).unwrap();
        let follow = |tau, average| AdamStep::new(AdamSpec::default(), 1, 1.0, 0.1, Follow { tau, average });
        let [w, target, averaged, ..] = step(&memory, 0.0, follow(0.25, 0.5));
        assert_eq!([w, target, averaged], [3.0, 1.5, 1.0]);
        let [w, target, averaged, ..] = step(&memory, 1.0, follow(1.0, 1.0));
        assert!(w < 3.0 && [target, averaged] == [w, w]);
    }

    #[test]
    fn the_scale_is_applied_to_the_gradient() {
        let spec = AdamSpec { beta1: 0.9, beta2: 0.999, eps: 1.0 };
        let [one, other] = [(4.0, 0.5), (2.0, 1.0)]
            .map(|(g, scale)| step(&Memory::new(&[0.5]).unwrap(), g, AdamStep::new(spec, 1, scale, 0.1, STILL)));
        assert_eq!(one, other);
    }

    #[test]
    fn moments_of_dead_units_end_at_zero_and_not_among_the_denormals() {
        let memory = Memory::from_numbers(&[0.0, 0.0, 0.0, 1e-3, 1e-3]).unwrap();
        let spec = AdamSpec { beta1: 0.9, beta2: 0.9, eps: 1.0 };
        for t in 1..1000 {
            step(&memory, 0.0, AdamStep::new(spec, t, 1.0, 0.1, STILL));
        }
        assert_eq!(memory.numbers().unwrap()[3..], [0.0, 0.0]);
    }

    #[test]
    fn sum_of_squares_of_any_length() {
        for n in [0, 1, 15, 16, 17, 100] {
            let values: Vec<f32> = (1..=n).map(|i| i as f32).collect();
            assert_eq!(sum_of_squares(&values), f64::from(n * (n + 1) * (2 * n + 1) / 6));
        }
    }
}
