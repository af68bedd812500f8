//! At which discounts something holds.

/// Discounts that are tried: `1 - gamma` falls from 0.99 by equal ratios to 1e-5.
const N_TRIED: usize = 400;
const LEAST: f64 = 1e-5;
const MOST: f64 = 0.99;

/// The intervals of gamma in [0, 1] in which `holds`; one shorter than the distance of two discounts that are tried, about
/// 3 % of `1 - gamma`, may be missed. What holds at the first or the last discount that is tried is taken to hold up to 0 or 1.
pub(super) fn intervals(holds: impl Fn(f64) -> bool) -> Vec<[f64; 2]> {
    let tried = (0..N_TRIED).map(|k| 1.0 - MOST * (LEAST / MOST).powf(k as f64 / (N_TRIED - 1) as f64));
    let mut intervals: Vec<[f64; 2]> = Vec::new();
    let mut before = (0.0, false);
    for gamma in tried {
        let here = holds(gamma);
        match (before.1, here) {
            (false, true) if before.0 == 0.0 => intervals.push([0.0, 1.0]),
            (false, true) => intervals.push([change(before.0, gamma, &holds), 1.0]),
            (true, false) => {
                if let Some(last) = intervals.last_mut() {
                    last[1] = change(gamma, before.0, &holds);
                }
            }
            _ => {}
        }
        before = (gamma, here);
    }
    intervals
}

/// Where it comes to hold on the way from `not`, where it does not, to `yes`, where it does: by bisection.
fn change(mut not: f64, mut yes: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = f64::midpoint(not, yes);
        *(if holds(middle) { &mut yes } else { &mut not }) = middle;
    }
    yes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_end_where_it_changes() {
        assert!(intervals(|_| false).is_empty());
        assert_eq!(intervals(|_| true), [[0.0, 1.0]]);
        let found = intervals(|gamma| gamma < 0.25 || (0.5..0.75).contains(&gamma) || gamma > 0.999);
        let expected = [[0.0, 0.25], [0.5, 0.75], [0.999, 1.0]];
        assert_eq!(found.len(), 3);
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
