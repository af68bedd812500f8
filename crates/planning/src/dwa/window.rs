//! The speeds and yaw rates that can be reached.

use headway_sim::{Command, Twist, VehicleSpec};

use super::DwaSpec;

/// What a vehicle can reach within a control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DynamicWindow {
    pub(super) speed: [f64; 2],
    pub(super) yaw_rate: [f64; 2],
    /// Whether a turn on the spot is within reach.
    can_turn: bool,
}

impl DynamicWindow {
    pub(super) fn new(spec: &DwaSpec, vehicle: &VehicleSpec, twist: &Twist) -> Self {
        let period = vehicle.control_period;
        let change = spec.max_acceleration.min(vehicle.max_acceleration) * period;
        let yaw_change = spec.max_yaw_acceleration.min(vehicle.max_yaw_acceleration) * period;
        let most = spec.max_speed.min(vehicle.max_speed);
        let least = spec.min_speed.min(most);
        let most_yaw = spec.max_yaw_rate.min(vehicle.max_yaw_rate);
        let speed = [twist.x - change, twist.x + change].map(|v| v.clamp(least, most));
        let yaw_rate = [twist.z - yaw_change, twist.z + yaw_change].map(|w| w.clamp(-most_yaw, most_yaw));
        Self { speed, yaw_rate, can_turn: twist.x - change <= least }
    }

    /// Forward arcs, the slowest first, straight on first among those of a speed.
    pub(super) fn arcs(self, spec: &DwaSpec) -> impl Iterator<Item = Command> {
        let is_straight_within = self.yaw_rate[0] <= 0.0 && self.yaw_rate[1] >= 0.0;
        let (n_speeds, n_yaw_rates) = (spec.n_speeds, spec.n_yaw_rates);
        samples(self.speed, n_speeds).flat_map(move |speed| {
            let straight = is_straight_within.then_some(0.0).into_iter();
            straight.chain(samples(self.yaw_rate, n_yaw_rates)).map(move |yaw_rate| Command::new(speed, yaw_rate))
        })
    }

    /// Turns on the spot, none of them slower than `min_turn_rate`.
    pub(super) fn turns(self, spec: &DwaSpec) -> impl Iterator<Item = Command> {
        let least = spec.min_turn_rate;
        let n = if self.can_turn { spec.n_yaw_rates } else { 0 };
        let rates = samples(self.yaw_rate, n).filter(|rate| *rate != 0.0);
        rates.map(move |rate| Command::new(0.0, rate.abs().max(least).copysign(rate)))
    }
}

/// Evenly spaced, both ends included; the higher end alone if there is but one.
fn samples([low, high]: [f64; 2], n: usize) -> impl Iterator<Item = f64> {
    (0..n).map(move |k| if k + 1 == n { high } else { low + (high - low) * (k as f64 / (n - 1) as f64) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(speed: f64, yaw_rate: f64) -> DynamicWindow {
        let vehicle = VehicleSpec {
            control_period: 0.1,
            max_acceleration: 1.0,
            max_yaw_acceleration: 5.0,
            max_yaw_rate: 1.2,
            ..VehicleSpec::default()
        };
        DynamicWindow::new(&DwaSpec::default(), &vehicle, &Twist::new(speed, 0.0, yaw_rate))
    }

    #[test]
    fn windows_by_hand() {
        let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12;
        let middle = window(0.3, 0.2);
        assert!(near(middle.speed, [0.2, 0.4]) && near(middle.yaw_rate, [-0.3, 0.7]) && !middle.can_turn);
        let fast = window(0.45, 1.0);
        assert!(near(fast.speed, [0.35, 0.5]) && near(fast.yaw_rate, [0.5, 1.2]));
        let still = window(0.0, 0.0);
        assert!(near(still.speed, [0.1, 0.1]) && near(still.yaw_rate, [-0.5, 0.5]) && still.can_turn);
        // Too fast already: what comes nearest.
        assert!(near(window(2.0, 0.0).speed, [0.5, 0.5]));
    }

    #[test]
    fn samples_by_hand() {
        let spec = DwaSpec { n_speeds: 3, n_yaw_rates: 2, ..DwaSpec::default() };
        let arcs: Vec<_> = window(0.3, 0.2).arcs(&spec).map(|c| (c.speed, c.yaw_rate)).collect();
        assert_eq!(arcs.len(), 9);
        assert!((arcs[4].0 - 0.3).abs() < 1e-12 && (arcs[4].1 + 0.3).abs() < 1e-12 && arcs[3].1 == 0.0);
        assert_eq!(window(0.3, 1.0).arcs(&spec).count(), 6);
        let spec = DwaSpec { n_yaw_rates: 5, ..spec };
        let turns: Vec<_> = window(0.0, 0.0).turns(&spec).map(|c| c.yaw_rate).collect();
        assert_eq!(turns, [-0.5, -0.314, 0.314, 0.5]);
        assert_eq!(window(0.3, 0.0).turns(&spec).count(), 0);
    }
}
