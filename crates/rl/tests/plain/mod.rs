//! DQN and Double DQN in candle's own layers, operations and optimiser, as its documentation would have one write it: the oracle
//! of a test and the rival of a bench.

use candle_core::{D, Device, Result, Tensor, Var};
use candle_nn::{AdamW, Linear, Module, Optimizer, ParamsAdamW};
use headway_rl::{Layer, TargetRule};

/// One learner with Huber loss (delta 1), Adam and a softly following target network.
pub(crate) struct Plain {
    rule: TargetRule,
    vars: Vec<Var>,
    online: Vec<Linear>,
    target: Vec<Linear>,
    adam: AdamW,
    tau: f64,
}

/// A minibatch of `n` transitions, row-major.
pub(crate) struct Batch {
    /// `[n, obs_dim]`.
    pub(crate) obs: Tensor,
    /// `[n, 1]`.
    pub(crate) actions: Tensor,
    /// `[n]`.
    pub(crate) returns: Tensor,
    /// `[n, obs_dim]`.
    pub(crate) next_obs: Tensor,
    /// `[n]`.
    pub(crate) discounts: Tensor,
}

impl Batch {
    pub(crate) fn new(
        obs: &[f32],
        actions: &[u32],
        returns: &[f32],
        next_obs: &[f32],
        discounts: &[f32],
    ) -> Result<Self> {
        let (n, cpu) = (actions.len(), &Device::Cpu);
        let shape = (n, obs.len() / n);
        Ok(Self {
            obs: Tensor::from_slice(obs, shape, cpu)?,
            actions: Tensor::from_slice(actions, (n, 1), cpu)?,
            returns: Tensor::from_slice(returns, n, cpu)?,
            next_obs: Tensor::from_slice(next_obs, shape, cpu)?,
            discounts: Tensor::from_slice(discounts, n, cpu)?,
        })
    }
}

impl Plain {
    pub(crate) fn new(rule: TargetRule, layers: &[Layer], learning_rate: f64, tau: f64) -> Result<Self> {
        let (mut vars, mut online, mut target) = (Vec::new(), Vec::new(), Vec::new());
        for layer in layers {
            let n_out = layer.bias.len();
            let w = Var::from_slice(&layer.weight, (n_out, layer.weight.len() / n_out), &Device::Cpu)?;
            let b = Var::from_slice(&layer.bias, n_out, &Device::Cpu)?;
            online.push(Linear::new(w.as_tensor().clone(), Some(b.as_tensor().clone())));
            target.push(Linear::new(w.copy()?.detach(), Some(b.copy()?.detach())));
            vars.extend([w, b]);
        }
        let params = ParamsAdamW { lr: learning_rate, weight_decay: 0.0, ..ParamsAdamW::default() };
        let adam = AdamW::new(vars.clone(), params)?;
        Ok(Self { rule, vars, online, target, adam, tau })
    }

    /// One gradient step; the loss before it.
    pub(crate) fn step(&mut self, batch: &Batch) -> Result<Tensor> {
        let next = forward(&self.target, &batch.next_obs)?;
        let next = match self.rule {
            TargetRule::Dqn => next.max(D::Minus1)?,
            TargetRule::DoubleDqn => {
                let best = forward(&self.online, &batch.next_obs)?.detach().argmax_keepdim(D::Minus1)?;
                next.gather(&best, 1)?.squeeze(1)?
            }
        };
        let targets = (&batch.returns + (&batch.discounts * next)?)?.detach();
        let q = forward(&self.online, &batch.obs)?.gather(&batch.actions, 1)?.squeeze(1)?;
        let error = (q - targets)?;
        // Huber: half the square of what lies within 1, and linear beyond.
        let within = error.abs()?.minimum(1.0)?;
        let loss = ((within.sqr()? * 0.5)? + (error.abs()? - &within)?)?.mean_all()?;
        self.adam.backward_step(&loss)?;
        let pairs = self.vars.chunks(2).zip(&mut self.target);
        for (vars, target) in pairs {
            let follow = |old: &Tensor, new: &Var| (old * (1.0 - self.tau))? + (new.as_detached_tensor() * self.tau)?;
            let w = follow(target.weight(), &vars[0])?;
            let b = follow(target.bias().expect("every layer has a bias"), &vars[1])?;
            *target = Linear::new(w, Some(b));
        }
        Ok(loss)
    }
}

fn forward(layers: &[Linear], obs: &Tensor) -> Result<Tensor> {
    let mut x = obs.clone();
    for (index, layer) in layers.iter().enumerate() {
        x = layer.forward(&x)?;
        if index + 1 < layers.len() {
            x = x.relu()?;
        }
    }
    Ok(x)
}
