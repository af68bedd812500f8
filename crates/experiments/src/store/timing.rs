//! How long a run took, and when.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

use cpu_time::ThreadTime;
use serde::{Deserialize, Serialize};

/// How long a training or an evaluation took, and when: `timing.json`, the only file that differs between equal runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Timing {
    /// When it started, UTC, as in RFC 3339.
    pub started: String,
    /// When it ended, UTC, as in RFC 3339.
    pub finished: String,
    /// Time that passed, s.
    pub wall_seconds: f64,
    /// Processor time of the thread that did it, s.
    pub cpu_seconds: f64,
}

/// The clock of a training or an evaluation, which does all its work on one thread.
#[derive(Debug)]
pub struct Stopwatch {
    date: SystemTime,
    wall: Instant,
    cpu: ThreadTime,
}

impl Stopwatch {
    /// A clock that starts now, for the calling thread.
    pub fn start() -> Self {
        Self { date: SystemTime::now(), wall: Instant::now(), cpu: ThreadTime::now() }
    }

    /// What passed since the start; to be called on the thread that started it.
    pub fn stop(self) -> Timing {
        Timing {
            started: utc(self.date),
            finished: utc(SystemTime::now()),
            wall_seconds: self.wall.elapsed().as_secs_f64(),
            cpu_seconds: self.cpu.elapsed().as_secs_f64(),
        }
    }
}

/// The date and time in UTC, to the second, as in RFC 3339; times before 1970 count as 1970.
fn utc(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (year, month, day) = civil(seconds / 86_400);
    let second = seconds % 86_400;
    format!("{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}Z", second / 3600, second / 60 % 60, second % 60)
}

/// Year, month and day of the Gregorian calendar from the days since 1970-01-01 (Howard Hinnant, "chrono-compatible
/// low-level date algorithms", `civil_from_days`).
fn civil(days: u64) -> (u64, u64, u64) {
    let days = days + 719_468; // since 0000-03-01
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153; // 0 is March
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    (era * 400 + year_of_era + u64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn dates() {
        for (seconds, date) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_795_356_951, "2026-11-22T14:15:51Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(utc(UNIX_EPOCH + Duration::from_secs(seconds)), date);
        }
    }

    #[test]
    fn time_passes() {
        let timing = Stopwatch::start().stop();
        assert!(timing.wall_seconds >= 0.0 && timing.cpu_seconds >= 0.0 && timing.started <= timing.finished);
    }
}
