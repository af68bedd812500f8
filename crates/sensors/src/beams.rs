//! The beams of a scan as the kernel reads them.

/// Beams a block: what the kernel works on at once.
pub(crate) const LANES: usize = 16;

/// The beams' directions in whole blocks, padded at the end.
#[derive(Debug, Clone)]
pub(crate) struct Beams {
    /// Cosines of the directions.
    pub(crate) cos: Vec<[f32; LANES]>,
    /// Sines of the directions.
    pub(crate) sin: Vec<[f32; LANES]>,
    n_beams: usize,
    first_angle: f32,
    per_radian: f32,
    is_ring: bool,
}

/// Blocks to paint: a run, and where it goes round the end, a second one from the start.
pub(crate) type Span = [std::ops::Range<usize>; 2];

impl Beams {
    /// Scans of so few blocks are painted whole: to find out where costs more than to paint.
    const WHOLE: usize = 8;
    /// More than the error of [`atan2`] and of a span's rounding, radians.
    const SLACK: f32 = 2e-3;

    pub(crate) fn new(angles: &[f64], is_ring: bool) -> Self {
        let blocks = |value: fn(f64) -> f64| {
            let block = |chunk: &[f64]| {
                let mut lanes = [0.0; LANES];
                lanes.iter_mut().zip(chunk).for_each(|(lane, angle)| *lane = value(*angle) as f32);
                lanes
            };
            angles.chunks(LANES).map(block).collect()
        };
        let spacing = if angles.len() > 1 { angles[1] - angles[0] } else { 1.0 };
        Self {
            cos: blocks(f64::cos),
            sin: blocks(f64::sin),
            n_beams: angles.len(),
            first_angle: angles[0] as f32,
            per_radian: (1.0 / spacing) as f32,
            is_ring,
        }
    }

    pub(crate) fn n_blocks(&self) -> usize {
        self.cos.len()
    }

    /// All blocks.
    #[inline(always)]
    fn whole(&self) -> Span {
        [0..self.n_blocks(), 0..0]
    }

    /// Blocks that hold every beam between the directions of two points, counter-clockwise from the first; they may hold
    /// more.
    #[inline(always)]
    pub(crate) fn between(&self, right: [f32; 2], left: [f32; 2]) -> Span {
        if self.n_blocks() <= Self::WHOLE {
            return self.whole();
        }
        let from = atan2(right[1], right[0]);
        let mut to = atan2(left[1], left[0]);
        if to < from {
            to += std::f32::consts::TAU;
        }
        self.span(from, to)
    }

    /// Blocks that hold every beam that may hit a disc; they may hold more.
    #[inline(always)]
    pub(crate) fn around(&self, center: [f32; 2], distance: f32, radius: f32) -> Span {
        if self.n_blocks() <= Self::WHOLE {
            return self.whole();
        }
        if radius >= distance {
            return self.whole(); // from within
        }
        let ratio = radius / distance;
        // From above: asin(x) <= x + (pi / 2 - 1) x^3 on [0, 1].
        let half_width = ratio + (std::f32::consts::FRAC_PI_2 - 1.0) * ratio * ratio * ratio;
        let middle = atan2(center[1], center[0]);
        self.span(middle - half_width, middle + half_width)
    }

    /// Blocks that hold every beam from one angle to another, at most a turn and a half apart.
    #[inline(always)]
    fn span(&self, from: f32, to: f32) -> Span {
        let index = |angle: f32| (angle - self.first_angle) * self.per_radian;
        let first = floor(index(from - Self::SLACK)) + 1;
        let last = floor(index(to + Self::SLACK));
        if last < first {
            return [0..0, 0..0];
        }
        let n = self.n_beams as i32;
        let turn = if self.is_ring { n } else { (std::f32::consts::TAU * self.per_radian) as i32 };
        if last - first >= turn - 1 {
            return self.whole();
        }
        // The same beams a turn earlier or later: at most two of the three lie on the scan.
        let mut runs = [-turn, 0, turn].into_iter().filter_map(|shift| {
            let (first, last) = (
                (first + shift - i32::from(!self.is_ring)).max(0),
                (last + shift + i32::from(!self.is_ring)).min(n - 1),
            );
            (first <= last).then(|| first as usize / LANES..last as usize / LANES + 1)
        });
        [runs.next().unwrap_or(0..0), runs.next().unwrap_or(0..0)]
    }
}

/// The greatest integer not above `x`, without a call into the mathematics library.
#[inline(always)]
fn floor(x: f32) -> i32 {
    let truncated = x as i32;
    truncated - i32::from(truncated as f32 > x)
}

/// The angle of a direction in (-pi, pi], within 1.5e-3 (Rajan et al. 2006, "Efficient approximations for the arctangent
/// function", eq. 9).
#[inline(always)]
fn atan2(y: f32, x: f32) -> f32 {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};
    let (ax, ay) = (x.abs(), y.abs());
    let is_steep = ay > ax;
    let ratio = if is_steep { ax / ay } else { ay / ax.max(f32::MIN_POSITIVE) };
    let angle = FRAC_PI_4 * ratio + ratio * (1.0 - ratio) * (0.2447 + 0.0663 * ratio);
    let angle = if is_steep { FRAC_PI_2 - angle } else { angle };
    let angle = if x < 0.0 { PI - angle } else { angle };
    if y < 0.0 { -angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam_angles;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    #[test]
    fn the_fast_arctangent_is_near_enough() {
        for k in 0..100_000 {
            let angle = f64::from(k) / 100_000.0 * TAU - TAU / 2.0;
            let error = f64::from(atan2(angle.sin() as f32, angle.cos() as f32)) - angle;
            assert!(error.abs().min((error.abs() - TAU).abs()) < f64::from(Beams::SLACK) - 4e-4, "{angle}: {error}");
        }
    }

    proptest! {
        #[test]
        fn spans_hold_every_beam_between(
            n_beams in 130..1200_usize, field in prop_oneof![Just(TAU), 0.3..6.0], right in -3.1..3.1, width in 0.0..3.0,
        ) {
            let angles = beam_angles(n_beams, field);
            let beams = Beams::new(&angles, field == TAU);
            let point = |angle: f64| [angle.cos() as f32, angle.sin() as f32];
            let span = beams.between(point(right), point(right + width));
            for (k, angle) in angles.iter().enumerate() {
                if (angle - right).rem_euclid(TAU) <= width {
                    prop_assert!(span.iter().any(|run| run.contains(&(k / LANES))), "beam {k} at {angle}: {span:?}");
                }
            }
        }
    }
}
