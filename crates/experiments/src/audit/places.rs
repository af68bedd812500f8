//! What the pay of a step depends on: the speed, or the place.

use headway_sim::{Command, Point};
use serde::Serialize;

use super::ride::{DISC_RADIUS, Ride};
use super::scene::Scene;
use crate::Error;

/// The speeds that are compared: from half of v_bar to half as much again, within what the agent can ask for.
const RANGE: [f64; 2] = [0.5, 1.5];
const N_SPEEDS: usize = 11;
/// Clearance of the obstacle beside and of the one ahead, metres; or half the radius within which obstacles have an angle.
const BESIDE: f64 = 0.5;
const AHEAD: f64 = 1.0;
/// A speed term is too flat to learn if it moves the pay of a step by less than this part of what the place moves it by: a rule
/// of thumb. Where the vehicle is differs from step to step and the speed hardly does, so that the place is what a learner sees.
const FLAT_BESIDE_PLACE: f64 = 0.2;
/// Or by less than this part of the pay itself, which is what the learner's errors are measured in.
const FLAT_BESIDE_PAY: f64 = 0.01;

/// A standard situation: straight on at a steady speed, towards the goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// Nothing is near.
    Open,
    /// An obstacle is abeam.
    Beside,
    /// An obstacle is straight ahead.
    Front,
}

impl Place {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Open, Self::Beside, Self::Front];

    /// In words, as in "10.0 in the open".
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Open => "in the open",
            Self::Beside => "beside an obstacle",
            Self::Front => "in front of one",
        }
    }
}

/// How the pay of a step depends on the speed, and how on the place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpeedTerm {
    /// The lowest and the highest speed that are compared, m/s.
    pub speeds: [f64; 2],
    /// The most by which the speed changes the pay of a step, in any one place.
    pub by_speed: f64,
    /// The most by which the place changes it, at v_bar.
    pub by_place: f64,
    /// v_bar, m/s.
    pub desired_speed: f64,
    /// What a step pays at v_bar in each place.
    pub at_desired_speed: Vec<(Place, f64)>,
    /// What to think of that.
    pub verdict: SpeedVerdict,
}

/// Whether a learner can be expected to see the speed in what a step pays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SpeedVerdict {
    /// A step pays the same at every speed.
    None,
    /// The speed changes the pay by less than a fifth of what the place does, or by less than a hundredth of the pay.
    Flat,
    /// It changes it by more.
    Clear,
}

impl SpeedTerm {
    pub(super) fn of(scene: &Scene<'_>) -> Result<Self, Error> {
        let (desired, [lowest, highest]) = (scene.case.desired_speed(), scene.case.speeds);
        let speeds = RANGE.map(|part| (part * desired).clamp(lowest.max(1e-3 * highest), highest));
        let (mut by_speed, mut most) = (0.0_f64, 0.0_f64);
        let mut at_desired_speed = Vec::new();
        for place in Place::ALL {
            let Some(pay) = pay_at(scene, desired, place)? else { continue };
            at_desired_speed.push((place, pay));
            let mut pays = vec![pay];
            for k in 0..N_SPEEDS {
                let speed = speeds[0] + (speeds[1] - speeds[0]) * k as f64 / (N_SPEEDS - 1) as f64;
                pays.extend(pay_at(scene, speed, place)?);
            }
            by_speed = by_speed.max(spread(&pays));
            most = pays.iter().fold(most, |most, pay| most.max(pay.abs()));
        }
        let pays: Vec<f64> = at_desired_speed.iter().map(|(_, pay)| *pay).collect();
        let by_place = spread(&pays);
        let verdict = judge(by_speed, by_place, most);
        Ok(Self { speeds, by_speed, by_place, desired_speed: desired, at_desired_speed, verdict })
    }
}

/// How far the greatest of some pays is above the least; 0 of none.
fn spread(pays: &[f64]) -> f64 {
    let [least, most] =
        pays.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], pay| [least.min(*pay), most.max(*pay)]);
    (most - least).max(0.0)
}

fn judge(by_speed: f64, by_place: f64, most: f64) -> SpeedVerdict {
    if by_speed <= 1e-9 * most {
        SpeedVerdict::None
    } else if by_speed < FLAT_BESIDE_PLACE * by_place || by_speed < FLAT_BESIDE_PAY * most {
        SpeedVerdict::Flat
    } else {
        SpeedVerdict::Clear
    }
}

/// What a step at a steady speed pays that ends in a place; none if the vehicle does not come to that speed.
fn pay_at(scene: &Scene<'_>, speed: f64, place: Place) -> Result<Option<f64>, Error> {
    let Some((n_steps, distance)) = scene.run_up(speed)? else { return Ok(None) };
    let end = distance + speed * scene.case.vehicle.control_period;
    let touching = DISC_RADIUS + scene.case.vehicle.footprint.circumradius();
    let near = scene.case.obstacle_angle.radius / 2.0;
    let disc = match place {
        Place::Open => None,
        Place::Beside => Some(Point::new(end, touching + BESIDE.min(near))),
        Place::Front => Some(Point::new(end + touching + AHEAD.min(near), 0.0)),
    };
    let mut ride = Ride::new(&scene.mdp, end + scene.goal_distance, disc)?;
    for _ in 0..=n_steps {
        ride.drive(Command::new(speed, 0.0))?;
    }
    Ok(ride.pays.last().copied().filter(|_| ride.event.is_none()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_term_is_judged_beside_the_place_and_beside_the_pay() {
        assert_eq!(judge(0.0, 30.0, 40.0), SpeedVerdict::None);
        assert_eq!(judge(5.9, 30.0, 40.0), SpeedVerdict::Flat);
        assert_eq!(judge(6.1, 30.0, 40.0), SpeedVerdict::Clear);
        assert_eq!(judge(0.3, 0.0, 40.0), SpeedVerdict::Flat);
        assert_eq!(judge(0.5, 0.0, 40.0), SpeedVerdict::Clear);
    }
}
