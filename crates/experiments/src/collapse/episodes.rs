//! Verdicts on evaluation episodes.

use super::Collapse;
use crate::episode::SeedSummary;

/// Share of episodes above which a policy that runs out of time has collapsed.
pub const TIMEOUTS: f64 = 0.9;

/// How a policy has collapsed by its evaluation in a world, if it has: it runs out of time in more than [`TIMEOUTS`] of the episodes.
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
/// let verdict = of_evaluation("hall", &parked).unwrap();
/// assert_eq!(verdict.describe(), "times out in hall (100 % of evaluation episodes, at 0.00 m/s)");
/// ```
pub fn of_evaluation(world: &str, summary: &SeedSummary) -> Option<Collapse> {
    let timeouts = summary.timeout.filter(|share| *share > TIMEOUTS)?;
    Some(Collapse::TimesOut { world: world.to_owned(), timeouts, mean_speed: summary.mean_speed? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearly_all_episodes_must_run_out_of_time() {
        let none = SeedSummary::of(&[]);
        let verdict =
            |timeout: f64| of_evaluation("a", &SeedSummary { timeout: Some(timeout), mean_speed: Some(0.25), ..none });
        let expected = Collapse::TimesOut { world: "a".into(), timeouts: 0.95, mean_speed: 0.25 };
        assert_eq!(verdict(0.95), Some(expected));
        assert_eq!(verdict(TIMEOUTS), None);
        assert_eq!(of_evaluation("a", &none), None, "no episodes");
    }
}
