//! What an audit comes to.

use serde::Serialize;

use super::drivers::{Driven, drive_all};
use super::gamma::intervals;
use super::ride::MAX_STEPS;
use super::scene::Scene;
use super::{Behaviour, Case, End, Pace, SpeedTerm};
use crate::Error;

/// Returns that differ by less than this part of their size are equal but for rounding.
const TIE: f64 = 1e-12;
/// Where nothing is discounted returns may be infinite; what is more is then what is more at this discount.
const MOST_GAMMA: f64 = 1.0 - 1e-9;

/// What a reward pays scripted drivers, and whether it pays best for arriving.
#[derive(Debug, Clone, Serialize)]
pub struct Audit {
    /// Whether a driver that arrives has the greatest return, above all that do not.
    pub passes: bool,
    /// How far the goal was, metres: as far as asked for, or farther where the vehicle needs more room to orbit the disc.
    pub goal_distance: f64,
    /// The drivers, the best paid first. Of those that arrive: slowly, at v_bar, flat out, and the best paid.
    pub drivers: Vec<Paid>,
    /// The intervals of gamma in which the best driver that does not arrive has a greater return than the best that does.
    pub not_arriving_pays_more: Vec<[f64; 2]>,
    /// The lowest and the highest speed at which drivers arrived, m/s.
    pub arriving_speeds: [f64; 2],
    /// The speed of the driver that is paid best among those that arrive, m/s.
    pub best_arriving_speed: f64,
    /// Whether drivers that arrive are paid the same at every speed.
    pub arriving_speed_is_indifferent: bool,
    /// What the pay of a step depends on.
    pub speed_term: SpeedTerm,
}

/// One driver and what it is paid.
#[derive(Debug, Clone, Serialize)]
pub struct Paid {
    /// The driver in words.
    pub driver: String,
    /// What it does.
    pub behaviour: Behaviour,
    /// How it ends.
    pub end: End,
    /// Time to the end, or to the first goal, seconds; none where there is no end.
    pub seconds: Option<f64>,
    /// The discounted return, without a time limit.
    #[serde(rename = "return")]
    pub discounted: f64,
    /// The return by which drivers are compared: the same but at a gamma of 1, where it is that just below.
    #[serde(skip)]
    rank: f64,
    /// The mean pay per second: in the long run where it goes on for ever, on the whole way where it ends.
    pub per_second: f64,
}

impl Audit {
    /// Drives all drivers that the case allows.
    ///
    /// # Errors
    /// If no driver arrives, or the reward pays what is no number.
    ///
    /// ```
    /// use headway_experiments::{audit::{Audit, Case}, spec::RunSpec};
    /// let audit = Audit::of(&Case::of(&RunSpec::default()))?;
    /// assert!(audit.passes && audit.not_arriving_pays_more.is_empty());
    /// # Ok::<(), headway_experiments::Error>(())
    /// ```
    pub fn of(case: &Case) -> Result<Self, Error> {
        let scene = Scene::new(case)?;
        let driven = drive_all(&scene)?;
        let sides = Sides::of(&driven);
        let Some((best, worst)) = sides.best_and_worst_arriving(rank_gamma(case)) else {
            return Err(Error::Input(format!(
                "no scripted driver arrives: at every speed a step leads past the goal (env.reach_radius = {} m), or \
                 the way takes more than {MAX_STEPS} steps of {} s",
                case.reach_radius, case.vehicle.control_period
            )));
        };
        let (rank_best, rank_worst) = (rank(best, case), rank(worst, case));
        let speeds = || sides.arriving.iter().map(|driven| driven.speed);
        Ok(Self {
            passes: sides.others.iter().all(|other| is_more(rank_best, rank(other, case))),
            goal_distance: scene.goal_distance,
            drivers: shown(&driven, best, case),
            not_arriving_pays_more: intervals(|gamma| sides.not_arriving_pays_more(gamma)),
            arriving_speeds: [speeds().fold(f64::INFINITY, f64::min), speeds().fold(0.0, f64::max)],
            best_arriving_speed: best.speed,
            arriving_speed_is_indifferent: !is_more(rank_best, rank_worst),
            speed_term: SpeedTerm::of(&scene)?,
        })
    }

    /// Whether drivers that do not arrive have a greater return than all that do; neither this nor [`passes`](Self::passes)
    /// holds where the two are the same.
    pub fn pays_more_for_not_arriving(&self) -> bool {
        self.best_not_arriving().first().is_some_and(|other| is_more(other.rank, self.best_arriving().rank))
    }

    /// The best paid driver of those that arrive.
    ///
    /// # Panics
    /// Never: an audit has one.
    pub fn best_arriving(&self) -> &Paid {
        let best = self.drivers.iter().find(|paid| paid.end == End::Arrives);
        best.expect("an audit without a driver that arrives is an error")
    }

    /// The best paid drivers of those that do not arrive: several where they are paid the same, none where the agent cannot but arrive.
    pub fn best_not_arriving(&self) -> Vec<&Paid> {
        let others = || self.drivers.iter().filter(|paid| paid.end != End::Arrives);
        let Some(best) = others().next() else { return Vec::new() };
        others().filter(|paid| !is_more(best.rank, paid.rank)).collect()
    }
}

/// Drivers that arrive, and others.
struct Sides<'a> {
    arriving: Vec<&'a Driven>,
    others: Vec<&'a Driven>,
}

impl<'a> Sides<'a> {
    fn of(driven: &'a [Driven]) -> Self {
        let (arriving, others) = driven.iter().partition(|driven| driven.end == End::Arrives);
        Self { arriving, others }
    }

    /// Of those that arrive; of several that are paid the same, the first.
    fn best_and_worst_arriving(&self, gamma: f64) -> Option<(&'a Driven, &'a Driven)> {
        let pays = |driven: &&Driven| driven.payments.discounted(gamma);
        let best = self.arriving.iter().copied().rev().max_by(|a, b| pays(a).total_cmp(&pays(b)))?;
        let worst = self.arriving.iter().copied().min_by(|a, b| pays(a).total_cmp(&pays(b)))?;
        Some((best, worst))
    }

    /// Whether one of the others is paid more than all that arrive.
    fn not_arriving_pays_more(&self, gamma: f64) -> bool {
        let exceeds = |other: &Driven, driven: &Driven| other.payments.exceeds(&driven.payments, gamma);
        self.others.iter().any(|other| self.arriving.iter().all(|driven| exceeds(other, driven)))
    }
}

/// The drivers of the table, the best paid first: all but those that arrive at one of many speeds, of which only the best.
fn shown(driven: &[Driven], best: &Driven, case: &Case) -> Vec<Paid> {
    let is_named = |driven: &&Driven| driven.behaviour != Behaviour::Arrive(Pace::Other);
    let best = Some(best).filter(|best| !is_named(best));
    let mut drivers: Vec<Paid> =
        driven.iter().filter(is_named).chain(best).map(|driven| Paid::of(driven, case)).collect();
    // To seven digits, so that what is equal but for rounding stays in the drivers' own order.
    drivers.sort_by(|a, b| (b.rank as f32).total_cmp(&(a.rank as f32)));
    drivers
}

/// The discount at which drivers are compared.
fn rank_gamma(case: &Case) -> f64 {
    case.gamma.min(MOST_GAMMA)
}

/// The return by which a driver is compared.
fn rank(driven: &Driven, case: &Case) -> f64 {
    driven.payments.discounted(rank_gamma(case))
}

impl Paid {
    fn of(driven: &Driven, case: &Case) -> Self {
        let dt = case.vehicle.control_period;
        Self {
            driver: driven.to_string(),
            behaviour: driven.behaviour,
            end: driven.end,
            seconds: (driven.end != End::Never).then_some(driven.n_steps as f64 * dt),
            discounted: driven.payments.discounted(case.gamma),
            rank: rank(driven, case),
            per_second: driven.payments.per_step() / dt,
        }
    }
}

/// Whether `a` is above `b`, and not by rounding alone.
fn is_more(a: f64, b: f64) -> bool {
    a - b > TIE * (a.abs() + b.abs())
}
