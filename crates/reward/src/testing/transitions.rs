use crate::{Event, Limits, State, Transition};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6, PI};

const EVENTS: [Option<Event>; 3] = [None, Some(Event::Collision), Some(Event::Reach)];

/// None, dead ahead, the paper's threshold and its two neighbours, abeam, behind.
const OBSTACLE_ANGLES: [Option<f64>; 7] = [
    None,
    Some(0.0),
    Some(FRAC_PI_6.next_down()),
    Some(FRAC_PI_6),
    Some(FRAC_PI_6.next_up()),
    Some(FRAC_PI_2),
    Some(PI),
];

/// Reverse, rest, crawling, the paper's desired speed, the small robot's top speed, a car's.
const SPEEDS: [f64; 6] = [-0.5, 0.0, 0.1, 1.2, 1.5, 15.0];

/// Overlap, contact, inside, at and outside the default margin of 0.2 m, nothing near.
const CLEARANCES: [f64; 6] = [-0.3, 0.0, 0.05, 0.2, 1.0, 30.0];

const GOAL_DISTANCES: [f64; 5] = [0.0, 0.4, 4.9, 5.0, 40.0];
const BEARINGS: [f64; 7] = [0.0, 0.3, -0.3, FRAC_PI_2, -FRAC_PI_2, -3.0, PI];
const YAW_RATES: [f64; 5] = [0.0, 0.4, -0.4, 1.5, -1.5];
const STEP_TIMES: [f64; 4] = [0.02, 0.1, 0.2, 1.0];

const LIMITS: [Limits; 2] = [
    Limits { max_speed: 1.5, max_yaw_rate: 1.5, max_acceleration: 2.0, max_yaw_acceleration: 6.0 },
    Limits { max_speed: 15.0, max_yaw_rate: 0.5, max_acceleration: 4.0, max_yaw_acceleration: 1.0 },
];

const AROUND: [f64; 6] = [-2.0 * FRAC_PI_3, -FRAC_PI_3, 0.0, FRAC_PI_3, 2.0 * FRAC_PI_3, PI];

/// A scan and its beams: no lidar, one beam, all clear, blocked ahead, on the left and right, all blocked.
const SCANS: [(&[f32], &[f64]); 6] = [
    (&[], &[]),
    (&[2.5], &[0.0]),
    (&[5.0; 6], &AROUND),
    (&[5.0, 5.0, 0.3, 5.0, 5.0, 5.0], &AROUND),
    (&[0.5, 0.3, 5.0, 0.4, 0.6, 5.0], &AROUND),
    (&[0.0; 6], &AROUND),
];

/// The transitions that [`check`](super::check) tries: always the same, in the same order, and varied.
///
/// Every event meets every obstacle angle (`None` and the paper's threshold of pi/6 among them), every speed (reverse,
/// rest and the top) and every clearance (negative ones too) at the end of the step. All else, such as goals, commands,
/// scans and step times, varies along. Not all of it could happen: a reward must be defined beyond what is likely.
pub fn transitions() -> Vec<Transition<'static>> {
    let mut choice = Choice(0);
    let mut cases = Vec::new();
    for event in EVENTS {
        for obstacle_angle in OBSTACLE_ANGLES {
            for speed in SPEEDS {
                for clearance in CLEARANCES {
                    let after = State { speed, clearance, obstacle_angle, ..choice.state() };
                    cases.push(choice.transition(after, event));
                }
            }
        }
    }
    cases
}

/// A fixed sequence of choices: a linear congruential generator (Knuth's MMIX), enough to mix lists.
struct Choice(u64);

impl Choice {
    fn of<T: Copy>(&mut self, list: &[T]) -> T {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        list[(self.0 >> 33) as usize % list.len()]
    }

    fn state(&mut self) -> State<'static> {
        let (scan, beam_angles) = self.of(&SCANS);
        State {
            speed: self.of(&SPEEDS),
            yaw_rate: self.of(&YAW_RATES),
            goal_distance: self.of(&GOAL_DISTANCES),
            goal_bearing: self.of(&BEARINGS),
            clearance: self.of(&CLEARANCES),
            obstacle_angle: self.of(&OBSTACLE_ANGLES),
            scan,
            beam_angles,
        }
    }

    /// A step that ends in `after`, seen by the same lidar throughout.
    fn transition(&mut self, after: State<'static>, event: Option<Event>) -> Transition<'static> {
        let same_lidar: Vec<_> = SCANS.into_iter().filter(|(scan, _)| scan.len() == after.scan.len()).collect();
        let (scan, beam_angles) = self.of(&same_lidar);
        let before = State { scan, beam_angles, ..self.state() };
        Transition {
            before,
            after,
            command_speed: self.of(&SPEEDS),
            command_yaw_rate: self.of(&YAW_RATES),
            dt: self.of(&STEP_TIMES),
            event,
            limits: self.of(&LIMITS),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_always_the_same() {
        assert_eq!(transitions(), transitions());
    }

    #[test]
    fn every_event_meets_every_angle_speed_and_clearance() {
        assert_eq!(transitions().len(), 3 * 7 * 6 * 6);
    }

    /// Each list's values occur, on both sides of the step where there are two.
    #[test]
    fn all_else_varies_along() {
        let cases = transitions();
        let occurs = |matches: &dyn Fn(&Transition<'_>) -> bool| cases.iter().any(matches);
        for distance in GOAL_DISTANCES {
            assert!(occurs(&|t| t.before.goal_distance == distance));
            assert!(occurs(&|t| t.after.goal_distance == distance));
        }
        for bearing in BEARINGS {
            assert!(occurs(&|t| t.after.goal_bearing == bearing));
        }
        for (speed, dt) in SPEEDS.into_iter().zip(STEP_TIMES) {
            assert!(occurs(&|t| t.before.speed == speed && t.dt == dt));
        }
        for (scan, _) in SCANS {
            assert!(occurs(&|t| t.before.scan == scan));
            assert!(occurs(&|t| t.after.scan == scan));
        }
    }

    #[test]
    fn a_lidar_stays_the_same_over_a_step() {
        for t in transitions() {
            assert_eq!(t.before.beam_angles, t.after.beam_angles);
            assert_eq!(t.after.scan.len(), t.after.beam_angles.len());
        }
    }
}
