//! What a driver is paid, step by step, for ever.

use serde::Serialize;

/// What a driver is paid: a beginning, and then a cycle that repeats for ever, or nothing more.
///
/// ```
/// use headway_experiments::audit::Payments;
/// let parked = Payments { start: vec![], cycle: vec![10.0] };
/// assert!((parked.discounted(0.95) - 200.0).abs() < 1e-9); // 10 / (1 - gamma)
/// let arrived = Payments { start: vec![10.0, 100.0], cycle: vec![] };
/// assert_eq!(arrived.discounted(0.5), 60.0);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Payments {
    /// The pay of the first steps.
    pub start: Vec<f64>,
    /// The pay of the steps that repeat for ever; empty where the episode has ended.
    pub cycle: Vec<f64>,
}

impl Payments {
    /// The discounted return at the start, `sum over k of gamma^k r_k`, with k steps of `start` and n of the cycle:
    ///
    /// ```text
    /// G = sum_{i < k} gamma^i start_i + gamma^k / (1 - gamma^n) sum_{i < n} gamma^i cycle_i
    /// ```
    ///
    /// `gamma` is per step, from 0 to 1. At 1, where the series may have no sum, it is infinite, with the sign of what a
    /// cycle pays; a cycle that pays nothing in all counts 0.
    pub fn discounted(&self, gamma: f64) -> f64 {
        let start = horner(&self.start, gamma);
        if self.cycle.is_empty() {
            return start;
        }
        let cycle = horner(&self.cycle, gamma);
        if gamma < 1.0 {
            let (k, n) = (self.start.len() as f64, self.cycle.len() as f64);
            // 1 - gamma^n, exact where gamma is near 1.
            return start + gamma.powf(k) * cycle / -(n * gamma.ln()).exp_m1();
        }
        let size: f64 = self.cycle.iter().map(|pay| pay.abs()).sum();
        if cycle.abs() <= 1e-9 * size { start } else { f64::INFINITY.copysign(cycle) }
    }

    /// Whether this has a greater return than `other` at a gamma below 1, be it by ever so little: what the two have in
    /// common at the beginning is left aside, and with it the discount that would hide the rest.
    pub fn exceeds(&self, other: &Self, gamma: f64) -> bool {
        // Two cycles that agree for as long as both take together agree for ever.
        let n_steps = self.start.len().max(other.start.len()) + self.cycle.len() + other.cycle.len();
        let differs = |i: &usize| !is_same(self.at(*i), other.at(*i));
        let Some(first) = (0..n_steps).find(differs) else { return false };
        let (mut sum, mut size, mut factor) = (0.0, 0.0, 1.0);
        for i in first..n_steps {
            let (own, others) = (self.at(i), other.at(i));
            sum += factor * (own - others);
            size += factor * (own.abs() + others.abs());
            factor *= gamma;
            if factor < NEGLIGIBLE {
                break;
            }
        }
        let (own, others) = (self.from(n_steps, gamma), other.from(n_steps, gamma));
        sum += factor * (own - others);
        size += factor * (own.abs() + others.abs());
        sum > SAME * size
    }

    /// The pay of step `i`.
    fn at(&self, i: usize) -> f64 {
        let n = self.cycle.len();
        match i.checked_sub(self.start.len()) {
            None => self.start[i],
            Some(_) if n == 0 => 0.0,
            Some(later) => self.cycle[later % n],
        }
    }

    /// The return of what is left at step `i` of the cycle or after the end.
    fn from(&self, i: usize, gamma: f64) -> f64 {
        if self.cycle.is_empty() {
            return 0.0;
        }
        let mut cycle = self.cycle.clone();
        cycle.rotate_left((i - self.start.len()) % self.cycle.len());
        Self { start: Vec::new(), cycle }.discounted(gamma)
    }

    /// The mean pay of a step: of the cycle, or of the whole way to the end.
    pub fn per_step(&self) -> f64 {
        let steps = if self.cycle.is_empty() { &self.start } else { &self.cycle };
        steps.iter().sum::<f64>() / steps.len().max(1) as f64
    }
}

/// Pays, and sums of them, that differ by less than this part of their size are the same: simulated steps settle as nearly.
const SAME: f64 = 1e-8;
/// A discount that hides what it is applied to.
const NEGLIGIBLE: f64 = 1e-20;

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * (a.abs() + b.abs())
}

/// `sum_i x^i numbers_i`.
fn horner(numbers: &[f64], x: f64) -> f64 {
    numbers.iter().rev().fold(0.0, |sum, number| sum * x + number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_is_the_limit_of_repeating_it() {
        let payments = Payments { start: vec![3.0, -1.0], cycle: vec![5.0, 0.0, -2.0] };
        for gamma in [0.0_f64, 0.3, 0.9, 0.99] {
            let slow = |n: usize| -> f64 {
                let cycle = payments.cycle.iter().cycle();
                payments.start.iter().chain(cycle).take(n).enumerate().map(|(k, pay)| gamma.powi(k as i32) * pay).sum()
            };
            assert!((payments.discounted(gamma) - slow(5000)).abs() < 1e-9, "{gamma}");
        }
    }

    #[test]
    fn what_differs_late_is_compared_at_every_discount() {
        let alive = Payments { start: vec![], cycle: vec![10.0] };
        let arrived = |n: usize| Payments { start: [vec![10.0; n - 1], vec![100.0]].concat(), cycle: vec![] };
        let again = Payments { start: vec![], cycle: [vec![10.0; 39], vec![11.0]].concat() };
        for gamma in [0.01, 0.5, 0.8999, 0.9001, 0.999] {
            // 10 / (1 - gamma) against 100, whenever that is paid.
            assert_eq!(alive.exceeds(&arrived(200), gamma), gamma > 0.9);
            assert_eq!(arrived(200).exceeds(&alive, gamma), gamma < 0.9);
            assert!(again.exceeds(&alive, gamma) && !alive.exceeds(&again, gamma));
            assert!(!alive.exceeds(&alive, gamma) && !again.exceeds(&again, gamma));
        }
    }

    #[test]
    fn without_discounting_what_goes_on_for_ever_is_infinite() {
        let of = |cycle: &[f64]| Payments { start: vec![1.0], cycle: cycle.to_vec() }.discounted(1.0);
        assert_eq!(of(&[]), 1.0);
        assert_eq!(of(&[0.5]), f64::INFINITY);
        assert_eq!(of(&[0.5, -1.0]), f64::NEG_INFINITY);
        assert_eq!(of(&[0.5, -0.5]), 1.0);
    }

    #[test]
    fn the_mean_is_that_of_the_cycle_or_of_the_whole_way() {
        assert_eq!(Payments { start: vec![9.0], cycle: vec![1.0, 2.0] }.per_step(), 1.5);
        assert_eq!(Payments { start: vec![9.0, 1.0], cycle: vec![] }.per_step(), 5.0);
    }
}
