//! When a run begins to count, and how it ends.

use headway_env::{Event, StepEnd};
use headway_planning::Interventions;

use super::{CLOCK_DISTANCE, Run, TIME_LIMIT};
use crate::episode::Outcome;

/// The protocol's clock.
#[derive(Debug, Default)]
pub(super) struct Clock {
    is_running: bool,
    /// Since it began to run, or before that, since the vehicle was placed.
    time: f64,
}

impl Clock {
    /// Goes on by a step that ended at some distance from the start; the run, if that was its end, without interventions.
    pub(super) fn step(&mut self, duration: f64, from_start: f64, end: &StepEnd) -> Option<Run> {
        /// Times are sums of control periods: this much apart, they are the same.
        const SAME_TIME: f64 = 1e-6;
        self.time += duration;
        if !self.is_running && from_start >= CLOCK_DISTANCE {
            (self.is_running, self.time) = (true, 0.0);
        }
        let outcome = match end.event {
            Some(Event::Collision) => Outcome::Collision,
            Some(Event::Reach) => Outcome::Success,
            None if self.time > TIME_LIMIT - SAME_TIME || end.truncated => Outcome::Timeout,
            None => return None,
        };
        let time = if self.is_running { self.time } else { 0.0 };
        Some(Run { outcome, time, interventions: Interventions::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ON: StepEnd = StepEnd { reward: 0.0, event: None, terminated: false, truncated: false };

    fn run(outcome: Outcome, time: f64) -> Run {
        Run { outcome, time, interventions: Interventions::default() }
    }

    #[test]
    fn the_clock_starts_when_the_vehicle_has_moved() {
        let mut clock = Clock::default();
        assert_eq!(clock.step(7.0, 0.05, &ON), None);
        assert_eq!(clock.step(1.0, 0.1, &ON), None);
        assert_eq!(clock.step(2.0, 0.05, &ON), None, "it goes on");
        let reached = StepEnd { event: Some(Event::Reach), ..ON };
        assert_eq!(clock.step(0.5, 9.0, &reached), Some(run(Outcome::Success, 2.5)));
    }

    #[test]
    fn a_vehicle_that_never_moves_times_out_and_one_that_does_has_all_its_time() {
        let mut clock = Clock::default();
        assert_eq!(clock.step(99.9, 0.0, &ON), None);
        assert_eq!(clock.step(0.1, 0.0, &ON), Some(run(Outcome::Timeout, 0.0)));
        let mut clock = Clock::default();
        assert_eq!(clock.step(99.0, 0.2, &ON), None);
        assert_eq!(clock.step(99.9, 5.0, &ON), None);
        assert_eq!(clock.step(0.1, 5.0, &ON), Some(run(Outcome::Timeout, 100.0)));
    }
}
