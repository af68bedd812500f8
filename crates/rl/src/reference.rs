//! The whole gradient step again, slowly, in plain loops and f64, to check the one that runs.

use rand::RngExt;

use crate::adam::N_ROWS;
use crate::learner::Learner;
use crate::network::{Layer, Network};
use crate::random::stream;
use crate::replay::MiniBatch;
use crate::{AdamSpec, DqnSpec, GradientClip, LossFn, TargetRule, TargetUpdate};

/// All weights in a row, in the order of [`Layer`]; `WIDTHS` give them their meaning.
type Weights = Vec<f64>;

const WIDTHS: [usize; 4] = [5, 7, 6, 3];
const BATCH_SIZE: usize = 16;
const RATE: f64 = 0.01;

struct Reference {
    spec: DqnSpec,
    online: Weights,
    target: Weights,
    averaged: Weights,
    m: Weights,
    v: Weights,
    /// The weighted sum of all online weights so far, and the sum of its weights.
    sum: (Weights, f64),
    t: i32,
}

/// The activations of every layer for one observation, the input first and Q last.
fn forward(weights: &[f64], obs: &[f32]) -> Vec<Vec<f64>> {
    let mut activations = vec![obs.iter().map(|&x| f64::from(x)).collect::<Vec<_>>()];
    let mut at = 0;
    for (i, pair) in WIDTHS.windows(2).enumerate() {
        let (n_in, n_out) = (pair[0], pair[1]);
        let x = &activations[i];
        let mut y = Vec::new();
        for o in 0..n_out {
            let mut sum = weights[at + n_in * n_out + o];
            for j in 0..n_in {
                sum += weights[at + o * n_in + j] * x[j];
            }
            y.push(if i + 2 < WIDTHS.len() { sum.max(0.0) } else { sum });
        }
        activations.push(y);
        at += n_in * n_out + n_out;
    }
    activations
}

/// Adds the gradient of `sum_a d[a] Q(obs, a)` with respect to all weights to `grad`.
fn backward(weights: &[f64], obs: &[f32], mut d: Vec<f64>, grad: &mut [f64]) {
    let activations = forward(weights, obs);
    let mut at = weights.len();
    for (i, pair) in WIDTHS.windows(2).enumerate().rev() {
        let (n_in, n_out) = (pair[0], pair[1]);
        at -= n_in * n_out + n_out;
        let x = &activations[i];
        let mut dx = vec![0.0; n_in];
        for o in 0..n_out {
            grad[at + n_in * n_out + o] += d[o];
            for j in 0..n_in {
                grad[at + o * n_in + j] += d[o] * x[j];
                // An activation of zero is a closed ReLU; the input's own derivative is not used.
                dx[j] += if x[j] > 0.0 { d[o] * weights[at + o * n_in + j] } else { 0.0 };
            }
        }
        d = dx;
    }
}

fn max_index(q: &[f64]) -> usize {
    (0..q.len()).max_by(|&a, &b| q[a].total_cmp(&q[b])).unwrap()
}

impl Reference {
    fn new(spec: &DqnSpec, [online, target, ..]: [Weights; N_ROWS]) -> Self {
        let zeros = vec![0.0; online.len()];
        Self {
            spec: spec.clone(),
            target,
            averaged: online.clone(),
            m: zeros.clone(),
            v: zeros.clone(),
            sum: (zeros, 0.0),
            t: 0,
            online,
        }
    }

    /// Takes one step; returns the mean loss, the mean Q(s, a), and the norm of the gradient.
    fn step(&mut self, batch: &MiniBatch) -> (f64, f64, f64) {
        let n = BATCH_SIZE as f64;
        let mut grad = vec![0.0; self.online.len()];
        let (mut loss, mut mean_q) = (0.0, 0.0);
        for i in 0..BATCH_SIZE {
            let obs = &batch.obs[i * WIDTHS[0]..(i + 1) * WIDTHS[0]];
            let action = batch.actions[i] as usize;
            let q = forward(&self.online, obs).pop().unwrap()[action];
            let e = q - self.target_of(batch, i);
            let (value, slope) = match self.spec.loss {
                LossFn::Mse {} => (e * e, 2.0 * e),
                LossFn::Huber { delta } if e.abs() <= delta => (0.5 * e * e, e),
                LossFn::Huber { delta } => (delta * (e.abs() - 0.5 * delta), delta * e.signum()),
            };
            (loss, mean_q) = (loss + value / n, mean_q + q / n);
            let mut d = vec![0.0; WIDTHS[3]];
            d[action] = slope / n;
            backward(&self.online, obs, d, &mut grad);
        }
        let norm = grad.iter().map(|g| g * g).sum::<f64>().sqrt();
        if let GradientClip::Norm { max } = self.spec.grad_clip {
            grad.iter_mut().for_each(|g| *g *= (max / norm).min(1.0));
        }
        self.adam(&grad);
        self.follow();
        (loss, mean_q, norm)
    }

    fn target_of(&self, batch: &MiniBatch, i: usize) -> f64 {
        let next = &batch.next_obs[i * WIDTHS[0]..(i + 1) * WIDTHS[0]];
        let evaluated = forward(&self.target, next).pop().unwrap();
        let selecting = match self.spec.target {
            TargetRule::Dqn => &self.target,
            TargetRule::DoubleDqn => &self.online,
        };
        let best = max_index(&forward(selecting, next).pop().unwrap());
        f64::from(batch.n_step_returns[i]) + f64::from(batch.discounts[i]) * evaluated[best]
    }

    fn adam(&mut self, grad: &[f64]) {
        self.t += 1;
        let AdamSpec { beta1, beta2, eps } = self.spec.adam;
        for (i, g) in grad.iter().enumerate() {
            self.m[i] = beta1 * self.m[i] + (1.0 - beta1) * g;
            self.v[i] = beta2 * self.v[i] + (1.0 - beta2) * g * g;
            let m = self.m[i] / (1.0 - beta1.powi(self.t));
            let v = self.v[i] / (1.0 - beta2.powi(self.t));
            self.online[i] -= RATE * m / (v.sqrt() + eps);
        }
    }

    fn follow(&mut self) {
        let tau = match self.spec.target_network {
            TargetUpdate::Soft { tau } => tau,
            TargetUpdate::Hard { every } => f64::from(u8::from((self.t as u64).is_multiple_of(every))),
        };
        let keep = 1.0 - self.spec.average;
        self.sum.1 = keep * self.sum.1 + 1.0;
        for i in 0..self.online.len() {
            self.target[i] += tau * (self.online[i] - self.target[i]);
            self.sum.0[i] = keep * self.sum.0[i] + self.online[i];
            self.averaged[i] = self.sum.0[i] / self.sum.1;
        }
    }
}

fn batch(rng: &mut rand_chacha::ChaCha8Rng) -> MiniBatch {
    let mut numbers = |n: usize, scale: f32| (0..n).map(|_| rng.random_range(-scale..scale)).collect::<Vec<f32>>();
    let (obs, next_obs) = (numbers(BATCH_SIZE * WIDTHS[0], 2.0), numbers(BATCH_SIZE * WIDTHS[0], 2.0));
    let n_step_returns = numbers(BATCH_SIZE, 3.0);
    MiniBatch {
        obs,
        actions: (0..BATCH_SIZE as u32).map(|i| i * i % 3).collect(),
        n_step_returns,
        next_obs,
        discounts: (0..BATCH_SIZE).map(|i| [0.857, 0.0, 0.95][i % 3]).collect(),
        ..MiniBatch::default()
    }
}

fn assert_close(what: &str, found: &[f64], expected: &[f64]) {
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() < 2e-5, "{what}[{i}]: {found}, expected {expected}");
    }
}

/// The five rows of a learner's memory: online, target, averaged, first and second moments.
fn rows(learner: &Learner) -> [Weights; N_ROWS] {
    let memory = learner.state().unwrap().memory;
    let mut rows = memory.chunks(memory.len() / N_ROWS).map(|row| {
        let layers = learner.network.unflatten(row);
        layers.iter().flat_map(|Layer { weight, bias }| weight.iter().chain(bias)).map(|&x| f64::from(x)).collect()
    });
    std::array::from_fn(|_| rows.next().unwrap())
}

fn check(spec: DqnSpec) {
    let mut rng = stream(3, "reference");
    let mut learner = Learner::new(&spec, WIDTHS[0], WIDTHS[3], &mut rng).unwrap();
    // Start from networks that differ, or the two rules would agree.
    let other = Network::new(WIDTHS[0], &WIDTHS[1..3], WIDTHS[3]).initialise(&mut rng);
    let mut state = learner.state().unwrap();
    let n_weights = learner.network.n_weights();
    state.memory[n_weights..2 * n_weights].copy_from_slice(&learner.network.flatten(&other));
    learner.set_state(&state).unwrap();
    let mut reference = Reference::new(&spec, rows(&learner));
    for _ in 0..5 {
        let batch = batch(&mut rng);
        let (value, mean_q, norm) = reference.step(&batch);
        let loss = learner.step(&batch, RATE).unwrap();
        for (found, expected) in [(loss.value, value), (loss.mean_q, mean_q), (loss.grad_norm, norm)] {
            assert!(
                (f64::from(found) - expected).abs() < 1e-4 * expected.abs().max(1.0),
                "{loss:?}, expected {expected}"
            );
        }
        let [online, target, averaged, m, v] = rows(&learner);
        assert_close("online", &online, &reference.online);
        assert_close("target", &target, &reference.target);
        assert_close("averaged", &averaged, &reference.averaged);
        assert_close("first moment", &m, &reference.m);
        assert_close("second moment", &v, &reference.v);
    }
}

#[test]
fn the_gradient_step_equals_a_slow_reference() {
    // A large eps keeps Adam's division well conditioned, so that f32 and f64 can be compared.
    let adam = AdamSpec { eps: 1e-2, ..AdamSpec::default() };
    let hidden = WIDTHS[1..3].to_vec();
    let base = DqnSpec { hidden, adam, average: 0.3, ..DqnSpec::default() };
    for target in [TargetRule::Dqn, TargetRule::DoubleDqn] {
        for loss in [LossFn::Huber { delta: 1.0 }, LossFn::Mse {}] {
            for grad_clip in [GradientClip::Off {}, GradientClip::Norm { max: 0.1 }] {
                for target_network in [TargetUpdate::Soft { tau: 0.1 }, TargetUpdate::Hard { every: 2 }] {
                    check(DqnSpec { target, loss, grad_clip, target_network, ..base.clone() });
                }
            }
        }
    }
}

/// An error through the divergence check, not a silent NaN in the weights.
#[test]
fn a_loss_that_is_not_finite_is_an_error_and_leaves_the_weights_alone() {
    let mut rng = stream(3, "reference");
    let spec = DqnSpec { loss: LossFn::Mse {}, ..DqnSpec::default() };
    let mut learner = Learner::new(&spec, WIDTHS[0], WIDTHS[3], &mut rng).unwrap();
    let before = rows(&learner);
    let batch = MiniBatch { n_step_returns: vec![1e30; BATCH_SIZE], ..batch(&mut rng) };
    let message = learner.step(&batch, RATE).unwrap_err().to_string();
    assert!(message.starts_with("training diverged at gradient step 1: loss = inf"), "{message}");
    assert_eq!(rows(&learner), before);
}
