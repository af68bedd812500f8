//! What a vehicle's outline sweeps over, against what its scan shows.

use headway_sim::{Pose, Stretch, wrap};
use nalgebra::Vector2;

use crate::Sensed;
use crate::outline::Outline;

/// Where a beam ended, in the vehicle's frame at the time of the scan.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Echo {
    pub(crate) at: Vector2<f64>,
    /// Half the distance to a neighbouring beam at this range, metres: what lies between beams belongs to the nearer
    /// one.
    pub(crate) spacing: f64,
}

/// The range of a beam; the lidar's greatest where it met nothing or says nothing.
fn range_of(sensed: &Sensed<'_>, beam: usize) -> f64 {
    let range = f64::from(sensed.scan[beam]);
    if range > 0.0 && range < sensed.max_range { range } else { sensed.max_range }
}

/// Where a beam ends, if that may matter within `reach` metres of the origin.
fn end_of(sensed: &Sensed<'_>, beam: usize, reach: f64) -> Option<Echo> {
    let (range, angles) = (range_of(sensed, beam), sensed.beam_angles);
    let gap =
        |other: Option<usize>| other.and_then(|k| angles.get(k)).map_or(f64::INFINITY, |k| (k - angles[beam]).abs());
    let gap = gap(Some(beam + 1)).min(gap(beam.checked_sub(1)));
    let spacing = if gap < NEIGHBOURS { range * gap / 2.0 } else { 0.0 };
    (range - spacing < reach).then(|| Echo { at: along(angles[beam]) * range, spacing })
}

fn along(angle: f64) -> Vector2<f64> {
    let (sin, cos) = angle.sin_cos();
    Vector2::new(cos, sin)
}

/// The echoes that may matter within `reach` metres of the origin. Beams that end at the lidar's greatest range or
/// beyond, and ranges that are not above 0, are none.
pub(crate) fn echoes<'a>(sensed: &Sensed<'a>, reach: f64) -> impl Iterator<Item = Echo> + use<'a> {
    let sensed = *sensed;
    let is_echo = move |beam: &usize| range_of(&sensed, *beam) < sensed.max_range;
    (0..n_beams(&sensed)).filter(is_echo).filter_map(move |beam| end_of(&sensed, beam, reach))
}

fn n_beams(sensed: &Sensed<'_>) -> usize {
    sensed.scan.len().min(sensed.beam_angles.len())
}

/// The border of what is seen, as points `apart` metres from each other at most: the ends of all beams, and straight
/// lines between those of neighbours; as far as it may matter within `reach` metres of the origin.
///
/// Where one beam ends on something and the next passes by it, the line between the two is the edge of its shadow.
fn border(sensed: &Sensed<'_>, reach: f64, apart: f64) -> Vec<Echo> {
    let n = n_beams(sensed);
    let mut points = Vec::new();
    let end = |beam: usize| (range_of(sensed, beam), end_of(sensed, beam, reach));
    let Some(last) = n.checked_sub(1) else { return points };
    let mut before = (last, end(last));
    for beam in 0..n {
        let now = (beam, end(beam));
        points.extend(now.1.1);
        let is_neighbour = wrap(sensed.beam_angles[beam] - sensed.beam_angles[before.0]).abs() < NEIGHBOURS;
        if is_neighbour && n > 1 {
            let (near, far) = if now.1.0 < before.1.0 { (now, before) } else { (before, now) };
            if let Some(from) = near.1.1 {
                let to = far.1.1.map_or_else(|| along(sensed.beam_angles[far.0]) * far.1.0, |far| far.at);
                fill(&mut points, from, to, reach, apart);
            }
        }
        before = now;
    }
    points
}

/// Points on the way from an echo to one farther off, ends excluded, up to `reach` metres from the origin.
fn fill(points: &mut Vec<Echo>, from: Echo, to: Vector2<f64>, reach: f64, apart: f64) {
    let way = to - from.at;
    let n = (way.norm() / apart).ceil();
    let on_the_way = (1..n as usize).map(|k| Echo { at: from.at + way * (k as f64 / n), spacing: from.spacing });
    points.extend(on_the_way.take_while(|point| point.at.norm() < reach));
}

/// Beams less than this apart, radians, have nothing between them but what both see; what lies between others is not
/// seen.
const NEIGHBOURS: f64 = 1.0;

/// What to think of places that are hidden behind something, or lie beyond the lidar's greatest range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unseen {
    Free,
    Blocked,
}

/// What counts as no motion, metres.
const ROUNDING: f64 = 1e-6;

/// How far a sweep has come.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Front {
    /// Where the vehicle is by then, in its frame at the time of the scan.
    pub(crate) pose: Pose,
    /// How far points of the outline have moved at most, metres.
    travelled: f64,
    /// How far they may move before the echoes have to be looked at again, metres.
    credit: f64,
}

impl Front {
    pub(crate) fn new() -> Self {
        Self { pose: Pose::identity(), travelled: 0.0, credit: 0.0 }
    }
}

/// The echoes around a vehicle and the distance that it must keep from them.
#[derive(Debug)]
pub(crate) struct Surroundings {
    outline: Outline,
    /// Each with the distance to keep from it, and with the outline's distance now, which it need not exceed.
    echoes: Vec<(Vector2<f64>, f64, f64)>,
    /// Growth of the distance to keep per metre moved.
    noise: f64,
    /// Between two looks, metres.
    step: f64,
}

impl Surroundings {
    /// What stands within `reach` metres of the vehicle's origin; `margin` metres are to be kept from it, and
    /// `noise` metres more for each metre moved.
    ///
    /// A vehicle that is nearer to something already may stay as near, but not come nearer than half the margin; and
    /// where it is nearer than that, no nearer at all. Echoes deeper inside the outline than the margin are its own.
    pub(crate) fn new(sensed: &Sensed<'_>, unseen: Unseen, reach: f64, margin: f64, noise: f64) -> Self {
        let outline = Outline::new(&sensed.vehicle.footprint);
        let reach = reach * (1.0 + noise) + outline.circumradius() + margin;
        let around = match unseen {
            Unseen::Free => echoes(sensed, reach).collect(),
            Unseen::Blocked => border(sensed, reach, margin / 2.0),
        };
        let now = |echo: Echo| (echo, outline.height(&echo.at));
        let near: Vec<_> = around.into_iter().map(now).filter(|(_, height)| *height > -margin).collect();
        let nearest = near.iter().map(|(echo, height)| height - echo.spacing).fold(margin, f64::min);
        let keep = nearest.max(margin / 2.0);
        let echoes = near.into_iter().map(|(echo, height)| (echo.at, keep + echo.spacing, height)).collect();
        let step = nearest.clamp(margin / 16.0, margin) / 4.0;
        Self { outline, echoes, noise, step }
    }

    /// Whether the outline stays clear of the echoes while it moves on from `front`.
    ///
    /// Looks only where the way since the last look exceeds what was free then (conservative advancement, Mirtich
    /// 1996), every quarter of the margin at most.
    pub(crate) fn is_free_along(&self, front: &mut Front, stretch: &Stretch) -> bool {
        let pace = stretch.speed() + stretch.twist.z.abs() * self.outline.turning_radius();
        let (start, length) = (front.pose, pace * stretch.time);
        let mut done = 0.0;
        while front.credit < length - done {
            let next = front.credit.max(self.step).min(length - done);
            done += next;
            front.travelled += next;
            front.pose = stretch.end(&start, stretch.time * done / length);
            let room = self.room(front);
            // What is as far as it was has no room.
            if room < -ROUNDING {
                return false;
            }
            front.credit = room.max(0.0) / (1.0 + self.noise);
            if done >= length {
                return true;
            }
        }
        front.credit -= length - done;
        front.travelled += length - done;
        front.pose = stretch.end(&start, stretch.time);
        true
    }

    /// Whether the last look vouches for all that the outline can sweep on a way of `distance` metres with a turn of `turn`
    /// radians.
    pub(crate) fn is_free_within(&self, front: &Front, distance: f64, turn: f64) -> bool {
        distance + turn * self.outline.turning_radius() <= front.credit.max(ROUNDING)
    }

    /// How much nearer the outline may come to the echoes, metres.
    fn room(&self, front: &Front) -> f64 {
        let back = front.pose.inverse();
        let growth = self.noise * front.travelled;
        let room = |(at, keep, now): &(Vector2<f64>, f64, f64)| {
            self.outline.height(&(back.rotation * at + back.translation.vector)) - (keep + growth).min(*now)
        };
        self.echoes.iter().map(room).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headway_sim::{Point, Shape, Twist, VehicleSpec, arc};
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    fn sensed<'a>(vehicle: &'a VehicleSpec, scan: &'a [f32], beam_angles: &'a [f64]) -> Sensed<'a> {
        let (pose, twist, goal) = (Pose::identity(), Twist::zeros(), Point::new(5.0, 0.0));
        Sensed {
            vehicle,
            scan,
            beam_angles,
            max_range: 5.0,
            pose,
            twist,
            goal,
            route: None,
            last_command: headway_sim::Command::default(),
            movers: &[],
        }
    }

    fn boxed() -> VehicleSpec {
        VehicleSpec { footprint: Shape::Box { length: 0.6, width: 0.4 }, ..VehicleSpec::default() }
    }

    #[test]
    fn how_far_a_box_may_go_by_hand() {
        let vehicle = boxed();
        let free = |range: f32, angle: f64, twist: Twist, time: f64| {
            let (scan, angles) = ([range], [angle]);
            let surroundings = Surroundings::new(&sensed(&vehicle, &scan, &angles), Unseen::Blocked, 5.0, 0.05, 0.0);
            surroundings.is_free_along(&mut Front::new(), &Stretch { twist, time })
        };
        let ahead = Twist::new(1.0, 0.0, 0.0);
        // Something 1 m ahead: the front, 0.3 m ahead, may come to 0.95 m.
        assert!(free(1.0, 0.0, ahead, 0.649) && !free(1.0, 0.0, ahead, 0.651));
        // Nothing is there, but only up to 5 m.
        let most = 5.0 - 0.3 - 0.05;
        assert!(free(5.0, 0.0, ahead, most - 0.01) && !free(5.0, 0.0, ahead, most + 0.01));
        // The corners, 0.36 m away, sweep over what lies abeam of the flank, and miss it farther out.
        let turn = Twist::new(0.0, 0.0, 1.0);
        assert!(!free(0.3, FRAC_PI_2, turn, 1.0) && free(0.45, FRAC_PI_2, turn, 1.0));
        // Sideways: 0.2 m to the flank.
        let left = Twist::new(0.0, 1.0, 0.0);
        assert!(free(1.0, FRAC_PI_2, left, 0.749) && !free(1.0, FRAC_PI_2, left, 0.751));
    }

    /// A wall behind a post was not seen until the vehicle had come round too fast to stop.
    #[test]
    fn the_shadow_of_a_post_is_not_driven_into() {
        let vehicle = VehicleSpec::default();
        let angles: Vec<f64> = (0..72).map(|k| f64::from(k) / 72.0 * std::f64::consts::TAU).collect();
        // A post 1 m away, 20 to 30 degrees to the left.
        let scan: Vec<f32> = (0..72).map(|k| if (4..=6).contains(&k) { 1.0 } else { 5.0 }).collect();
        let free = |unseen: Unseen, yaw_rate: f64| {
            let surroundings = Surroundings::new(&sensed(&vehicle, &scan, &angles), unseen, 4.0, 0.05, 0.0);
            let mut front = Front::new();
            // Past the post, and then straight on or to the left.
            let mut goes = |yaw_rate: f64, time: f64| {
                let twist = Twist::new(1.0, 0.0, yaw_rate);
                surroundings.is_free_along(&mut front, &Stretch { twist, time })
            };
            goes(-0.3, 1.0) && goes(yaw_rate, 2.0)
        };
        assert!(free(Unseen::Free, 0.0) && free(Unseen::Free, 1.2));
        assert!(free(Unseen::Blocked, 0.0) && !free(Unseen::Blocked, 1.2));
    }

    #[test]
    fn what_is_nearer_than_the_margin_may_be_left_but_not_approached() {
        let vehicle = VehicleSpec::default();
        let (scan, angles) = ([0.26_f32], [0.0]);
        let surroundings = Surroundings::new(&sensed(&vehicle, &scan, &angles), Unseen::Blocked, 5.0, 0.05, 0.0);
        let free = |speed: f64| {
            let twist = Twist::new(speed, 0.0, 0.0);
            surroundings.is_free_along(&mut Front::new(), &Stretch { twist, time: 0.2 })
        };
        assert!(free(-1.0) && !free(0.1) && free(0.0));
    }

    proptest! {
        /// Skipping what is free anyway, against looking everywhere.
        #[test]
        fn skipping_finds_what_looking_everywhere_finds(
            v in -2.0..2.0, w in -3.0..3.0, range in 0.5..2.0_f32, angle in -3.0..3.0, time in 0.1..1.5,
        ) {
            let (vehicle, scan, angles) = (boxed(), [range], [angle]);
            let surroundings = Surroundings::new(&sensed(&vehicle, &scan, &angles), Unseen::Blocked, 5.0, 0.05, 0.0);
            let twist = Twist::new(v, 0.0, w);
            let free = surroundings.is_free_along(&mut Front::new(), &Stretch { twist, time });
            let at = Vector2::new(angle.cos(), angle.sin()) * f64::from(range);
            let height = |k: i32| {
                let pose = arc(&Pose::identity(), v, w, time * f64::from(k) / 2000.0);
                surroundings.outline.height(&pose.inverse_transform_point(&at.into()).coords)
            };
            let least = (0..=2000).map(height).fold(f64::INFINITY, f64::min);
            // A dip of less than an eighth of the margin may lie between two looks.
            let agrees = if free { least > 0.05 - 0.05 / 8.0 - 1e-5 } else { least < 0.05 + 1e-5 };
            prop_assert!(agrees, "free: {}, {} m", free, least);
        }
    }
}
