//! From values to pixels, and the round values to label.

/// A linear scale from a range of values to a range of pixels, which may run backwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    values: [f64; 2],
    pixels: [f64; 2],
}

impl Scale {
    /// A scale that takes `values` to `pixels`; the values differ.
    pub(crate) fn new(values: [f64; 2], pixels: [f64; 2]) -> Self {
        Self { values, pixels }
    }

    pub(crate) fn pixel(&self, value: f64) -> f64 {
        let ([low, high], [from, to]) = (self.values, self.pixels);
        from + (value - low) / (high - low) * (to - from)
    }

    /// The pixels of its two ends.
    pub(crate) fn ends(&self) -> [f64; 2] {
        self.pixels
    }

    /// About `n` round values on the scale, at least two, with their labels.
    pub(crate) fn ticks(&self, n: usize) -> Vec<(f64, String)> {
        let [low, high] = self.values;
        let slack = 1e-9 * (high - low);
        let multiples = |step: f64| ((low - slack) / step).ceil() as i64..=((high + slack) / step).floor() as i64;
        let first = round_step((high - low) / n as f64);
        // A third of the length holds two multiples or more.
        let finer = [first, round_step(first / 2.5), round_step(first / 5.0)];
        let step = finer.into_iter().find(|step| multiples(*step).count() >= 2).unwrap_or(first);
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        multiples(step).map(|k| (k as f64 * step, format!("{:.decimals$}", k as f64 * step))).collect()
    }
}

/// The next of ..., 0.1, 0.2, 0.5, 1, 2, 5, 10, ... that is no smaller.
pub(crate) fn round_step(step: f64) -> f64 {
    let power = 10_f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= step * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// The upper end of an axis from zero to at least `value`, a little above it and a round number; 1 for zero.
pub(crate) fn round_top(value: f64) -> f64 {
    if value <= 0.0 {
        return 1.0;
    }
    let step = round_step(value / 5.0) / 2.0;
    (value / step - 1e-9).ceil() * step
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(values: [f64; 2], n: usize) -> Vec<String> {
        Scale::new(values, [0.0, 1.0]).ticks(n).into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels([0.0, 15.0], 4), ["0", "5", "10", "15"]);
        assert_eq!(labels([0.0, 1.5], 4), ["0.0", "0.5", "1.0", "1.5"]);
        assert_eq!(labels([0.0, 0.3], 3), ["0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels([-0.2, 1.0], 5), ["0.0", "0.5", "1.0"]);
        assert_eq!(labels([0.0, 8.66], 5), ["0", "2", "4", "6", "8"]);
        assert_eq!(labels([0.25, 1.35], 2), ["0.5", "1.0"]); // of 1 m/s alone no distance can be read
        assert_eq!(labels([1.01, 1.19], 1), ["1.05", "1.10", "1.15"]);
    }

    #[test]
    fn a_scale_may_run_backwards() {
        let scale = Scale::new([0.0, 10.0], [300.0, 100.0]);
        assert_eq!([scale.pixel(0.0), scale.pixel(2.5), scale.pixel(10.0)], [300.0, 250.0, 100.0]);
    }

    #[test]
    fn tops_are_round_and_near() {
        for (value, top) in [(0.0, 1.0), (1.5, 1.5), (1.2, 1.25), (1.93, 2.0), (0.43, 0.45)] {
            assert!((round_top(value) - top).abs() < 1e-9, "{value} gave {}", round_top(value));
        }
    }
}
