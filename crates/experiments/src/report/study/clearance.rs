//! Speed against clearance: how fast policies are where there is how much room.

use headway_env::Navigator;

use super::bands::{Point, mean_with_band};

/// Episodes of every run and world that are driven again for it: the first ones.
pub(crate) const N_EPISODES: usize = 40;
/// Width of a bin of clearances, m.
const BIN: f64 = 0.1;
/// Number of bins; what is farther off is left out.
const N_BINS: usize = 20;
/// Time that a run must spend in a bin to count in it, s.
const MIN_TIME: f64 = 1.0;

/// The time that one run spends at each clearance, and the distance it drives meanwhile.
#[derive(Debug, Clone, Default)]
pub(super) struct Meter {
    /// Time (s) and distance (m) by bin.
    bins: [(f64, f64); N_BINS],
}

impl Meter {
    /// Adds the step that led to this state, at the clearance that it began with; nothing where it is the start.
    pub(super) fn push(&mut self, vehicle: &Navigator, is_start: bool) {
        if !is_start {
            let clearance = vehicle.transition().before.clearance;
            self.add(clearance, vehicle.step_duration(), vehicle.step_distance());
        }
    }

    fn add(&mut self, clearance: f64, duration: f64, distance: f64) {
        // A step of a collision may begin a hair within the obstacle.
        if let Some(bin) = self.bins.get_mut((clearance.max(0.0) / BIN) as usize) {
            *bin = (bin.0 + duration, bin.1 + distance);
        }
    }
}

/// The speed at each clearance over runs: where at least half of them spent a second or more.
pub(super) fn curve(runs: &[Meter]) -> Vec<Point> {
    let point = |bin: usize| {
        let counts = runs.iter().map(|run| run.bins[bin]).filter(|(time, _)| *time >= MIN_TIME);
        let speeds: Vec<f64> = counts.map(|(time, distance)| distance / time).collect();
        let is_enough = 2 * speeds.len() >= runs.len();
        is_enough.then(|| mean_with_band((bin as f64 + 0.5) * BIN, &speeds)).flatten()
    };
    (0..N_BINS).filter_map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let run = |speed: f64| {
            let mut meter = Meter::default();
            meter.add(0.25, 2.0, 2.0 * speed);
            meter.add(0.29, 1.0, speed);
            meter.add(-1e-9, 0.5, 0.1); // too short a time
            meter.add(7.0, 9.0, 9.0); // too far
            meter
        };
        let mut other = Meter::default();
        other.add(0.25, 4.0, 2.0);
        let curve = curve(&[run(1.0), run(0.6), other]);
        assert_eq!(curve.len(), 1);
        assert!((curve[0].x - 0.25).abs() < 1e-12 && (curve[0].y - 0.7).abs() < 1e-12 && curve[0].n == 3);
    }
}
