//! One gradient step of DQN: networks, target, loss, optimiser.

use candle_core::{Result, Tensor};
use rand_chacha::ChaCha8Rng;

use crate::adam::{AdamStep, Follow, Memory, sum_of_squares};
use crate::mlp::{BackPropagate, Forward, Gradient};
use crate::network::{Layer, Network};
use crate::replay::MiniBatch;
use crate::tensors::{read, zeros};
use crate::{AdamSpec, DqnSpec, GradientClip, Loss, LossFn, RlError, TargetRule, TargetUpdate, target};

/// Everything that learns: the online, target and averaged networks, and the optimiser.
#[derive(Debug)]
pub(crate) struct Learner {
    rule: TargetRule,
    loss: LossFn,
    grad_clip: GradientClip,
    target_network: TargetUpdate,
    average: f64,
    adam: AdamSpec,
    pub(crate) network: Network,
    memory: Memory,
    n_gradient_steps: u64,
    n_adam_steps: u64,
    buffers: Buffers,
}

/// What a gradient step computes on its way, kept only to save allocations.
#[derive(Debug)]
struct Buffers {
    /// Activations and derivatives, `[n * n_units]` for a minibatch of `n`.
    activations: Tensor,
    derivatives: Tensor,
    /// `[n_weights]`.
    gradient: Tensor,
    /// `[n]`.
    targets: Vec<f32>,
    /// The derivative of the loss with respect to Q, `[n, n_actions]`.
    d_q: Vec<f32>,
}

/// The weights, moments and counters of a learner, as plain numbers.
pub(crate) struct LearnerState {
    pub(crate) n_gradient_steps: u64,
    pub(crate) n_adam_steps: u64,
    /// The five rows of [`Memory`].
    pub(crate) memory: Vec<f32>,
}

/// Which weights to ask.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Weights {
    /// Those being learned.
    Online,
    /// Their moving average.
    Averaged,
}

impl Learner {
    pub(crate) fn new(spec: &DqnSpec, obs_dim: usize, n_actions: usize, rng: &mut ChaCha8Rng) -> Result<Self> {
        let network = Network::new(obs_dim, &spec.hidden, n_actions);
        Ok(Self {
            rule: spec.target,
            loss: spec.loss,
            grad_clip: spec.grad_clip,
            target_network: spec.target_network,
            average: spec.average,
            adam: spec.adam,
            memory: Memory::new(&network.flatten(&network.initialise(rng)))?,
            n_gradient_steps: 0,
            n_adam_steps: 0,
            buffers: Buffers::new(&network, 0)?,
            network,
        })
    }

    pub(crate) fn n_gradient_steps(&self) -> u64 {
        self.n_gradient_steps
    }

    /// Calls `with` with the Q-values `[n, n_actions]` of observations `[n, obs_dim]`.
    pub(crate) fn q_values<T>(&self, weights: Weights, obs: &[f32], with: impl FnOnce(&[f32]) -> T) -> Result<T> {
        self.activations(weights, obs, |activations, n| with(self.network.q(activations, n)))
    }

    /// Calls `with` with the activations of `n` observations `[n, obs_dim]`, laid out as [`Network`] says, and `n`.
    pub(crate) fn activations<T>(
        &self,
        weights: Weights,
        obs: &[f32],
        with: impl FnOnce(&[f32], usize) -> T,
    ) -> Result<T> {
        let weights = match weights {
            Weights::Online => &self.memory.online,
            Weights::Averaged => &self.memory.averaged,
        };
        let n = obs.len() / self.network.obs_dim();
        let activations = zeros(n * self.network.n_units())?;
        activations.inplace_op2(weights, &Forward { network: &self.network, obs })?;
        read(&activations, |activations| with(activations, n))
    }

    /// Takes one gradient step on a minibatch.
    ///
    /// Minimises the mean over the batch of `loss(Q(s, a; theta) - y)`, eq. (2), with `y` held constant. The derivative
    /// with respect to Q is `loss'(Q - y) / n` at the action taken and zero elsewhere; [`BackPropagate`] and [`Gradient`]
    /// carry it back to the weights.
    pub(crate) fn step(&mut self, batch: &MiniBatch, learning_rate: f64) -> std::result::Result<Loss, RlError> {
        self.fit_buffers(batch.actions.len())?;
        self.compute_targets(batch)?;
        let (value, mean_q) = self.compute_gradient(batch)?;
        let grad_norm = read(&self.buffers.gradient, sum_of_squares)?.sqrt() as f32;
        self.check_finite("loss", value)?;
        self.check_finite("gradient norm", grad_norm)?;
        self.n_gradient_steps += 1;
        self.n_adam_steps += 1;
        let (learning_rate, scale) = (learning_rate as f32, self.grad_clip.factor(grad_norm));
        let step = AdamStep::new(self.adam, self.n_adam_steps, scale, learning_rate, self.follow());
        self.memory.step(&self.buffers.gradient, &step)?;
        Ok(Loss { value, mean_q, grad_norm, learning_rate })
    }

    /// Makes the buffers those for minibatches of `n`; memory is taken at the first step, not with the agent.
    fn fit_buffers(&mut self, n: usize) -> Result<()> {
        if self.buffers.activations.elem_count() != n * self.network.n_units() {
            self.buffers = Buffers::new(&self.network, n)?;
        }
        Ok(())
    }

    /// The targets `y` of a minibatch; see [`crate::target`].
    fn compute_targets(&mut self, batch: &MiniBatch) -> Result<()> {
        let Buffers { activations, derivatives, targets, .. } = &mut self.buffers;
        let (network, n) = (&self.network, batch.actions.len());
        let forward = Forward { network, obs: &batch.next_obs };
        activations.inplace_op2(&self.memory.target, &forward)?;
        if self.rule == TargetRule::DoubleDqn {
            // Derivatives come later; until then a second set of activations may have their place.
            derivatives.inplace_op2(&self.memory.online, &forward)?;
        }
        targets.clear();
        read(activations, |of_target| {
            read(derivatives, |of_online| {
                let returns = batch.n_step_returns.iter().zip(&batch.discounts);
                let q = network.q_rows(of_target, n).zip(network.q_rows(of_online, n));
                targets.extend(q.zip(returns).map(|((of_target, of_online), (&g, &discount))| match self.rule {
                    TargetRule::Dqn => target::dqn(g, discount, of_target),
                    TargetRule::DoubleDqn => target::double_dqn(g, discount, of_online, of_target),
                }));
            })
        })?
    }

    /// The gradient of the mean loss; returns that loss and the mean Q(s, a).
    fn compute_gradient(&mut self, batch: &MiniBatch) -> Result<(f32, f32)> {
        let Buffers { activations, derivatives, gradient, targets, d_q, .. } = &mut self.buffers;
        let (network, obs, weights) = (&self.network, &batch.obs[..], &self.memory.online);
        activations.inplace_op2(weights, &Forward { network, obs })?;
        let figures = read(activations, |activations| {
            differentiate(self.loss, network.q(activations, targets.len()), &batch.actions, targets, d_q)
        })?;
        derivatives.inplace_op3(activations, weights, &BackPropagate { network, d_q })?;
        gradient.inplace_op3(activations, derivatives, &Gradient { network, obs })?;
        Ok(figures)
    }

    /// By how much the target and the averaged network follow the gradient step just counted.
    fn follow(&self) -> Follow {
        let tau = match self.target_network {
            TargetUpdate::Soft { tau } => tau as f32,
            TargetUpdate::Hard { every } => f32::from(u8::from(self.n_gradient_steps.is_multiple_of(every))),
        };
        Follow { tau, average: average_rate(self.average, self.n_gradient_steps) as f32 }
    }

    fn check_finite(&self, what: &'static str, value: f32) -> std::result::Result<(), RlError> {
        if value.is_finite() {
            return Ok(());
        }
        Err(RlError::Diverged { gradient_step: self.n_gradient_steps + 1, what, value })
    }

    /// The averaged weights.
    pub(crate) fn layers(&self) -> Result<Vec<Layer>> {
        read(&self.memory.averaged, |weights| self.network.unflatten(weights))
    }

    /// Puts the same weights into all three networks and forgets the moments.
    pub(crate) fn start_from(&mut self, layers: &[Layer]) -> Result<()> {
        self.memory = Memory::new(&self.network.flatten(layers))?;
        self.n_adam_steps = 0;
        Ok(())
    }

    pub(crate) fn state(&self) -> Result<LearnerState> {
        let Self { n_gradient_steps, n_adam_steps, .. } = *self;
        Ok(LearnerState { n_gradient_steps, n_adam_steps, memory: self.memory.numbers()? })
    }

    pub(crate) fn set_state(&mut self, state: &LearnerState) -> Result<()> {
        self.memory = Memory::from_numbers(&state.memory)?;
        (self.n_gradient_steps, self.n_adam_steps) = (state.n_gradient_steps, state.n_adam_steps);
        Ok(())
    }
}

impl Buffers {
    fn new(network: &Network, n: usize) -> Result<Self> {
        Ok(Self {
            activations: zeros(n * network.n_units())?,
            derivatives: zeros(n * network.n_units())?,
            gradient: zeros(network.n_weights())?,
            targets: Vec::new(),
            d_q: Vec::new(),
        })
    }
}

/// Sets `d_q` `[n, n_actions]` to the derivative of the mean loss with respect to Q; returns that loss and the mean
/// Q(s, a).
fn differentiate(loss: LossFn, q: &[f32], actions: &[u32], targets: &[f32], d_q: &mut Vec<f32>) -> (f32, f32) {
    d_q.clear();
    d_q.resize(q.len(), 0.0);
    let (mut sum, mut sum_q) = (0.0, 0.0);
    let (n_actions, per_row) = (q.len() / actions.len(), 1.0 / actions.len() as f32);
    for (row, (&action, y)) in actions.iter().zip(targets).enumerate() {
        let at = row * n_actions + action as usize;
        let error = q[at] - y;
        d_q[at] = per_row * loss.gradient(error);
        sum += loss.value(error);
        sum_q += q[at];
    }
    (per_row * sum, per_row * sum_q)
}

/// The rate of an unbiased moving average at step `t`, from 1: `rate / (1 - (1 - rate)^t)`.
///
/// It makes the average `sum_i w_i x_i / sum_i w_i` with `w_i = (1 - rate)^(t - i)` over the steps taken so far, so that
/// the initial weights leave it at the first step; Adam corrects its moments in the same way.
fn average_rate(rate: f64, t: u64) -> f64 {
    rate / (1.0 - (1.0 - rate).powf(t as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_average_is_the_normalised_weighted_mean() {
        let (rate, values) = (0.2f64, [3.0, -1.0, 4.0, 1.0, -5.0]);
        let mut average = 100.0;
        for (i, x) in values.iter().enumerate() {
            let rate = average_rate(rate, i as u64 + 1);
            average += rate * (x - average);
        }
        let weights = [0.8f64.powi(4), 0.8f64.powi(3), 0.8f64.powi(2), 0.8, 1.0];
        let mean = weights.iter().zip(values).map(|(w, x)| w * x).sum::<f64>() / weights.iter().sum::<f64>();
        assert!((average - mean).abs() < 1e-12);
        assert_eq!(average_rate(1.0, 1), 1.0);
    }
}
