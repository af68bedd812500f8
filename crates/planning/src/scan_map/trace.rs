//! The cells along a line.

use nalgebra::Vector2;

/// Calls `visit` with the index `row * n_x + column` of every cell that the line from `start` to `end`, in units of cells,
/// passes through: some twice, and where the line passes exactly through a corner, perhaps a cell that it only touches.
///
/// The same cells as a walk from border to border (Amanatides and Woo 1987), found from column to column instead (from
/// row to row where the line is steep): within a column a line that is not steep passes through two cells at most, those in which it
/// enters and leaves, and no column waits for the one before it. Rows are kept as fixed-point numbers of 32 binary
/// digits.
#[inline]
pub(super) fn walk(start: &Vector2<f64>, end: &Vector2<f64>, n_x: usize, mut visit: impl FnMut(usize)) {
    let d = end - start;
    let is_flat = d.x.abs() >= d.y.abs();
    let n_x = n_x as isize;
    // a runs along, b across.
    let (a, b, da, db, stride_a, stride_b) =
        if is_flat { (start.x, start.y, d.x, d.y, 1, n_x) } else { (start.y, start.x, d.y, d.x, n_x, 1) };
    let slope = if da == 0.0 { 0.0 } else { db / da.abs() };
    let to_border = if da > 0.0 { a.floor() + 1.0 - a } else { a - a.floor() };
    let n_borders = ((a + da).floor() - a.floor()).abs() as usize;
    let fixed = |x: f64| (x * ONE) as i64;
    let index = |along: isize, across: i64| (along + (across >> 32) as isize * stride_b) as usize;
    let mut along = a.floor() as isize * stride_a;
    let (mut enter, mut leave, rise) = (fixed(b), fixed(b + slope * to_border), fixed(slope));
    let stride = if da > 0.0 { stride_a } else { -stride_a };
    for _ in 0..n_borders {
        visit(index(along, enter));
        visit(index(along, leave));
        along += stride;
        (enter, leave) = (leave, leave + rise);
    }
    visit(index(along, enter));
    visit(index(along, fixed(b + db)));
}

const ONE: f64 = 4_294_967_296.0;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        /// Against asking every cell: all that the line passes through, and none that it does not touch.
        #[test]
        fn cells_are_those_the_line_passes_through(
            (ax, ay, bx, by) in (1.0..99.0_f64, 1.0..99.0_f64, 1.0..99.0_f64, 1.0..99.0_f64),
        ) {
            let (a, b) = (Vector2::new(ax, ay), Vector2::new(bx, by));
            let mut walked = vec![false; 100 * 100];
            walk(&a, &b, 100, |index| walked[index] = true);
            for (index, &is_walked) in walked.iter().enumerate() {
                let corner = Vector2::new((index % 100) as f64, (index / 100) as f64);
                let meets = |grow: f64| line_meets_box(&a, &b, &corner.add_scalar(-grow), &corner.add_scalar(1.0 + grow));
                prop_assert!(is_walked || !meets(-1e-6), "the cell at {corner:?} is left out");
                prop_assert!(!is_walked || meets(1e-6), "the cell at {corner:?} is not on the line");
            }
        }
    }

    /// Whether the line from `a` to `b` has a point in the box: the part of it between the box's sides along x and the part
    /// between those along y overlap.
    fn line_meets_box(a: &Vector2<f64>, b: &Vector2<f64>, low: &Vector2<f64>, high: &Vector2<f64>) -> bool {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let (from, step) = (a[axis], b[axis] - a[axis]);
            if step == 0.0 {
                if from < low[axis] || high[axis] < from {
                    return false;
                }
                continue;
            }
            let (t, u) = ((low[axis] - from) / step, (high[axis] - from) / step);
            (enter, leave) = (enter.max(t.min(u)), leave.min(t.max(u)));
        }
        enter <= leave
    }

    #[test]
    fn points_and_lines_along_the_axes() {
        let cells = |a: [f64; 2], b: [f64; 2]| {
            let mut cells = BTreeSet::new();
            walk(&a.into(), &b.into(), 10, |index| {
                cells.insert(index);
            });
            cells.into_iter().collect::<Vec<_>>()
        };
        assert_eq!(cells([1.5, 2.5], [1.5, 2.5]), [21]);
        assert_eq!(cells([1.5, 2.5], [4.5, 2.5]), [21, 22, 23, 24]);
        assert_eq!(cells([4.5, 2.5], [1.5, 2.5]), [21, 22, 23, 24]);
        assert_eq!(cells([1.5, 4.5], [1.5, 2.5]), [21, 31, 41]);
        assert_eq!(cells([1.2, 1.5], [3.2, 2.5]), [11, 12, 22, 23]);
    }
}
