//! One gradient step of DQN: networks, target, loss, optimiser.

use candle_core::{Result, Tensor};
use rand_chacha::ChaCha8Rng;

use crate::adam::{Adam, gradient_norm};
use crate::inplace::read;
use crate::network::{Layer, Mlp, initialise, matrix, widths};
use crate::replay::MiniBatch;
use crate::{DqnSpec, GradientClip, Loss, LossFn, RlError, TargetRule, TargetUpdate, target};

/// Everything that learns: the online, target and averaged networks, and the optimiser.
#[derive(Debug)]
pub(crate) struct Learner {
    rule: TargetRule,
    loss: LossFn,
    grad_clip: GradientClip,
    target_network: TargetUpdate,
    average: f64,
    /// The sizes of the layers, from the observation to the actions.
    pub(crate) widths: Vec<usize>,
    online: Mlp,
    /// The online network's weights, in the same memory, for where no gradient is wanted.
    online_view: Mlp,
    target: Mlp,
    averaged: Mlp,
    adam: Adam,
    n_gradient_steps: u64,
}

/// The weights, moments and counters of a learner, as plain numbers.
pub(crate) struct LearnerState {
    pub(crate) n_gradient_steps: u64,
    pub(crate) n_adam_steps: u64,
    pub(crate) online: Vec<Layer>,
    pub(crate) target: Vec<Layer>,
    pub(crate) averaged: Vec<Layer>,
    pub(crate) first_moments: Vec<Layer>,
    pub(crate) second_moments: Vec<Layer>,
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
        let widths = widths(obs_dim, &spec.hidden, n_actions);
        let layers = initialise(&widths, rng);
        let online = Mlp::trainable(&layers)?;
        Ok(Self {
            rule: spec.target,
            loss: spec.loss,
            grad_clip: spec.grad_clip,
            target_network: spec.target_network,
            average: spec.average,
            widths,
            online_view: online.detached(),
            online,
            target: Mlp::frozen(&layers)?,
            averaged: Mlp::frozen(&layers)?,
            adam: Adam::new(spec.adam, &layers)?,
            n_gradient_steps: 0,
        })
    }

    pub(crate) fn obs_dim(&self) -> usize {
        self.widths[0]
    }

    pub(crate) fn n_actions(&self) -> usize {
        self.widths[self.widths.len() - 1]
    }

    pub(crate) fn n_gradient_steps(&self) -> u64 {
        self.n_gradient_steps
    }

    /// Calls `with` with the Q-values `[n, n_actions]` of observations `[n, obs_dim]`.
    pub(crate) fn q_values<T>(&self, weights: Weights, obs: &[f32], with: impl FnOnce(&[f32]) -> T) -> Result<T> {
        let network = match weights {
            Weights::Online => &self.online_view,
            Weights::Averaged => &self.averaged,
        };
        read(&network.forward(&matrix(obs.to_vec(), self.obs_dim())?)?, with)
    }

    /// Takes one gradient step on a minibatch.
    ///
    /// Minimises the mean over the batch of `loss(Q(s, a; theta) - y)`, eq. (2), with `y` held constant. The derivative
    /// with respect to Q is taken by hand, `loss'(Q - y) / n` at the action taken and zero elsewhere; candle carries it
    /// back to the weights as the gradient of `sum(Q * derivative)`.
    pub(crate) fn step(&mut self, batch: MiniBatch, learning_rate: f64) -> std::result::Result<Loss, RlError> {
        let next_obs = matrix(batch.next_obs, self.obs_dim())?;
        let targets = self.targets(&next_obs, &batch.n_step_returns, &batch.discounts)?;
        let q = self.online.forward(&matrix(batch.obs, self.obs_dim())?)?;
        let (derivative, value, mean_q) = read(&q, |q| self.derivative(q, &batch.actions, &targets))?;
        let derivative = matrix(derivative, self.n_actions())?;
        let grads = (q * derivative)?.sum_all()?.backward()?;
        let grad_norm = gradient_norm(&self.online, &grads)?;
        self.check_finite("loss", value)?;
        self.check_finite("gradient norm", grad_norm)?;
        let learning_rate = learning_rate as f32;
        self.adam.step(&self.online, &grads, self.grad_clip.factor(grad_norm), learning_rate)?;
        self.n_gradient_steps += 1;
        self.follow()?;
        Ok(Loss { value, mean_q, grad_norm, learning_rate })
    }

    /// The targets `y` of a minibatch, `[n]`; see [`crate::target`].
    fn targets(&self, next_obs: &Tensor, n_step_returns: &[f32], discounts: &[f32]) -> Result<Vec<f32>> {
        let q = |network: &Mlp| read(&network.forward(next_obs)?, <[f32]>::to_vec);
        let target_next = q(&self.target)?;
        let rows = n_step_returns.iter().zip(discounts).zip(target_next.chunks_exact(self.n_actions()));
        Ok(match self.rule {
            TargetRule::Dqn => rows.map(|((&g, &discount), target)| target::dqn(g, discount, target)).collect(),
            TargetRule::DoubleDqn => {
                let online_next = q(&self.online_view)?;
                rows.zip(online_next.chunks_exact(self.n_actions()))
                    .map(|(((&g, &discount), target), online)| target::double_dqn(g, discount, online, target))
                    .collect()
            }
        })
    }

    /// The derivative of the mean loss with respect to Q `[n, n_actions]`, the mean loss, and the mean Q(s, a).
    fn derivative(&self, q: &[f32], actions: &[u32], targets: &[f32]) -> (Vec<f32>, f32, f32) {
        let mut derivative = vec![0.0; q.len()];
        let (mut loss, mut sum_q) = (0.0, 0.0);
        let per_row = 1.0 / actions.len() as f32;
        for (row, (&action, y)) in actions.iter().zip(targets).enumerate() {
            let at = row * self.n_actions() + action as usize;
            let error = q[at] - y;
            derivative[at] = per_row * self.loss.gradient(error);
            loss += self.loss.value(error);
            sum_q += q[at];
        }
        (derivative, per_row * loss, per_row * sum_q)
    }

    /// Lets the target and the averaged network follow the step just taken.
    fn follow(&self) -> Result<()> {
        match self.target_network {
            TargetUpdate::Soft { tau } => self.target.move_towards(&self.online_view, tau as f32)?,
            TargetUpdate::Hard { every } if self.n_gradient_steps.is_multiple_of(every) => {
                self.target.move_towards(&self.online_view, 1.0)?;
            }
            TargetUpdate::Hard { .. } => {}
        }
        self.averaged.move_towards(&self.online_view, average_rate(self.average, self.n_gradient_steps) as f32)
    }

    fn check_finite(&self, what: &'static str, value: f32) -> std::result::Result<(), RlError> {
        if value.is_finite() {
            return Ok(());
        }
        Err(RlError::Diverged { gradient_step: self.n_gradient_steps + 1, what, value })
    }

    /// The averaged weights.
    pub(crate) fn layers(&self) -> Result<Vec<Layer>> {
        self.averaged.layers()
    }

    /// Puts the same weights into all three networks and forgets the moments.
    pub(crate) fn start_from(&mut self, layers: &[Layer]) -> Result<()> {
        for network in [&self.online, &self.target, &self.averaged] {
            network.assign(layers)?;
        }
        let zeros: Vec<Layer> = layers.iter().map(Layer::zeros_like).collect();
        self.adam.set_state(0, &zeros, &zeros)
    }

    pub(crate) fn state(&self) -> Result<LearnerState> {
        let (n_adam_steps, first_moments, second_moments) = self.adam.state()?;
        Ok(LearnerState {
            n_gradient_steps: self.n_gradient_steps,
            n_adam_steps,
            online: self.online_view.layers()?,
            target: self.target.layers()?,
            averaged: self.averaged.layers()?,
            first_moments,
            second_moments,
        })
    }

    pub(crate) fn set_state(&mut self, state: &LearnerState) -> Result<()> {
        self.online.assign(&state.online)?;
        self.target.assign(&state.target)?;
        self.averaged.assign(&state.averaged)?;
        self.adam.set_state(state.n_adam_steps, &state.first_moments, &state.second_moments)?;
        self.n_gradient_steps = state.n_gradient_steps;
        Ok(())
    }
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
