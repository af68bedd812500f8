//! What a network does with some observations: the figures in which a collapse shows.

use crate::network::Network;
use crate::target::argmax;

/// What the averaged network, by which an agent acts greedily, does with some observations.
///
/// A healthy network tells observations apart: it chooses several actions, keeps its units alive, and its values stay within
/// what rewards can add up to.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Entropy of how often each action is the greedy one, `-sum_a p_a ln p_a / ln n_actions`, in \[0, 1\]: 0 if it is always
    /// the same one, 1 if all are chosen alike. 1 where there is one action only.
    pub action_entropy: f64,
    /// Of each hidden layer the share of units whose ReLU is closed for every one of the observations, in \[0, 1\].
    pub dead_units: Vec<f64>,
    /// The greatest `|Q(s, a)|` of any of the observations and actions, in scaled reward.
    pub max_abs_q: f32,
}

impl Probe {
    /// The figures of `n` observations, one or more, from their activations.
    pub(crate) fn of(network: &Network, activations: &[f32], n: usize) -> Self {
        let hidden = network.layers.iter().filter(|layer| !layer.is_last);
        let dead_units = hidden.map(|layer| dead_share(layer.split(activations, n).1, layer.n_out)).collect();
        let mut counts = vec![0; network.n_actions()];
        network.q_rows(activations, n).for_each(|q| counts[argmax(q)] += 1);
        let max_abs_q = network.q(activations, n).iter().fold(0.0, |max: f32, q| max.max(q.abs()));
        Self { action_entropy: entropy(&counts), dead_units, max_abs_q }
    }
}

/// The share of the columns of `rows` that are 0 throughout.
fn dead_share(rows: &[f32], n_columns: usize) -> f64 {
    let mut is_alive = vec![false; n_columns];
    for row in rows.chunks_exact(n_columns) {
        is_alive.iter_mut().zip(row).for_each(|(alive, y)| *alive |= *y > 0.0);
    }
    is_alive.iter().filter(|alive| !**alive).count() as f64 / n_columns as f64
}

/// The entropy of frequencies, in units of that of equal ones.
fn entropy(counts: &[u32]) -> f64 {
    if counts.len() == 1 {
        return 1.0;
    }
    let n = f64::from(counts.iter().sum::<u32>());
    let shares = counts.iter().filter(|count| **count > 0).map(|count| f64::from(*count) / n);
    shares.map(|p| p * (1.0 / p).ln()).sum::<f64>() / (counts.len() as f64).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Agent, DqnSpec, Layer, Mode};

    #[test]
    fn entropy_of_frequencies() {
        assert_eq!(entropy(&[7, 0, 0]), 0.0);
        assert!((entropy(&[5, 5, 5, 5]) - 1.0).abs() < 1e-12);
        assert!((entropy(&[3, 3, 0, 0]) - 0.5).abs() < 1e-12); // ln 2 / ln 4
        assert_eq!(entropy(&[9]), 1.0);
    }

    /// Two inputs, hidden layers of two and three units, two actions.
    #[test]
    fn a_network_by_hand() {
        let spec = DqnSpec { hidden: vec![2, 3], ..DqnSpec::default() };
        let mut agent = spec.build(2, 2, 1, 1, 0).unwrap();
        let layers = [
            Layer { weight: vec![1.0, 0.0, -1.0, 0.0], bias: vec![0.0, 0.0] }, // x and -x of the first input
            Layer { weight: vec![1.0, 0.0, 0.0, 1.0, 0.0, 0.0], bias: vec![0.0, 0.0, -1.0] }, // the third is always closed
            Layer { weight: vec![2.0, 0.0, 5.0, 0.0, 3.0, 5.0], bias: vec![0.0, -0.5] },
        ];
        agent.start_from(&layers).unwrap();
        // x = 1, 2: Q = (2 x, -0.5). x = -1: Q = (0, 3 - 0.5).
        let probe = agent.probe(&[1.0, 9.0, 2.0, 9.0, -1.0, 9.0, -1.0, 9.0]).unwrap().unwrap();
        assert_eq!((probe.max_abs_q, probe.dead_units), (4.0, vec![0.0, 1.0 / 3.0]));
        assert!((probe.action_entropy - 1.0).abs() < 1e-12);
        // Of positive inputs alone, the units of -x are dead too.
        let probe = agent.probe(&[1.0, 9.0, 2.0, 9.0]).unwrap().unwrap();
        assert_eq!((probe.action_entropy, probe.dead_units), (0.0, vec![0.5, 2.0 / 3.0]));
        assert_eq!(agent.probe(&[]).unwrap(), None);
        assert!(agent.probe(&[1.0; 3]).is_err());
    }

    #[test]
    fn it_asks_the_weights_that_act_greedily() {
        let agent = DqnSpec::default().build(2, 3, 1, 1, 5).unwrap();
        let obs: Vec<f32> = (0..200).map(|i| (i as f32 * 0.7).sin()).collect();
        let (mut actions, q) = (vec![0; 100], agent.q_values(&obs).unwrap());
        let probe = agent.probe(&obs).unwrap().unwrap();
        let mut agent = agent;
        agent.act(&obs, Mode::Greedy, &mut actions).unwrap();
        let counts = [0, 1, 2].map(|action| actions.iter().filter(|a| **a == action).count() as u32);
        assert_eq!(probe.action_entropy, entropy(&counts));
        assert_eq!(probe.max_abs_q, q.iter().fold(0.0, |max, q| q.abs().max(max)));
    }
}
