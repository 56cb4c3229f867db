//! Symmetric sparse matrix times vector.

use std::sync::Arc;

use super::Pattern;

/// Symmetric matrix: a pattern and one value for each of its entries.
///
/// # Examples
///
/// A mass matrix is stored as a scalar matrix that acts on each of three interleaved components:
///
/// ```
/// use std::sync::Arc;
/// use ancf_core::linear::{Pattern, SymmetricMatrix};
///
/// let pattern = Arc::new(Pattern::from_groups(2, &[[0, 1]])?);
/// let mass = SymmetricMatrix::new(pattern, vec![2.0, 1.0, 3.0]);
/// let mut momentum = [0.0; 6];
/// mass.multiply_add::<3>(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0], &mut momentum);
/// assert_eq!(momentum, [2.0, 1.0, 0.0, 1.0, 3.0, 0.0]);
/// # Ok::<(), ancf_core::linear::LinearError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SymmetricMatrix {
    pattern: Arc<Pattern>,
    values: Vec<f64>,
}

impl SymmetricMatrix {
    /// Joins a pattern and the values of its entries, (nnz).
    ///
    /// # Panics
    ///
    /// When there is not one value for each entry.
    #[must_use]
    pub fn new(pattern: Arc<Pattern>, values: Vec<f64>) -> Self {
        assert_eq!(values.len(), pattern.nnz(), "one value an entry");
        Self { pattern, values }
    }

    /// Where the entries are.
    #[must_use]
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Values of the entries, (nnz), in the order of [`Pattern::row_idx`].
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The same, to be refilled.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// y += A x for `WIDTH` interleaved vectors: y[WIDTH a + c] += sum over b of A_ab x[WIDTH b + c].
    ///
    /// # Panics
    ///
    /// When `x` or `y` is not of length WIDTH n.
    pub fn multiply_add<const WIDTH: usize>(&self, x: &[f64], y: &mut [f64]) {
        let Self { pattern, values } = self;
        let length = WIDTH * pattern.n();
        assert_eq!((x.len(), y.len()), (length, length), "{WIDTH} interleaved vectors of the size of the matrix");
        let (x, y) = (x.as_chunks::<WIDTH>().0, y.as_chunks_mut::<WIDTH>().0);
        for (column, &x_column) in x.iter().enumerate() {
            let values = &values[pattern.col_ptr()[column]..pattern.col_ptr()[column + 1]];
            let mut sum = x_column.map(|x| values[0] * x);
            for (&value, &row) in values.iter().zip(pattern.rows(column)).skip(1) {
                let (x, y) = (&x[row], &mut y[row]);
                for c in 0..WIDTH {
                    y[c] += value * x_column[c];
                    sum[c] += value * x[c];
                }
            }
            for c in 0..WIDTH {
                y[column][c] += sum[c];
            }
        }
    }

    /// Writes b - A x to `residual` and returns the backward error, the largest of |b - A x|_i / (|A| |x| + |b|)_i.
    ///
    /// It is the smallest relative change of single entries of A and b that makes x exact, so it depends neither on the
    /// condition of A nor on units. A sound solve leaves 1e-15; solving for `residual` and adding the result to x is a
    /// step of iterative refinement.
    ///
    /// # Source
    ///
    /// Oettli and Prager (1964); Higham, Accuracy and Stability of Numerical Algorithms (2002), theorem 7.3.
    ///
    /// # Panics
    ///
    /// When an array is not of length n.
    pub fn residual(&self, x: &[f64], rhs: &[f64], residual: &mut [f64]) -> f64 {
        assert_eq!(x.len(), self.pattern.n(), "one coordinate a column");
        residual.copy_from_slice(rhs);
        let mut scale: Vec<f64> = rhs.iter().map(|b| b.abs()).collect();
        for (column, &x_column) in x.iter().enumerate() {
            let start = self.pattern.col_ptr()[column];
            let diagonal = self.values[start] * x_column;
            let (mut sum, mut absolute_sum) = (diagonal, diagonal.abs());
            for (k, &row) in self.pattern.rows(column).iter().enumerate().skip(1) {
                let value = self.values[start + k];
                let (lower, upper) = (value * x_column, value * x[row]);
                residual[row] -= lower;
                scale[row] += lower.abs();
                sum += upper;
                absolute_sum += upper.abs();
            }
            residual[column] -= sum;
            scale[column] += absolute_sum;
        }
        let errors = residual.iter().zip(&scale).map(|(r, scale)| if *r == 0.0 { 0.0 } else { r.abs() / scale });
        // not f64::max, which would drop a NaN
        errors.fold(0.0, |worst, error| if error > worst || error.is_nan() { error } else { worst })
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{dense, random_matrix, random_vector};
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn product_agrees_with_the_dense_one_for_each_component() {
        let matrix = random_matrix(40, 1);
        let x = random_vector(120, 2);
        let mut y = vec![1.0; 120];
        matrix.multiply_add::<3>(&x, &mut y);
        let expected = dense(&matrix) * DMatrix::from_row_slice(40, 3, &x);
        for (k, y) in y.iter().enumerate() {
            assert!((y - 1.0 - expected[(k / 3, k % 3)]).abs() < 1e-13);
        }
    }

    #[test]
    fn residual_agrees_with_the_dense_one() {
        let matrix = random_matrix(40, 3);
        let (x, rhs) = (DVector::from_vec(random_vector(40, 4)), DVector::from_vec(random_vector(40, 5)));
        let mut residual = vec![0.0; 40];
        let error = matrix.residual(x.as_slice(), rhs.as_slice(), &mut residual);
        let expected = &rhs - dense(&matrix) * &x;
        let scale = dense(&matrix).abs() * x.abs() + rhs.abs();
        assert!((DVector::from_vec(residual) - &expected).amax() < 1e-13);
        assert!((error - expected.component_div(&scale).amax()).abs() < 1e-13);
    }

    #[test]
    fn a_solution_that_is_not_finite_has_no_small_error() {
        let matrix = random_matrix(30, 6);
        let mut x = vec![1.0; 30];
        x[0] = f64::NAN; // far from the last rows, whose errors are finite
        assert!(matrix.residual(&x, &[1.0; 30], &mut [0.0; 30]).is_nan());
    }
}
