//! Scripted drivers.

use std::fmt;

use headway_env::{Event, GoalHandling};
use headway_sim::{Command, Point};
use serde::Serialize;

use super::ride::{Ride, is_settled, turn};
use super::scene::{Scene, most_yaw_rate};
use super::{Payments, Steering};
use crate::Error;

/// Speeds that arriving drivers try, from a tenth of the highest one up.
const N_SPEEDS: usize = 15;
/// The slow driver's part of the desired speed.
const SLOW: f64 = 0.25;

/// What a scripted driver does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Behaviour {
    /// Stands at the start.
    Park,
    /// Turns on the spot at the start.
    Spin,
    /// Drives round the disc at v_bar.
    Orbit,
    /// Drives up to the goal at v_bar and stops before it counts as reached.
    Hover,
    /// Drives into the disc.
    Crash,
    /// Drives to the goal; and on to the next one, where there is one.
    Arrive(Pace),
}

/// How fast a driver arrives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Pace {
    /// At a quarter of v_bar, or the lowest speed that the agent can ask for.
    Slow,
    /// At v_bar ([`Case::desired_speed`](super::Case::desired_speed)).
    Desired,
    /// At the highest speed that the agent can ask for.
    FlatOut,
    /// At another speed.
    Other,
}

/// How a driver ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// At the goal; with new goals, at one after the other.
    Arrives,
    /// At the disc.
    Collides,
    /// Never: it goes on for ever.
    Never,
}

/// What a driver did and what that was paid.
#[derive(Debug, Clone)]
pub(super) struct Driven {
    pub(super) behaviour: Behaviour,
    /// m/s; 0 where it stays where it is.
    pub(super) speed: f64,
    pub(super) end: End,
    /// The steps to its first end, or to its cycle.
    pub(super) n_steps: usize,
    pub(super) payments: Payments,
}

impl fmt::Display for Driven {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let speed = self.speed;
        match self.behaviour {
            Behaviour::Park => f.write_str("park"),
            Behaviour::Spin => f.write_str("spin on the spot"),
            Behaviour::Orbit => write!(f, "orbit the disc at {speed:.2} m/s"),
            Behaviour::Hover => f.write_str("stop before the goal"),
            Behaviour::Crash => f.write_str("crash into the disc"),
            Behaviour::Arrive(Pace::Slow) => write!(f, "arrive slowly, {speed:.2} m/s"),
            Behaviour::Arrive(Pace::Desired) => write!(f, "arrive at v_bar, {speed:.2} m/s"),
            Behaviour::Arrive(Pace::FlatOut) => write!(f, "arrive flat out, {speed:.2} m/s"),
            Behaviour::Arrive(Pace::Other) => write!(f, "arrive at {speed:.2} m/s"),
        }
    }
}

/// All drivers that the agent's actions allow; those that do not arrive first.
pub(super) fn drive_all(scene: &Scene<'_>) -> Result<Vec<Driven>, Error> {
    let stands = scene.case.speeds[0] <= 0.0;
    let steers = scene.case.steering == Steering::Agent && scene.case.yaw_rate > 0.0;
    let turns_on_the_spot = stands && steers && scene.case.vehicle.drive.turning_radius() == 0.0;
    let mut driven = Vec::new();
    driven.extend(if stands { park(scene)? } else { None });
    driven.extend(if turns_on_the_spot { spin(scene)? } else { None });
    driven.extend(if steers { orbit(scene)? } else { None });
    driven.extend(if stands { hover(scene)? } else { None });
    driven.extend(if steers { crash(scene)? } else { None });
    for (pace, speed) in paces(scene) {
        driven.extend(arrive(scene, pace, speed)?);
    }
    Ok(driven)
}

/// The speeds at which drivers arrive.
fn paces(scene: &Scene<'_>) -> Vec<(Pace, f64)> {
    let [lowest, highest] = scene.case.speeds;
    let desired = scene.case.desired_speed();
    let mut paces =
        vec![(Pace::Slow, (SLOW * desired).max(lowest)), (Pace::Desired, desired), (Pace::FlatOut, highest)];
    let first = lowest.max(highest / N_SPEEDS as f64);
    for k in 0..N_SPEEDS {
        let speed = first + (highest - first) * k as f64 / (N_SPEEDS - 1) as f64;
        paces.push((Pace::Other, speed));
    }
    let mut kept: Vec<(Pace, f64)> = Vec::new();
    for (pace, speed) in paces {
        if kept.iter().all(|(_, other)| (other - speed).abs() > 1e-9) {
            kept.push((pace, speed));
        }
    }
    kept
}

/// A driver that goes on for ever.
fn for_ever(behaviour: Behaviour, speed: f64, payments: Option<Payments>) -> Option<Driven> {
    let payments = payments?;
    Some(Driven { behaviour, speed, end: End::Never, n_steps: payments.start.len(), payments })
}

fn park(scene: &Scene<'_>) -> Result<Option<Driven>, Error> {
    Ok(for_ever(Behaviour::Park, 0.0, scene.ride()?.cycle(Command::default(), 1)?))
}

fn spin(scene: &Scene<'_>) -> Result<Option<Driven>, Error> {
    let (n_steps, yaw_rate) = turn(most_yaw_rate(scene.case), scene.case.vehicle.control_period);
    let command = scene.turn(0.0, yaw_rate);
    let mut ride = scene.ride()?;
    if !ride.drive_until(command, |vehicle| is_settled(vehicle.twist.z, yaw_rate))? {
        return Ok(None);
    }
    Ok(for_ever(Behaviour::Spin, 0.0, ride.cycle(command, n_steps)?))
}

fn orbit(scene: &Scene<'_>) -> Result<Option<Driven>, Error> {
    let orbit = &scene.orbit;
    let Some(n_steps) = orbit.n_steps else { return Ok(None) };
    let yaw_rate = orbit.speed / orbit.radius;
    let command = scene.turn(orbit.speed, yaw_rate);
    let mut ride = towards_turn(scene, orbit.speed)?;
    let settled = ride.drive_until(command, |vehicle| {
        is_settled(vehicle.twist.x, orbit.speed) && is_settled(vehicle.twist.z, yaw_rate)
    })?;
    if !settled {
        return Ok(None);
    }
    Ok(for_ever(Behaviour::Orbit, orbit.speed, ride.cycle(command, n_steps)?))
}

/// A vehicle that has driven to where the orbit begins.
fn towards_turn(scene: &Scene<'_>, speed: f64) -> Result<Ride, Error> {
    let mut ride = scene.ride()?;
    let turn_at = scene.orbit.turn_at - 1e-9;
    ride.drive_until(Command::new(speed, 0.0), |vehicle| vehicle.pose.translation.x >= turn_at)?;
    Ok(ride)
}

/// From the last step on from which the vehicle still comes to a stand before it has arrived.
fn hover(scene: &Scene<'_>) -> Result<Option<Driven>, Error> {
    let speed = scene.case.desired_speed();
    let Some(whole) = leg(scene, speed, (0, 0.0))? else { return Ok(None) };
    for n_driving in (0..whole.len()).rev() {
        let mut ride = scene.ride()?;
        for _ in 0..n_driving {
            ride.drive(Command::new(speed, 0.0))?;
        }
        if ride.drive_until(Command::default(), |vehicle| is_settled(vehicle.twist.x, 0.0))?
            && ride.position().x < scene.goal_distance
            && let Some(driven) = for_ever(Behaviour::Hover, speed, ride.cycle(Command::default(), 1)?)
        {
            return Ok(Some(driven));
        }
    }
    Ok(None)
}

/// From where the orbit begins, in a circle half as wide, which leads through the disc's centre.
fn crash(scene: &Scene<'_>) -> Result<Option<Driven>, Error> {
    let curvature = 2.0 / scene.orbit.radius;
    let speed = scene.orbit.speed.min(most_yaw_rate(scene.case) / curvature).max(scene.case.speeds[0]);
    let mut ride = towards_turn(scene, speed)?;
    ride.drive_until(scene.turn(speed, speed * curvature), |_| false)?;
    let payments = Payments { start: ride.pays, cycle: Vec::new() };
    let n_steps = payments.start.len();
    let behaviour = Behaviour::Crash;
    let collides = ride.event == Some(Event::Collision);
    Ok(collides.then_some(Driven { behaviour, speed, end: End::Collides, n_steps, payments }))
}

/// To the goal; with new goals, each is as far, straight ahead, with a disc beside the way, and the vehicle is already at speed.
fn arrive(scene: &Scene<'_>, pace: Pace, speed: f64) -> Result<Option<Driven>, Error> {
    let Some(start) = leg(scene, speed, (0, 0.0))? else { return Ok(None) };
    let cycle = match scene.case.goal {
        GoalHandling::Terminate => Some(Vec::new()),
        GoalHandling::NewGoal => match scene.run_up(speed)? {
            Some(run_up) => leg(scene, speed, run_up)?,
            None => None,
        },
    };
    let n_steps = start.len();
    Ok(cycle.map(|cycle| Driven {
        behaviour: Behaviour::Arrive(pace),
        speed,
        end: End::Arrives,
        n_steps,
        payments: Payments { start, cycle },
    }))
}

/// The pay of the steps to a goal, which begin after a run-up of so many steps and metres; none if it is not reached.
fn leg(scene: &Scene<'_>, speed: f64, (n_steps, distance): (usize, f64)) -> Result<Option<Vec<f64>>, Error> {
    let disc = Point::new(scene.disc.x + distance, scene.disc.y);
    let goal = scene.goal_distance + distance;
    let mut ride = Ride::new(&scene.mdp, goal, Some(disc))?;
    let command = Command::new(speed, 0.0);
    for _ in 0..n_steps {
        ride.drive(command)?;
    }
    ride.drive_until(command, |vehicle| vehicle.pose.translation.x > goal + scene.case.reach_radius)?;
    Ok((ride.event == Some(Event::Reach)).then(|| ride.pays.split_off(n_steps)))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use headway_reward::{Progress, Proximity, R, RCouple, Reward, Sum};

    use super::super::Case;
    use super::*;
    use crate::spec::RunSpec;

    fn case(reward: impl Reward + 'static) -> Case {
        Case::of(&RunSpec { reward: Arc::new(reward), ..RunSpec::default() })
    }

    fn driven(case: &Case, behaviour: Behaviour) -> Driven {
        let all = drive_all(&Scene::new(case).unwrap()).unwrap();
        all.into_iter().find(|driven| driven.behaviour == behaviour).unwrap()
    }

    #[test]
    fn parking_repeats_one_step() {
        let Payments { start, cycle } = driven(&case(R::default()), Behaviour::Park).payments;
        assert_eq!((start, cycle), (vec![], vec![10.0]));
    }

    #[test]
    fn an_orbit_beside_the_disc_pays_r_couple_40_a_step() {
        let Driven { payments, speed, .. } = driven(&case(RCouple::default()), Behaviour::Orbit);
        assert_eq!(speed, 1.2);
        assert!(payments.cycle.iter().all(|pay| (pay - 40.0).abs() < 1e-9), "20 (1 + g(v_bar)): {payments:?}");
        let (k, start) =
            (payments.start.len() as i32, payments.start.iter().rev().fold(0.0, |sum, pay| sum * 0.95 + pay));
        assert!((payments.discounted(0.95) - (start + 0.95_f64.powi(k) * 40.0 / 0.05)).abs() < 1e-6);
    }

    #[test]
    fn an_orbit_repeats_exactly_whatever_lies_between_commands_and_wheels() {
        let reward = || Sum::default().with(1.0, Progress::default()).with(1.0, Proximity { margin: 2.0 });
        let ideal = case(reward());
        let mut late = case(reward());
        let actuation = &mut late.vehicle.actuation;
        (actuation.latency, actuation.speed_lag, actuation.yaw_rate_lag, actuation.yaw_rate_gain) =
            (0.25, 0.3, 0.2, 0.8);
        let mut car = case(reward());
        car.vehicle.drive =
            headway_sim::Drive::Ackermann { wheelbase: 0.5, max_steering_angle: 0.5, max_steering_rate: 2.0 };
        for case in [ideal, late, car] {
            let Driven { payments, speed, .. } = driven(&case, Behaviour::Orbit);
            let scene = Scene::new(&case).unwrap();
            let mut ride = towards_turn(&scene, speed).unwrap();
            let command = scene.turn(speed, speed / scene.orbit.radius);
            let n = payments.cycle.len();
            while ride.pays.len() < payments.start.len() + 5 * n {
                ride.drive(command).unwrap();
            }
            let fifth = &ride.pays[payments.start.len() + 4 * n..];
            assert!(fifth.iter().zip(&payments.cycle).all(|(a, b)| (a - b).abs() < 1e-5), "{fifth:?} {payments:?}");
            let progress: f64 = payments.cycle.iter().sum::<f64>();
            let inside = n as f64 * (1.0 - (scene.orbit.radius - 0.35 - 0.25) / 2.0);
            assert!((progress - inside.max(0.0)).abs() < 1e-4, "a circle comes no nearer: {progress} {inside}");
            assert_eq!(driven(&case, Behaviour::Crash).end, End::Collides);
        }
    }

    #[test]
    fn stopping_before_the_goal_earns_the_progress_of_all_the_way() {
        let case = case(Progress::default());
        let Payments { start, cycle } = driven(&case, Behaviour::Hover).payments;
        let left = 4.0 - start.iter().sum::<f64>();
        assert!(left > 0.5 && left < 0.5 + 1.2 * 0.2, "{left} m");
        assert_eq!(cycle, [0.0]);
    }

    #[test]
    fn a_new_goal_is_as_far_again() {
        let mut case = case(R::default());
        case.goal = GoalHandling::NewGoal;
        let Driven { payments: Payments { start, cycle }, .. } = driven(&case, Behaviour::Arrive(Pace::FlatOut));
        // 1.5 t - 0.5625 >= 3.5 m from rest at 2 m/s^2, 1.5 t >= 3.5 m at speed; steps of 0.2 s.
        assert_eq!((start.len(), cycle.len()), (14, 12));
        assert_eq!((start[13], cycle[11]), (100.0, 100.0));
        assert!(start[..13].iter().chain(&cycle[..11]).all(|pay| *pay == 10.0));
    }
}
