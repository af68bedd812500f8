//! Outlines as convex parts.

use nalgebra::Vector2;
use parry2d::math::Vector;
use parry2d::transformation::hertel_mehlhorn;

use crate::Point;

/// Convex parts, counter-clockwise, that together cover a simple outline's area (Hertel and Mehlhorn 1983, at most four
/// times as many as needed); the outline itself, corner by corner, if it is convex.
///
/// Its last point may repeat the first; either orientation will do.
///
/// # Errors
/// Says what an outline must be.
pub(super) fn convex(mut outline: Vec<Point>) -> Result<Vec<Vec<Point>>, &'static str> {
    outline.dedup();
    if outline.len() > 1 && outline.first() == outline.last() {
        outline.pop();
    }
    if outline.len() < 3 {
        return Err("three different points or more");
    }
    if !is_simple(&outline) {
        return Err("an outline that does not meet itself");
    }
    if area(&outline) < 0.0 {
        outline.reverse();
    }
    if (0..outline.len()).all(|i| turn(&outline, [i, i + 1, i + 2]) >= 0.0) {
        return Ok(vec![outline]);
    }
    let triangles = triangles(&outline).ok_or("an outline around an area")?;
    let vertices: Vec<_> = outline.iter().map(|p| Vector::new(p.x, p.y)).collect();
    let parts = hertel_mehlhorn(&vertices, &triangles);
    Ok(parts.iter().map(|part| part.iter().map(|v| Point::new(v.x, v.y)).collect()).collect())
}

fn area(outline: &[Point]) -> f64 {
    let first = outline[0];
    outline.windows(2).map(|ab| (ab[0] - first).perp(&(ab[1] - first)) / 2.0).sum()
}

/// Twice the area of the triangle of three corners: above 0 for a left turn.
fn turn(outline: &[Point], corners: [usize; 3]) -> f64 {
    let [a, b, c] = corners.map(|i| outline[i % outline.len()]);
    (b - a).perp(&(c - b))
}

/// Whether no two edges meet but neighbours in their common corner.
fn is_simple(outline: &[Point]) -> bool {
    let n = outline.len();
    let edge = |i: usize| (outline[i], outline[(i + 1) % n]);
    let neighbours = |i: usize, j: usize| j == i + 1 || (i == 0 && j == n - 1);
    let folds_back = |i: usize| {
        let [a, b, c] = [0, 1, 2].map(|k| outline[(i + k) % n]);
        (b - a).perp(&(c - b)) == 0.0 && (b - a).dot(&(c - b)) < 0.0
    };
    !(0..n).any(folds_back) && (0..n).all(|i| (i + 1..n).all(|j| neighbours(i, j) || !segments_meet(edge(i), edge(j))))
}

fn segments_meet((a, b): (Point, Point), (c, d): (Point, Point)) -> bool {
    let side = |p: &Point, q: &Point, r: &Point| {
        let turn = (q - p).perp(&(r - p));
        if turn == 0.0 { 0.0 } else { turn.signum() }
    };
    let within = |p: &Point, q: &Point, r: &Point| -> bool { Vector2::dot(&(p - r), &(q - r)) <= 0.0 };
    let [abc, abd, cda, cdb] = [side(&a, &b, &c), side(&a, &b, &d), side(&c, &d, &a), side(&c, &d, &b)];
    (abc * abd < 0.0 && cda * cdb < 0.0)
        || (abc == 0.0 && within(&a, &b, &c))
        || (abd == 0.0 && within(&a, &b, &d))
        || (cda == 0.0 && within(&c, &d, &a))
        || (cdb == 0.0 && within(&c, &d, &b))
}

/// Triangles of a simple counter-clockwise outline: ears are cut off (Meisters 1975).
fn triangles(outline: &[Point]) -> Option<Vec<[u32; 3]>> {
    let mut left: Vec<usize> = (0..outline.len()).collect();
    let mut found = Vec::with_capacity(outline.len());
    while left.len() > 3 {
        let n = left.len();
        let corner = |i: usize| [left[(i + n - 1) % n], left[i], left[(i + 1) % n]];
        // A corner that does not turn is cut off without a triangle.
        let i = (0..n).find(|i| turn(outline, corner(*i)) == 0.0 || is_ear(outline, &left, corner(*i)))?;
        if turn(outline, corner(i)) > 0.0 {
            found.push(corner(i).map(|k| k as u32));
        }
        left.remove(i);
    }
    let last = [left[0], left[1], left[2]];
    if turn(outline, last) > 0.0 {
        found.push(last.map(|k| k as u32));
    }
    (!found.is_empty()).then_some(found)
}

/// Whether a corner turns left and no other corner lies in its triangle.
fn is_ear(outline: &[Point], left: &[usize], [a, b, c]: [usize; 3]) -> bool {
    let holds = |p: usize| [[a, b, p], [b, c, p], [c, a, p]].iter().all(|side| turn(outline, *side) >= 0.0);
    turn(outline, [a, b, c]) > 0.0 && !left.iter().any(|p| ![a, b, c].contains(p) && holds(*p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn outline(corners: &[[f64; 2]]) -> Vec<Point> {
        corners.iter().copied().map(Point::from).collect()
    }

    #[test]
    fn an_l_becomes_two_parts_of_its_area() {
        let l = outline(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0], [0.0, 0.0]]);
        for corners in [l.clone(), l.into_iter().rev().collect()] {
            let parts = convex(corners).unwrap();
            assert_eq!(parts.len(), 2);
            assert!((parts.iter().map(|part| area(part)).sum::<f64>() - 3.0).abs() < 1e-12);
        }
    }

    #[test]
    fn outlines_that_are_none() {
        for (corners, why) in [
            (vec![[0.0, 0.0], [1.0, 0.0]], "three"),
            (vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]], "meet itself"),
            (vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], "meet itself"),
            (vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0]], "meet itself"),
        ] {
            assert!(convex(outline(&corners)).unwrap_err().contains(why), "{corners:?}");
        }
    }

    proptest! {
        #[test]
        fn the_parts_of_a_star_are_convex_and_cover_its_area(radii in prop::collection::vec(0.2..3.0_f64, 3..40)) {
            let n = radii.len() as f64;
            let corner = |(k, r): (usize, &f64)| {
                let (sin, cos) = (k as f64 / n * std::f64::consts::TAU).sin_cos();
                Point::new(r * cos, r * sin)
            };
            let star: Vec<_> = radii.iter().enumerate().map(corner).collect();
            let parts = convex(star.clone()).unwrap();
            for part in &parts {
                prop_assert!((0..part.len()).all(|i| turn(part, [i, i + 1, i + 2]) >= -1e-12));
            }
            let sum: f64 = parts.iter().map(|part| area(part)).sum();
            prop_assert!((sum - area(&star)).abs() < 1e-9);
        }
    }
}
