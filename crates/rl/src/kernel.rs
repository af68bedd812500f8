//! Matrix products on the calling thread: the one module of the crate with unsafe code.
//!
//! Candle multiplies through the same `gemm` crate, but asks for the number of threads before every product. Where
//! `RAYON_NUM_THREADS` is not set that reads `/proc/cpuinfo`, which took longer (17 us) than the product itself, and
//! then spreads products over threads that are too small to gain by it.
#![allow(unsafe_code, reason = "gemm takes raw pointers; this module checks every bound before the call")]

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

/// What becomes of the numbers already in the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Store {
    /// They are overwritten: `c = a b`.
    Overwrite,
    /// They are added to: `c = c + a b`.
    Add,
}

/// The product of two matrices, row-major, into `c`: `[a.n_rows, b.n_columns]`.
///
/// # Panics
/// If the shapes do not agree.
pub(crate) fn matmul(a: Matrix<'_>, b: Matrix<'_>, c: &mut [f32], store: Store) {
    let (m, n, k) = (a.n_rows, b.n_columns, a.n_columns);
    assert_eq!(b.n_rows, k, "inner sizes agree");
    assert_eq!(c.len(), m * n, "the result has the outer sizes");
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
            store == Store::Add,
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn products_by_hand() {
        let (a, b) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [1.0, 0.0, -1.0]);
        let mut c = [10.0, 20.0];
        matmul(Matrix::new(&a, 3), Matrix::new(&b, 1), &mut c, Store::Add);
        assert_eq!(c, [8.0, 18.0]);
        let mut c = [f32::NAN; 3];
        matmul(Matrix::new(&a, 3).t(), Matrix::new(&[1.0, 1.0], 1), &mut c, Store::Overwrite);
        assert_eq!(c, [5.0, 7.0, 9.0]);
    }

    #[test]
    #[should_panic(expected = "inner sizes agree")]
    fn shapes_are_checked() {
        matmul(Matrix::new(&[0.0; 6], 3), Matrix::new(&[0.0; 2], 1), &mut [0.0; 2], Store::Overwrite);
    }

    fn numbers(n: usize) -> impl Strategy<Value = Vec<f32>> {
        prop::collection::vec(-1.0..1.0f32, n)
    }

    proptest! {
        #[test]
        fn products_equal_three_loops(
            (m, n, k, a, b) in (1..40usize, 1..20usize, 1..50usize)
                .prop_flat_map(|(m, n, k)| (Just(m), Just(n), Just(k), numbers(m * k), numbers(k * n))),
            transpose in any::<bool>(),
        ) {
            // The same numbers, read as k by m or m by k.
            let left = if transpose { Matrix::new(&a, m).t() } else { Matrix::new(&a, k) };
            let mut c = vec![f32::NAN; m * n];
            matmul(left, Matrix::new(&b, n), &mut c, Store::Overwrite);
            for i in 0..m {
                for j in 0..n {
                    let a = |l: usize| if transpose { a[l * m + i] } else { a[i * k + l] };
                    let expected: f32 = (0..k).map(|l| a(l) * b[l * n + j]).sum();
                    prop_assert!((c[i * n + j] - expected).abs() < 1e-4);
                }
            }
        }
    }
}
