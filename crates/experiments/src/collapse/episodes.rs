//! Verdicts on evaluation episodes.

use super::Collapse;
use crate::episode::SeedSummary;

/// Share of episodes above which a policy that runs out of time has collapsed.
pub const TIMEOUTS: f64 = 0.9;

/// How a policy has collapsed by its evaluation in each world; not at all if it does better in any of them.
///
/// ```
/// use headway_experiments::collapse::of_evaluation;
/// use headway_experiments::episode::{EpisodeMeter, Outcome, Sample, SeedSummary};
///
/// let mut meter = EpisodeMeter::new(2.0);
/// meter.push(&Sample {
///     speed_before: 0.0, speed_after: 0.0, dt: 60.0, distance: 0.0, clearance: 3.0, free_range: 5.0,
/// });
/// let parked = SeedSummary::of(&[meter.finish(0, Outcome::Timeout, 4.0)]);
/// let verdict = of_evaluation(&[parked]).unwrap();
/// assert_eq!(verdict.describe(), "times out (100 % of evaluation episodes, at 0.00 m/s)");
/// ```
pub fn of_evaluation(worlds: &[SeedSummary]) -> Option<Collapse> {
    let timeouts: Option<Vec<f64>> = worlds.iter().map(|world| world.timeout).collect();
    let timeouts = timeouts?.into_iter().reduce(f64::min).filter(|least| *least > TIMEOUTS)?;
    let speeds: Vec<f64> = worlds.iter().filter_map(|world| world.mean_speed).collect();
    let mean_speed = speeds.iter().sum::<f64>() / speeds.len().max(1) as f64;
    Some(Collapse::TimesOut { timeouts, mean_speed })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world(timeout: f64, mean_speed: f64) -> SeedSummary {
        let none = SeedSummary::of(&[]);
        SeedSummary { timeout: Some(timeout), mean_speed: Some(mean_speed), ..none }
    }

    #[test]
    fn one_world_that_it_can_do_is_enough() {
        let verdict = of_evaluation(&[world(0.95, 0.0), world(1.0, 0.2)]);
        assert_eq!(verdict, Some(Collapse::TimesOut { timeouts: 0.95, mean_speed: 0.1 }));
        assert_eq!(of_evaluation(&[world(0.95, 0.0), world(TIMEOUTS, 0.2)]), None);
        assert_eq!(of_evaluation(&[world(0.95, 0.0), SeedSummary::of(&[])]), None, "not evaluated everywhere");
        assert_eq!(of_evaluation(&[]), None);
    }
}
