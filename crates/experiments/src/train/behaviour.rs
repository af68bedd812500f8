//! What vehicles do while they train: whether they get anywhere.

use std::f64::consts::TAU;

use headway_env::{Navigator, Step};
use headway_sim::Point;

/// The time over which a vehicle is watched for spinning, s.
pub const SPIN_WINDOW: f64 = 10.0;
/// A vehicle that ends a window within so many metres of where it began has not got away.
const SPIN_DISPLACEMENT: f64 = 0.5;
/// Nor has one that ends it within this fraction of the path driven in it.
const SPIN_STRAIGHTNESS: f64 = 0.25;

/// The watch over all copies of an environment, step by step.
///
/// A vehicle *spins* in a window of [`SPIN_WINDOW`] if it turned by a full turn or more to one side on balance and ended
/// it within 0.5 m, or a quarter of the path driven, of where it began. Windows follow one another from the start of an episode on; the
/// last one, which its end cuts short, counts as one without spinning.
#[derive(Debug)]
pub(super) struct Behaviour {
    /// Steps in a window.
    n_window: u32,
    tracks: Vec<Track>,
    sums: Sums,
}

/// What happened since the figures were last taken.
#[derive(Debug, Default)]
struct Sums {
    time: f64,
    progress: f64,
    abs_progress: f64,
    n_spinning: u64,
    /// Steps in windows that are over.
    n_watched: u64,
    returns: f64,
    n_episodes: u64,
}

/// One copy's window and episode, as far as they have come.
#[derive(Debug, Clone, Copy, Default)]
struct Track {
    from: Point,
    /// Radians, to the left positive.
    turned: f64,
    path: f64,
    n_steps: u32,
    episode_return: f64,
}

/// The figures of an interval; see [`super::MetricsRow`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Figures {
    pub(super) return_mean: Option<f64>,
    pub(super) progress: Option<f64>,
    pub(super) abs_progress: Option<f64>,
    pub(super) spinning: Option<f64>,
}

/// One step of one copy.
#[derive(Debug, Clone, Copy)]
struct Moved {
    position: Point,
    yaw_rate: f64,
    distance: f64,
    duration: f64,
    /// Towards the goal, m.
    progress: f64,
}

impl Moved {
    fn of(navigator: &Navigator) -> Self {
        let vehicle = navigator.vehicle();
        Self {
            position: vehicle.pose.translation.vector.into(),
            yaw_rate: vehicle.twist.z,
            distance: navigator.step_distance(),
            duration: navigator.step_duration(),
            progress: navigator.step_progress(),
        }
    }
}

impl Behaviour {
    /// Before the first step of vehicles that act every `control_period` seconds.
    pub(super) fn new(navigators: &[Navigator], control_period: f64) -> Self {
        let start = |navigator| Track::from(Moved::of(navigator).position);
        Self {
            n_window: (SPIN_WINDOW / control_period).ceil() as u32,
            tracks: navigators.iter().map(start).collect(),
            sums: Sums::default(),
        }
    }

    /// Takes in a step of all copies. Those whose episode it ended are at the start of the next one by now: of their last step
    /// only the reward counts.
    pub(super) fn count(&mut self, navigators: &[Navigator], step: &Step) {
        for (i, (navigator, track)) in navigators.iter().zip(&mut self.tracks).enumerate() {
            let moved = Moved::of(navigator);
            track.episode_return += f64::from(step.rewards[i]);
            if step.terminated[i] || step.truncated[i] {
                self.sums.end_episode(track, &moved);
            } else {
                self.sums.advance(track, &moved, self.n_window);
            }
        }
    }

    /// The figures since the last call.
    pub(super) fn take(&mut self) -> Figures {
        let Sums { time, progress, abs_progress, n_spinning, n_watched, returns, n_episodes } =
            std::mem::take(&mut self.sums);
        let mean = |sum: f64, n: f64| (n > 0.0).then(|| sum / n);
        Figures {
            return_mean: mean(returns, n_episodes as f64),
            progress: mean(progress, time),
            abs_progress: mean(abs_progress, time),
            spinning: mean(n_spinning as f64, n_watched as f64),
        }
    }
}

impl Sums {
    fn advance(&mut self, track: &mut Track, moved: &Moved, n_window: u32) {
        self.time += moved.duration;
        self.progress += moved.progress;
        self.abs_progress += moved.progress.abs();
        track.turned += moved.yaw_rate * moved.duration;
        track.path += moved.distance;
        track.n_steps += 1;
        if track.n_steps == n_window {
            self.n_watched += u64::from(n_window);
            self.n_spinning += u64::from(if track.is_spinning(&moved.position) { n_window } else { 0 });
            *track = Track { episode_return: track.episode_return, ..Track::from(moved.position) };
        }
    }

    fn end_episode(&mut self, track: &mut Track, next: &Moved) {
        self.n_watched += u64::from(track.n_steps);
        self.returns += track.episode_return;
        self.n_episodes += 1;
        *track = Track::from(next.position);
    }
}

impl Track {
    fn from(from: Point) -> Self {
        Self { from, ..Self::default() }
    }

    fn is_spinning(&self, position: &Point) -> bool {
        let displacement = (position - self.from).norm();
        self.turned.abs() >= TAU && displacement < SPIN_DISPLACEMENT.max(SPIN_STRAIGHTNESS * self.path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.2;

    /// A vehicle that drives an arc of this speed and yaw rate for some seconds; what `take` says then.
    fn arc(speed: f64, yaw_rate: impl Fn(u32) -> f64, seconds: f64) -> Figures {
        let mut behaviour = Behaviour { n_window: 50, tracks: vec![Track::default()], sums: Sums::default() };
        let (mut position, mut yaw) = (Point::origin(), 0.0f64);
        for k in 0..(seconds / DT).round() as u32 {
            let yaw_rate = yaw_rate(k);
            yaw += yaw_rate * DT;
            position += Point::new(yaw.cos(), yaw.sin()).coords * speed * DT;
            let moved =
                Moved { position, yaw_rate, distance: speed * DT, duration: DT, progress: yaw.cos() * speed * DT };
            behaviour.sums.advance(&mut behaviour.tracks[0], &moved, 50);
        }
        behaviour.take()
    }

    #[test]
    fn turning_on_the_spot_and_driving_circles_is_spinning() {
        for speed in [0.0, 0.5, 1.5] {
            assert_eq!(arc(speed, |_| 1.5, 30.0).spinning, Some(1.0), "{speed} m/s");
        }
        assert_eq!(arc(1.0, |_| 0.0, 30.0).spinning, Some(0.0)); // straight on
        assert_eq!(arc(0.0, |_| 0.5, 30.0).spinning, Some(0.0)); // 5 rad in 10 s: less than a turn
        assert_eq!(arc(0.0, |k| if k % 2 == 0 { 1.5 } else { -1.5 }, 30.0).spinning, Some(0.0)); // shakes its head
        // A full turn at the start, then away.
        assert_eq!(arc(1.0, |k| if k < 25 { 1.5 } else { 0.0 }, 10.0).spinning, Some(0.0));
        assert_eq!(arc(0.0, |_| 1.5, 9.8).spinning, None, "no window is over");
    }

    #[test]
    fn progress_is_a_mean_over_time() {
        let straight = arc(1.0, |_| 0.0, 10.0);
        assert!((straight.progress.unwrap() - 1.0).abs() < 1e-9 && (straight.abs_progress.unwrap() - 1.0).abs() < 1e-9);
        // Whole turns: to the goal as often as away from it, at a mean of 2 / pi of the speed.
        let circles = arc(1.0, |_| TAU / 10.0, 10.0);
        assert!(circles.progress.unwrap().abs() < 1e-9);
        assert!((circles.abs_progress.unwrap() - 2.0 / std::f64::consts::PI).abs() < 0.01);
        assert_eq!(arc(1.0, |_| 0.0, 0.0), Figures::default());
    }

    #[test]
    fn episodes_end_windows_and_have_returns() {
        let mut sums = Sums::default();
        let still = Moved { position: Point::origin(), yaw_rate: 1.5, distance: 0.0, duration: DT, progress: 0.0 };
        let mut track = Track::default();
        for _ in 0..70 {
            track.episode_return += 0.5;
            sums.advance(&mut track, &still, 50);
        }
        sums.end_episode(&mut track, &still);
        assert_eq!((sums.n_spinning, sums.n_watched), (50, 70));
        assert_eq!((sums.returns, sums.n_episodes, track.n_steps, track.episode_return), (35.0, 1, 0, 0.0));
    }
}
