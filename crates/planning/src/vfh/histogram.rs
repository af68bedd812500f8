//! The histograms of VFH+: which directions are blocked, and which of the free ones to consider.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use headway_sim::wrap;
use nalgebra::Vector2;

/// A number of equal sectors around the vehicle, the middle of the first along 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sectors(pub(super) usize);

impl Sectors {
    /// The middle of a sector, radians.
    pub(super) fn direction(self, sector: usize) -> f64 {
        wrap(TAU * sector as f64 / self.0 as f64)
    }

    /// The sector that holds a direction.
    fn of(self, direction: f64) -> usize {
        let place = direction.rem_euclid(TAU) / TAU * self.0 as f64;
        place.round() as usize % self.0
    }
}

/// Where an echo lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Polar {
    /// Metres.
    pub(super) distance: f64,
    /// Radians.
    pub(super) direction: f64,
}

impl Polar {
    pub(super) fn of(at: &Vector2<f64>) -> Self {
        Self { distance: at.norm(), direction: at.y.atan2(at.x) }
    }

    pub(super) fn turned(&self, angle: f64) -> Self {
        Self { direction: wrap(self.direction + angle), ..*self }
    }
}

/// For each sector the distance of the nearest echo that a disc of radius `grown` would touch on its way along the
/// sector's middle, or infinity: those within `asin(grown / d)` of it, or on the same side where the disc touches
/// already.
pub(super) fn distances(sectors: Sectors, echoes: impl Iterator<Item = Polar>, grown: f64) -> Vec<f64> {
    let mut nearest = vec![f64::INFINITY; sectors.0];
    let width = TAU / sectors.0 as f64;
    for echo in echoes {
        let half_width = if echo.distance > grown { (grown / echo.distance).asin() } else { FRAC_PI_2 };
        let first = ((echo.direction - half_width) / width - 1e-9).ceil() as i64;
        let last = ((echo.direction + half_width) / width + 1e-9).floor() as i64;
        for sector in first..=last {
            let slot = &mut nearest[sector.rem_euclid(sectors.0 as i64) as usize];
            *slot = slot.min(echo.distance);
        }
    }
    nearest
}

/// The bearings to the right and to the left up to which a vehicle can turn on circles of `radius` metres, a disc of
/// radius `grown` around it touching nothing; echoes in the vehicle's frame.
///
/// An echo to the left that lies within `radius + grown` of the left circle's centre stands in the way of all
/// directions beyond it, and likewise to the right.
pub(super) fn reachable(echoes: &[Polar], radius: f64, grown: f64) -> [f64; 2] {
    let mut limits = [-PI, PI];
    for echo in echoes {
        let side = usize::from(echo.direction > 0.0);
        let (sin, cos) = echo.direction.sin_cos();
        let center = if side == 1 { radius } else { -radius };
        let apart = (echo.distance * cos).hypot(echo.distance * sin - center);
        if apart < radius + grown && echo.direction.abs() < limits[side].abs() {
            limits[side] = echo.direction;
        }
    }
    limits
}

/// The directions worth considering, radians: see [`super::Vfh`].
pub(super) fn candidates(sectors: Sectors, free: &[bool], n_wide: usize, target: f64) -> Vec<f64> {
    let n = sectors.0;
    let Some(wall) = (0..n).find(|sector| !free[*sector]) else { return vec![target] };
    let at = |place: f64| wrap(TAU * place / n as f64);
    let mut candidates = Vec::new();
    let mut start = wall + 1;
    while start <= wall + n {
        if !free[start % n] {
            start += 1;
            continue;
        }
        let length = (start..wall + n).take_while(|sector| free[sector % n]).count();
        let (first, last) = (start as f64, (start + length - 1) as f64);
        if length < n_wide {
            candidates.push(at((first + last) / 2.0));
        } else {
            let inset = n_wide as f64 / 2.0;
            let (right, left) = (first + inset, (last - inset).max(first + inset));
            candidates.extend([at(right), at(left)]);
            let past = (sectors.of(target) as f64 - right).rem_euclid(n as f64);
            if past <= left - right {
                candidates.push(target);
            }
        }
        start += length;
    }
    candidates
}

/// The sector whose nearest echo is the farthest.
pub(super) fn farthest(distances: &[f64]) -> usize {
    (0..distances.len()).max_by(|a, b| distances[*a].total_cmp(&distances[*b])).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECTORS: Sectors = Sectors(72);

    #[test]
    fn one_echo_blocks_by_hand() {
        // A disc of 0.5 m touches what is 1 m away at 90 degrees within asin(0.5) = 30 degrees: sectors 12 to 24.
        let echo = Polar { distance: 1.0, direction: FRAC_PI_2 };
        let distances = distances(SECTORS, [echo].into_iter(), 0.5);
        for (sector, distance) in distances.iter().enumerate() {
            let expected = if (12..=24).contains(&sector) { 1.0 } else { f64::INFINITY };
            assert_eq!(*distance, expected, "{sector}");
        }
    }

    #[test]
    fn what_touches_already_blocks_its_side() {
        let echo = Polar { distance: 0.3, direction: PI };
        let n = distances(SECTORS, [echo].into_iter(), 0.5).iter().filter(|d| d.is_finite()).count();
        assert_eq!(n, 37); // 90 degrees to both sides
    }

    #[test]
    fn turning_circles_by_hand() {
        // Circles of 1 m and a disc of 0.3 m: (0, 2.2) lies 1.2 m from (0, 1), in the way; (0, -2.4) lies 1.4 m from
        // (0, -1).
        let at = |x: f64, y: f64| Polar::of(&Vector2::new(x, y));
        let [right, left] = reachable(&[at(0.0, 2.2), at(0.0, -2.4)], 1.0, 0.3);
        assert_eq!((right, left), (-PI, FRAC_PI_2));
        // Straight ahead, 2 m away, nothing is in the way of a turn: sqrt(5) m from both centres.
        assert_eq!(reachable(&[at(2.0, 0.0)], 1.0, 0.3), [-PI, PI]);
    }

    fn free_between(valleys: &[(usize, usize)]) -> Vec<bool> {
        (0..72).map(|k| valleys.iter().any(|(first, last)| (*first..=*last).contains(&k))).collect()
    }

    fn degrees(directions: &[f64]) -> Vec<i64> {
        directions.iter().map(|direction| direction.to_degrees().round() as i64).collect()
    }

    #[test]
    fn valleys_by_hand() {
        // Narrow: sectors 4 to 8, 20 to 40 degrees. Wide: 30 to 60, candidates 8 sectors inside.
        let free = free_between(&[(4, 8), (30, 60)]);
        assert_eq!(degrees(&candidates(SECTORS, &free, 16, 0.0)), [30, -170, -100]);
        let target = 200_f64.to_radians();
        assert_eq!(degrees(&candidates(SECTORS, &free, 16, target)), [30, -170, -100, 200]);
    }

    #[test]
    fn a_valley_may_lie_across_the_first_sector() {
        // Sectors 68 to 74, of which 72 is 0: the middle is 71.
        let free = free_between(&[(0, 2), (68, 71)]);
        assert_eq!(degrees(&candidates(SECTORS, &free, 16, 1.0)), [-5]);
        assert_eq!(candidates(SECTORS, &[true; 72], 16, 1.0), [1.0]);
        assert!(candidates(SECTORS, &[false; 72], 16, 1.0).is_empty());
    }
}
