//! Which circles are near a point, for all at once: the one module of the crate with unsafe code.
//!
//! Neither way reorders or fuses operations, so that the answers are the same on every machine.
#![allow(unsafe_code, reason = "instructions for wider vectors may be used only where the processor has them")]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{
    __m512d, _CMP_LE_OQ, _mm512_add_pd, _mm512_cmp_pd_mask, _mm512_loadu_pd, _mm512_mul_pd, _mm512_set1_pd,
    _mm512_setzero_pd, _mm512_sub_pd,
};

use crate::Point;

/// Circles a block.
pub(super) const LANES: usize = 8;

/// A block of circles, as arrays of numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) x: [f64; LANES],
    pub(super) y: [f64; LANES],
    pub(super) radius: [f64; LANES],
}

impl Block {
    /// Circles that are infinitely far from everything.
    pub(super) const EMPTY: Self = Self { x: [f64::INFINITY; LANES], y: [0.0; LANES], radius: [0.0; LANES] };

    /// Whether a circle comes within `reach` of a point, which with its radius must not be below 0.
    #[inline]
    pub(super) fn is_near(&self, lane: usize, point: &Point, reach: f64) -> bool {
        self.excess(lane, point, reach) <= 0.0
    }

    /// How much too far off a circle is, squared metres: no root is taken. With a reach of 0, the power of the point with
    /// respect to the circle.
    #[inline]
    pub(super) fn excess(&self, lane: usize, point: &Point, reach: f64) -> f64 {
        let (x, y, reach) = (self.x[lane] - point.x, self.y[lane] - point.y, reach + self.radius[lane]);
        x * x + y * y - reach * reach
    }
}

/// The circles that come within `reach` of a point, as the bits of a number from the lowest on.
///
/// # Panics
/// If there are more blocks than fit into the bits.
pub(super) fn near(blocks: &[Block], point: &Point, reach: f64) -> u32 {
    assert!(blocks.len() * LANES <= u32::BITS as usize, "a bit for each circle");
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx512f") {
        // SAFETY: the processor has AVX-512F.
        return unsafe { near_avx512(blocks, point, reach) };
    }
    near_portable(blocks, point, reach)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn near_avx512(blocks: &[Block], point: &Point, reach: f64) -> u32 {
    let mut all = 0;
    for (number, block) in blocks.iter().enumerate() {
        let excess = excess_avx512(block, point, reach);
        all |= u32::from(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(excess, _mm512_setzero_pd())) << (LANES * number);
    }
    all
}

/// [`Block::excess`] of all eight circles.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn excess_avx512(block: &Block, point: &Point, reach: f64) -> __m512d {
    // SAFETY: an array of eight numbers is as long as a vector, and unaligned loads may start anywhere.
    let load = |numbers: &[f64; LANES]| unsafe { _mm512_loadu_pd(numbers.as_ptr()) };
    let x = _mm512_sub_pd(load(&block.x), _mm512_set1_pd(point.x));
    let y = _mm512_sub_pd(load(&block.y), _mm512_set1_pd(point.y));
    let reach = _mm512_add_pd(_mm512_set1_pd(reach), load(&block.radius));
    let squared = _mm512_add_pd(_mm512_mul_pd(x, x), _mm512_mul_pd(y, y));
    _mm512_sub_pd(squared, _mm512_mul_pd(reach, reach))
}

/// In vectors of whatever width every processor has: the least excess of a block first, which most often is enough.
fn near_portable(blocks: &[Block], point: &Point, reach: f64) -> u32 {
    let mut all = 0;
    for (number, block) in blocks.iter().enumerate() {
        let mut least = [f64::INFINITY; LANES / 2];
        for (lane, least) in least.iter_mut().enumerate() {
            let (a, b) = (block.excess(lane, point, reach), block.excess(lane + LANES / 2, point, reach));
            *least = if b < a { b } else { a };
        }
        if least.iter().any(|excess| *excess <= 0.0) {
            for lane in 0..LANES {
                all |= u32::from(block.is_near(lane, point, reach)) << (LANES * number + lane);
            }
        }
    }
    all
}

/// The circle of which a point has the least power, the first among equals: very likely the nearest. None where there are
/// no circles. (In AVX-512 it took longer.)
pub(super) fn likely_nearest(blocks: &[Block], point: &Point) -> Option<usize> {
    let mut best = (f64::INFINITY, None);
    for (number, block) in blocks.iter().enumerate() {
        let powers: [f64; LANES] = std::array::from_fn(|lane| block.excess(lane, point, 0.0));
        let least = powers.iter().fold(f64::INFINITY, |a, b| if *b < a { *b } else { a });
        if least < best.0 {
            let lane = powers.iter().position(|power| *power == least);
            best = (least, lane.map(|lane| LANES * number + lane));
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn all_instructions_find_the_circles_that_distances_tell(
            circles in prop::collection::vec((-5.0..5.0, -5.0..5.0, 0.0..1.0), 0..=32),
            reach in prop_oneof![0.0..5.0, Just(0.0), Just(f64::INFINITY)],
        ) {
            let mut blocks = vec![Block::EMPTY; circles.len().div_ceil(LANES)];
            for (i, (x, y, radius)) in circles.iter().enumerate() {
                let (block, lane) = (&mut blocks[i / LANES], i % LANES);
                (block.x[lane], block.y[lane], block.radius[lane]) = (*x, *y, *radius);
            }
            let point = Point::new(0.3, -0.7);
            let power = |(x, y, r): &(f64, f64, f64)| (x - point.x).powi(2) + (y - point.y).powi(2) - r * r;
            let least = circles.iter().map(power).min_by(f64::total_cmp);
            prop_assert_eq!(likely_nearest(&blocks, &point).map(|i| power(&circles[i])), least);
            let found = near(&blocks, &point, reach);
            prop_assert_eq!(found, near_portable(&blocks, &point, reach));
            for (i, (x, y, radius)) in circles.iter().enumerate() {
                let gap = (x - point.x).hypot(y - point.y) - radius;
                prop_assert!((gap - reach).abs() < 1e-12 || (gap < reach) == (found >> i & 1 == 1));
            }
            prop_assert!(circles.len() == 32 || found >> circles.len() == 0, "what pads is never near");
        }
    }
}
