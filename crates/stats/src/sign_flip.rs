//! Whether paired differences can be told from luck.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Most differences other than 0 of which all ways to turn their signs are looked at.
const MOST_EXACT: usize = 20;
/// Ways that are drawn of more differences.
const N_DRAWN: usize = 1 << 17;

/// The two-sided p value of the sign-flip test for paired differences (Fisher, 1935, *The Design of Experiments*, section 21; Pitman,
/// 1937): in which share of the `2^n` ways to turn their signs their sum is at least as far from 0 as it is.
///
/// If X and Y are drawn alike, each sign is as likely as the other, and p is at most 0.05 in at most 5 % of all comparisons, however
/// few the units: with fewer than six it never is. Percentile intervals of few units leave out 0 more often than that. Exact for up
/// to 20 differences other than 0, which is what counts; above, of 131 072 ways drawn from a fixed stream. 1 where there is none.
///
/// ```
/// use headway_stats::sign_flip;
///
/// // All of one sign: of the 64 ways only this one and its opposite are as far.
/// assert_eq!(sign_flip(&[0.1, 0.4, 0.2, 0.3, 0.1, 0.2]), 2.0 / 64.0);
/// assert_eq!(sign_flip(&[3.0, -1.0, 0.0]), 1.0); // 2 is as near to 0 as it gets
/// ```
#[must_use]
pub fn sign_flip(differences: &[f64]) -> f64 {
    let moved: Vec<f64> = differences.iter().copied().filter(|difference| *difference != 0.0).collect();
    let total: f64 = moved.iter().map(|difference| difference.abs()).sum();
    // Sums that are equal but for rounding count as equal.
    let far = moved.iter().sum::<f64>().abs() - 1e-9 * total;
    match moved.len() {
        0 => 1.0,
        n if n <= MOST_EXACT => share_of_all(&moved, far),
        _ => share_of_drawn(&moved, far),
    }
}

/// The share of all ways whose sum is at least `far` from 0: half of them, with the first sign as it is, stand for their opposites.
fn share_of_all(moved: &[f64], far: f64) -> f64 {
    let n_ways = 1_u32 << (moved.len() - 1);
    let mut turned = moved.to_vec();
    let mut sum: f64 = turned.iter().sum();
    let mut n_far = u32::from(sum.abs() >= far);
    for way in 1..n_ways {
        // A Gray code: one sign turns at a time.
        let place = way.trailing_zeros() as usize + 1;
        turned[place] = -turned[place];
        sum += 2.0 * turned[place];
        n_far += u32::from(sum.abs() >= far);
    }
    f64::from(n_far) / f64::from(n_ways)
}

/// The share of drawn ways; the one that was observed is one of them.
fn share_of_drawn(moved: &[f64], far: f64) -> f64 {
    let mut rng = ChaCha8Rng::from_seed(*b"headway sign flips of pairs  v1 ");
    let is_far = |rng: &mut ChaCha8Rng| {
        let signs = moved.chunks(64).map(|some| (some, rng.next_u64()));
        let sums = signs.map(|(some, bits)| {
            some.iter().enumerate().map(|(k, d)| if bits >> k & 1 == 1 { *d } else { -d }).sum::<f64>()
        });
        sums.sum::<f64>().abs() >= far
    };
    let n_far = (0..N_DRAWN).filter(|_| is_far(&mut rng)).count();
    (n_far + 1) as f64 / (N_DRAWN + 1) as f64
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Every way, one sum at a time.
    fn obvious(differences: &[f64]) -> f64 {
        let sum = |way: usize| -> f64 {
            differences.iter().enumerate().map(|(k, d)| if way >> k & 1 == 0 { *d } else { -d }).sum()
        };
        let n_ways = 1 << differences.len();
        let n_far = (0..n_ways).filter(|way| sum(*way).abs() >= sum(0).abs() - 1e-9).count();
        n_far as f64 / n_ways as f64
    }

    #[test]
    fn worked_by_hand() {
        assert_eq!(sign_flip(&[]), 1.0);
        assert_eq!(sign_flip(&[0.0, 0.0, 0.0]), 1.0);
        assert_eq!(sign_flip(&[1.0, 2.0, 4.0]), 0.25); // 7 of +-7, +-5, +-3, +-1
        assert_eq!(sign_flip(&[-1.0, 2.0, 4.0]), 0.5); // 5 and 7
        assert_eq!(sign_flip(&[1.0, 1.0, -1.0]), 1.0); // all of them are at least 1 from 0
    }

    proptest! {
        #[test]
        fn it_is_the_share_of_all_ways(differences in prop::collection::vec(-3..=3_i8, 0..10)) {
            let differences: Vec<f64> = differences.into_iter().map(|d| f64::from(d) / 10.0).collect();
            prop_assert!((sign_flip(&differences) - obvious(&differences)).abs() < 1e-12);
        }
    }

    #[test]
    fn drawn_ways_come_near_all_of_them() {
        let differences: Vec<f64> = (0..16).map(|k| f64::from(k % 7) - 1.9).collect();
        let total: f64 = differences.iter().map(|d| d.abs()).sum();
        let far = differences.iter().sum::<f64>().abs() - 1e-9 * total;
        let (exact, drawn) = (share_of_all(&differences, far), share_of_drawn(&differences, far));
        let error = (exact * (1.0 - exact) / N_DRAWN as f64).sqrt();
        assert!((0.01..0.5).contains(&exact) && (exact - drawn).abs() < 4.0 * error, "{exact} {drawn}");
    }
}
