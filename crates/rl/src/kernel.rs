//! Matrix products and vector instructions on the calling thread: the one module of the crate with unsafe code.
//!
//! Candle multiplies through the same `gemm` crate, but asks for the number of threads before every product. Where
//! `RAYON_NUM_THREADS` is not set that reads `/proc/cpuinfo`, which took longer (17 us) than the product itself, and
//! then spreads products over threads that are too small to gain by it.
#![allow(unsafe_code, reason = "gemm takes raw pointers, and processors differ: bounds and features are checked first")]

/// A matrix view of numbers in memory.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Matrix<'a> {
    values: &'a [f32],
    n_rows: usize,
    n_columns: usize,
    row_stride: usize,
    column_stride: usize,
}

impl<'a> Matrix<'a> {
    /// Row-major numbers as rows of `n_columns`.
    ///
    /// # Panics
    /// If `n_columns` is zero or the numbers are no whole rows.
    pub(crate) fn new(values: &'a [f32], n_columns: usize) -> Self {
        assert_eq!(values.len() % n_columns, 0, "whole rows");
        Self { values, n_rows: values.len() / n_columns, n_columns, row_stride: n_columns, column_stride: 1 }
    }

    /// The transpose of the same numbers.
    pub(crate) fn t(self) -> Self {
        Self {
            n_rows: self.n_columns,
            n_columns: self.n_rows,
            row_stride: self.column_stride,
            column_stride: self.row_stride,
            ..self
        }
    }
}

/// The product of two matrices, row-major, into `c`: `[a.n_rows, b.n_columns]`, whatever it held.
///
/// # Panics
/// If the shapes do not agree.
pub(crate) fn matmul(a: Matrix<'_>, b: Matrix<'_>, c: &mut [f32]) {
    let (m, n, k) = (a.n_rows, b.n_columns, a.n_columns);
    assert_eq!(b.n_rows, k, "inner sizes agree");
    assert_eq!(c.len(), m * n, "the result has the outer sizes");
    if m == 1 && a.column_stride == 1 && b.column_stride == 1 {
        return vectorised(RowTimesMatrix { x: a.values, w: b.values, y: c });
    }
    // SAFETY: `a` and `b` hold `n_rows * n_columns` numbers, by `Matrix::new` and kept by `t`, and their strides visit
    // each once; `c` holds `m * n` numbers, by the assertion above, and is borrowed mutably, so nothing overlaps it.
    // All are initialised. The strides fit `isize`, since slices are no longer than `isize::MAX` bytes.
    unsafe {
        gemm::gemm(
            m,
            n,
            k,
            c.as_mut_ptr(),
            1,
            n as isize,
            false,
            a.values.as_ptr(),
            a.column_stride as isize,
            a.row_stride as isize,
            b.values.as_ptr(),
            b.column_stride as isize,
            b.row_stride as isize,
            1.0,
            1.0,
            false,
            false,
            false,
            gemm::Parallelism::None,
        );
    }
}

/// `y = x w` for one row: what acting on one observation takes. With general products a decision takes twice as long.
///
/// Columns are done in panels whose sums stay in registers. The last panel of a size may overlap the one before it, as
/// computing a sum twice costs less than a narrower panel.
struct RowTimesMatrix<'a> {
    x: &'a [f32],
    w: &'a [f32],
    y: &'a mut [f32],
}

impl Loop for RowTimesMatrix<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { x, w, y } = self;
        let n = y.len();
        let mut begin = 0;
        while begin < n {
            begin = match n - begin {
                64.. => panel::<64>(x, w, y, begin),
                _ if n >= 16 => panel::<16>(x, w, y, begin.min(n - 16)),
                _ if n >= 8 => panel::<8>(x, w, y, begin.min(n - 8)),
                _ => panel::<1>(x, w, y, begin),
            };
        }
    }
}

/// Columns `begin..begin + WIDTH` of `y = x w`; returns where they end.
#[inline(always)]
fn panel<const WIDTH: usize>(x: &[f32], w: &[f32], y: &mut [f32], begin: usize) -> usize {
    let columns = begin..begin + WIDTH;
    let mut sums = [0.0; WIDTH];
    for (x, row) in x.iter().zip(w.chunks_exact(y.len())) {
        sums.iter_mut().zip(&row[columns.clone()]).for_each(|(sum, w)| *sum += x * w);
    }
    y[columns.clone()].copy_from_slice(&sums);
    columns.end
}

/// A loop that gains by vector instructions.
pub(crate) trait Loop {
    /// What it returns.
    type Output;

    /// Runs it. Must be `#[inline(always)]`, and so must the functions that it calls: what is compiled on its own is
    /// compiled for every processor.
    fn run(self) -> Self::Output;
}

/// Runs a loop compiled for AVX2 where the processor has it; AVX-512 gained nothing further.
///
/// The compiler may use wider registers, but neither reorders nor fuses operations, so that the numbers are the same on
/// every machine.
#[inline]
pub(crate) fn vectorised<L: Loop>(run: L) -> L::Output {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has the feature.
        return unsafe { with_avx2(run) };
    }
    run.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<L: Loop>(run: L) -> L::Output {
    run.run()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn products_by_hand() {
        let (a, b) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [1.0, 0.0, -1.0]);
        let mut c = [f32::NAN; 2];
        matmul(Matrix::new(&a, 3), Matrix::new(&b, 1), &mut c);
        assert_eq!(c, [-2.0, -2.0]);
        let mut c = [f32::NAN; 3];
        matmul(Matrix::new(&a, 3).t(), Matrix::new(&[1.0, 1.0], 1), &mut c);
        assert_eq!(c, [5.0, 7.0, 9.0]);
    }

    #[test]
    #[should_panic(expected = "inner sizes agree")]
    fn shapes_are_checked() {
        matmul(Matrix::new(&[0.0; 6], 3), Matrix::new(&[0.0; 2], 1), &mut [0.0; 2]);
    }

    fn numbers(n: usize) -> impl Strategy<Value = Vec<f32>> {
        prop::collection::vec(-1.0..1.0f32, n)
    }

    /// Sizes on both sides of every panel and vector, with one row as often as several.
    fn sizes() -> impl Strategy<Value = (usize, usize, usize)> {
        (prop_oneof![Just(1), 1..40usize], 1..150usize, 1..50usize)
    }

    proptest! {
        #[test]
        fn vector_instructions_change_no_bit(x in numbers(30), w in numbers(30 * 77)) {
            let [mut plain, mut wide] = [[f32::NAN; 77]; 2];
            RowTimesMatrix { x: &x, w: &w, y: &mut plain }.run();
            vectorised(RowTimesMatrix { x: &x, w: &w, y: &mut wide });
            prop_assert_eq!(plain, wide);
        }

        #[test]
        fn products_equal_three_loops(
            (m, n, k, a, b) in
                sizes().prop_flat_map(|(m, n, k)| (Just(m), Just(n), Just(k), numbers(m * k), numbers(k * n))),
            transpose in any::<[bool; 2]>(),
        ) {
            // The same numbers, read as k by m or m by k, and as n by k or k by n.
            let left = if transpose[0] { Matrix::new(&a, m).t() } else { Matrix::new(&a, k) };
            let right = if transpose[1] { Matrix::new(&b, k).t() } else { Matrix::new(&b, n) };
            let mut c = vec![f32::NAN; m * n];
            matmul(left, right, &mut c);
            for i in 0..m {
                for j in 0..n {
                    let a = |l: usize| f64::from(if transpose[0] { a[l * m + i] } else { a[i * k + l] });
                    let b = |l: usize| f64::from(if transpose[1] { b[j * k + l] } else { b[l * n + j] });
                    let expected: f64 = (0..k).map(|l| a(l) * b(l)).sum();
                    prop_assert!((f64::from(c[i * n + j]) - expected).abs() < 1e-4);
                }
            }
        }
    }
}
