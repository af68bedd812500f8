//! Independent jobs on a few threads, with progress for whoever waits.
//!
//! Each job runs on one thread from beginning to end, and results come back in the order of the jobs: the number of
//! workers changes how long it takes, and nothing else.

mod display;

pub use display::Display;

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Sender};
use std::sync::{Mutex, PoisonError};
use std::thread;

use display::{Event, Work};

/// One job: what to do it with, and how much work it is.
#[derive(Debug, Clone)]
pub struct Job<I> {
    /// What the job needs to know.
    pub input: I,
    /// The work in it, in any unit that all jobs share; only progress and time left depend on it.
    pub work: u64,
}

/// The way in which a job reports how far it is.
#[derive(Debug)]
pub struct Progress<'a> {
    total: &'a AtomicU64,
    share: u64,
    reported: AtomicU64,
    events: &'a Sender<Event>,
}

impl Progress<'_> {
    /// Adds work that the job has done; cheap enough for every few hundred env steps. Work beyond the job's share
    /// does not count.
    pub fn advance(&self, work: u64) {
        let before = self.reported.fetch_add(work, Ordering::Relaxed);
        let counted = work.min(self.share.saturating_sub(before));
        self.total.fetch_add(counted, Ordering::Relaxed);
    }

    /// Says a line to whoever waits, beside what is shown of the progress.
    pub fn say(&self, line: String) {
        // The display hangs up only when all workers have.
        let _ = self.events.send(Event::Said(line));
    }
}

/// The results of all jobs, in their order, from `n_workers` threads that each take the next job when they are free.
///
/// ```
/// use std::num::NonZeroUsize;
/// use headway_experiments::jobs::{Display, Job, run};
///
/// let jobs: Vec<_> = (0..8).map(|input| Job { input, work: 1 }).collect();
/// let workers = NonZeroUsize::new(3).unwrap();
/// let squares = run(&jobs, workers, Display::Silent, |input: &u64, progress| {
///     progress.advance(1);
///     Ok::<_, String>(input * input)
/// });
/// assert_eq!(squares.unwrap(), [0, 1, 4, 9, 16, 25, 36, 49]);
/// ```
///
/// # Errors
/// After a job fails no further job starts; those that run go on to their end. The error is that of the first failed
/// job in the order of the jobs, whatever the number of workers.
///
/// # Panics
/// If a job panics, once the other workers have ended.
pub fn run<I: Sync, T: Send, E: Send>(
    jobs: &[Job<I>],
    n_workers: NonZeroUsize,
    display: Display,
    work: impl Fn(&I, &Progress<'_>) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let queue = Queue { jobs, next: AtomicUsize::new(0), done: AtomicU64::new(0) };
    let results: Mutex<Vec<Option<Result<T, E>>>> = Mutex::new(jobs.iter().map(|_| None).collect());
    let (sender, events) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..n_workers.get().min(jobs.len()) {
            let sender = sender.clone();
            let (queue, results, work) = (&queue, &results, &work);
            scope.spawn(move || {
                while let Some((i, result)) = queue.run_next(work, &sender) {
                    if result.is_ok() {
                        // The display hangs up only when all workers have.
                        let _ = sender.send(Event::Finished);
                    }
                    lock(results)[i] = Some(result);
                }
            });
        }
        drop(sender);
        let amount = jobs.iter().map(|job| job.work).sum();
        display.follow(Work { n_jobs: jobs.len(), amount }, &events, &queue.done);
    });
    // A job that was never handed out comes after one that failed, at which collecting stops.
    results.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect()
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The jobs that are still to be handed out.
struct Queue<'a, I> {
    jobs: &'a [Job<I>],
    next: AtomicUsize,
    /// The work done, over all jobs.
    done: AtomicU64,
}

impl<I> Queue<'_, I> {
    /// Takes the next job, if there is one, and does it. A job that fails, or panics, empties the queue.
    fn run_next<T, E>(
        &self,
        work: &impl Fn(&I, &Progress<'_>) -> Result<T, E>,
        events: &Sender<Event>,
    ) -> Option<(usize, Result<T, E>)> {
        let i = self.next.fetch_add(1, Ordering::Relaxed);
        let job = self.jobs.get(i)?;
        let empty_on_panic = EmptyOnDrop(self);
        let progress = Progress { total: &self.done, share: job.work, reported: AtomicU64::new(0), events };
        let result = work(&job.input, &progress);
        progress.advance(job.work); // a job that does not report counts when it ends
        if result.is_ok() {
            std::mem::forget(empty_on_panic);
        }
        Some((i, result))
    }
}

/// Empties the queue when it is dropped.
struct EmptyOnDrop<'a, 'b, I>(&'a Queue<'b, I>);

impl<I> Drop for EmptyOnDrop<'_, '_, I> {
    fn drop(&mut self) {
        self.0.next.store(self.0.jobs.len(), Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn jobs(n: usize) -> Vec<Job<usize>> {
        (0..n).map(|input| Job { input, work: 10 }).collect()
    }

    fn workers(n: usize) -> NonZeroUsize {
        NonZeroUsize::new(n).unwrap()
    }

    #[test]
    fn results_do_not_depend_on_the_number_of_workers() {
        for n in [1, 2, 7, 100] {
            let results = run(&jobs(20), workers(n), Display::Silent, |i, _| {
                thread::sleep(Duration::from_millis((20 - *i as u64) % 3)); // later jobs end earlier
                Ok::<_, ()>(i * 10)
            });
            assert_eq!(results.unwrap(), (0..20).map(|i| i * 10).collect::<Vec<_>>());
        }
    }

    #[test]
    fn no_jobs_are_no_work() {
        assert_eq!(run(&jobs(0), workers(2), Display::Silent, |_, _| Err::<(), _>("unreachable")), Ok(vec![]));
    }

    #[test]
    fn the_first_error_stops_the_queue() {
        for n in [1, 2, 4] {
            let started = AtomicUsize::new(0);
            let result = run(&jobs(1000), workers(n), Display::Silent, |i, _| {
                started.fetch_add(1, Ordering::Relaxed);
                thread::sleep(Duration::from_millis(1));
                if *i >= 3 { Err(*i) } else { Ok(()) }
            });
            assert_eq!(result, Err(3), "{n} workers");
            assert!(started.into_inner() <= 3 + 2 * n, "{n} workers");
        }
    }

    #[test]
    fn a_panic_stops_the_queue_and_comes_through() {
        let started = AtomicUsize::new(0);
        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            run(&jobs(1000), workers(2), Display::Silent, |i, _| {
                started.fetch_add(1, Ordering::Relaxed);
                thread::sleep(Duration::from_millis(5));
                assert!(*i != 3, "a job's own bug");
                Ok::<_, ()>(())
            })
        }));
        assert!(outcome.is_err());
        assert!(started.into_inner() < 1000);
    }

    #[test]
    fn a_job_counts_for_its_share_and_no_more() {
        let total = AtomicU64::new(0);
        let (events, heard) = mpsc::channel();
        let progress = Progress { total: &total, share: 10, reported: AtomicU64::new(0), events: &events };
        progress.say("half way".into());
        assert_eq!(heard.recv(), Ok(Event::Said("half way".into())));
        progress.advance(4);
        assert_eq!(total.load(Ordering::Relaxed), 4);
        progress.advance(100);
        progress.advance(10);
        assert_eq!(total.load(Ordering::Relaxed), 10);
    }
}
