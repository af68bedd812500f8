//! What is shown on the standard error stream while jobs run.

use std::io::{self, IsTerminal, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// The time between two refreshes of the bar.
const BAR_PERIOD: Duration = Duration::from_millis(200);
/// The time between two lines.
const LINE_PERIOD: Duration = Duration::from_secs(10);

/// What is shown on the standard error stream while jobs run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Display {
    /// A progress bar that counts what is named here, in the plural.
    Bar(&'static str),
    /// A line about every ten seconds, and one at the end, that counts what is named here.
    Lines(&'static str),
    /// Nothing.
    Silent,
}

/// What workers tell whoever waits.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// A job has succeeded.
    Finished,
    /// A line to show.
    Said(String),
}

/// All the work there is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Work {
    pub(super) n_jobs: usize,
    /// In the unit of the jobs.
    pub(super) amount: u64,
}

/// How far the work has come.
#[derive(Debug, Clone, Copy)]
struct Snapshot {
    work: Work,
    n_finished: usize,
    done: u64,
    elapsed: Duration,
    noun: &'static str,
}

impl Display {
    /// A bar if the standard error stream is a terminal, lines otherwise; the jobs are called `noun`, in the plural.
    pub fn auto(noun: &'static str) -> Self {
        if io::stderr().is_terminal() { Self::Bar(noun) } else { Self::Lines(noun) }
    }

    /// What the jobs are called.
    fn noun(self) -> &'static str {
        match self {
            Self::Bar(noun) | Self::Lines(noun) => noun,
            Self::Silent => "jobs",
        }
    }

    /// Shows the progress and what workers say until they have all hung up.
    pub(super) fn follow(self, work: Work, events: &Receiver<Event>, done: &AtomicU64) {
        let bar = self.bar(work);
        let period = if matches!(self, Self::Lines(_)) { LINE_PERIOD } else { BAR_PERIOD };
        let start = Instant::now();
        let (mut n_finished, mut due) = (0, start + period);
        let snapshot = |n_finished| Snapshot {
            work,
            n_finished,
            done: done.load(Ordering::Relaxed),
            elapsed: start.elapsed(),
            noun: self.noun(),
        };
        loop {
            match events.recv_timeout(due.saturating_duration_since(Instant::now())) {
                Ok(Event::Finished) => n_finished += 1,
                Ok(Event::Said(line)) => self.say(&bar, &line),
                Err(RecvTimeoutError::Timeout) => {
                    self.show(&bar, &snapshot(n_finished));
                    due = Instant::now() + period;
                }
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        bar.finish_and_clear();
        // Where a job failed, be it the last, its error is the last word.
        if self != Self::Silent && n_finished == work.n_jobs {
            print(&snapshot(n_finished));
        }
    }

    /// Shows a line above the bar, if there is one.
    fn say(self, bar: &ProgressBar, line: &str) {
        match self {
            Self::Bar(_) => bar.println(line),
            Self::Lines(_) => drop(writeln!(io::stderr(), "{line}")),
            Self::Silent => {}
        }
    }

    fn bar(self, work: Work) -> ProgressBar {
        let Self::Bar(noun) = self else {
            return ProgressBar::hidden();
        };
        let style = ProgressStyle::with_template("{bar:30}  {msg}").expect("a valid template");
        let bar = ProgressBar::new(work.amount).with_style(style);
        bar.set_message(format!("0 of {} {noun}", work.n_jobs));
        bar
    }

    fn show(self, bar: &ProgressBar, snapshot: &Snapshot) {
        match self {
            Self::Bar(_) => {
                bar.set_message(snapshot.text());
                bar.set_position(snapshot.done);
            }
            Self::Lines(_) => print(snapshot),
            Self::Silent => {}
        }
    }
}

/// Prints a line of progress; nobody misses it if there is nowhere to print it.
fn print(snapshot: &Snapshot) {
    let _ = writeln!(io::stderr(), "{}", snapshot.text());
}

impl Snapshot {
    /// For example `3 of 40 runs, 25 %, 2 min left`.
    fn text(&self) -> String {
        let seconds = self.elapsed.as_secs_f64();
        let runs = format!("{} of {} {}", self.n_finished, self.work.n_jobs, self.noun);
        if self.n_finished == self.work.n_jobs {
            return format!("{runs}, took {}", time(seconds));
        }
        let share = self.done as f64 / self.work.amount.max(1) as f64;
        let left = (share > 0.0).then(|| format!(", {} left", time(seconds / share * (1.0 - share).max(0.0))));
        format!("{runs}, {:.0} %{}", (100.0 * share).floor(), left.unwrap_or_default())
    }
}

/// A time that people can take in, as in `45 s`, `12 min`, `3 h 20 min`.
fn time(seconds: f64) -> String {
    let minutes = (seconds / 60.0).round() as u64;
    match minutes {
        _ if seconds < 99.5 => format!("{seconds:.0} s"),
        ..100 => format!("{minutes} min"),
        _ => format!("{} h {} min", minutes / 60, minutes % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(n_finished: usize, done: u64, seconds: u64) -> String {
        let work = Work { n_jobs: 40, amount: 4_000_000 };
        Snapshot { work, n_finished, done, elapsed: Duration::from_secs(seconds), noun: "runs" }.text()
    }

    #[test]
    fn lines_of_progress() {
        assert_eq!(text(0, 0, 10), "0 of 40 runs, 0 %");
        assert_eq!(text(3, 1_000_000, 10), "3 of 40 runs, 25 %, 30 s left");
        assert_eq!(text(3, 10_000, 10), "3 of 40 runs, 0 %, 67 min left");
        assert_eq!(text(3, 1_000, 10), "3 of 40 runs, 0 %, 11 h 7 min left");
        assert_eq!(text(39, 4_000_000, 100), "39 of 40 runs, 100 %, 0 s left");
        assert_eq!(text(40, 4_000_000, 3), "40 of 40 runs, took 3 s");
    }
}
