//! Means over seeds with bands, as curves show them.

use headway_stats::{Bootstrap, Estimate, over_units};

/// Resamples behind each point of a band: it is drawn, not read off.
pub(super) const N_RESAMPLES: usize = 2000;

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
    let Estimate { mean, low, high, n } = over_units(values.iter().copied().map(Some), &resampling());
    mean.map(|y| Point { x, y, band: low.zip(high), n })
}
