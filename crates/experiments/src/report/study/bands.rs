//! Means over seeds with bands, as curves show them.

use headway_stats::{Bootstrap, Interval, bootstrap};

/// Resamples behind each point of a band: it is drawn, not read off.
pub(super) const N_RESAMPLES: usize = 2000;
/// Fewest units for which there is a band.
pub(super) const MIN_UNITS: usize = 3;

/// A point of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub(crate) x: f64,
    /// The mean over the units.
    pub(crate) y: f64,
    /// Its 95 % interval, low and high, if there are enough units.
    pub(crate) band: Option<(f64, f64)>,
    /// Number of units.
    pub(crate) n: usize,
}

/// How bands are resampled.
pub(super) fn resampling() -> Bootstrap {
    Bootstrap::new(N_RESAMPLES, 0).expect("a positive number")
}

/// The mean of one value per unit, with the percentile bootstrap interval over the units; `None` without a value.
pub(super) fn mean_with_band(x: f64, values: &[f64]) -> Option<Point> {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (y, n) = (mean(values), values.len());
    let is_enough = n >= MIN_UNITS;
    let band = is_enough.then(|| bootstrap(values, mean, &resampling()).ok().map(Interval::ends)).flatten();
    (n > 0).then_some(Point { x, y, band, n })
}
