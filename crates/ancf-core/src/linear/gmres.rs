//! GMRES: linear equations whose matrix is known only by what it does to a vector.

use super::dot;

/// Solves `A x = b` by minimising the residual over growing Krylov spaces, from `x = 0`.
///
/// `apply(x, y)` sets `y = A x`. Ends when the residual is below `tolerance` times `b`, or after `most` products;
/// `b` is replaced by the solution. Returns the residual relative to `b`.
///
/// # Source
///
/// Saad and Schultz (1986), with modified Gram-Schmidt and Givens rotations.
pub fn gmres(mut apply: impl FnMut(&[f64], &mut [f64]), b: &mut [f64], tolerance: f64, most: usize) -> f64 {
    let size = norm(b);
    if size == 0.0 {
        return 0.0;
    }
    let mut basis = vec![b.iter().map(|b| b / size).collect::<Vec<f64>>()];
    // Columns of the triangular matrix that the rotations make of the Hessenberg matrix, and the rotated residual.
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut rotations: Vec<[f64; 2]> = Vec::new();
    let mut residual = vec![size];
    for k in 0..most {
        let mut next = vec![0.0; b.len()];
        apply(&basis[k], &mut next);
        let mut column = Vec::with_capacity(k + 2);
        for vector in &basis {
            let product = dot(vector, &next);
            column.push(product);
            next.iter_mut().zip(vector).for_each(|(n, v)| *n -= product * v);
        }
        let rest = norm(&next);
        for (i, [c, s]) in rotations.iter().enumerate() {
            (column[i], column[i + 1]) = (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let diagonal = column[k].hypot(rest);
        let [c, s] = [column[k] / diagonal, rest / diagonal];
        column[k] = diagonal;
        rotations.push([c, s]);
        columns.push(column);
        residual.push(-s * residual[k]);
        residual[k] *= c;
        if residual[k + 1].abs() <= tolerance * size {
            break;
        }
        next.iter_mut().for_each(|n| *n /= rest);
        basis.push(next);
    }
    let m = columns.len();
    let mut factors = residual[..m].to_vec();
    for i in (0..m).rev() {
        factors[i] /= columns[i][i];
        for j in 0..i {
            factors[j] -= columns[i][j] * factors[i];
        }
    }
    b.fill(0.0);
    for (factor, vector) in factors.iter().zip(&basis) {
        b.iter_mut().zip(vector).for_each(|(b, v)| *b += factor * v);
    }
    residual[m].abs() / size
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::testing::random_vector;
    use super::*;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn agrees_with_lu_within_as_many_products_as_unknowns() {
        let n = 12;
        let matrix = DMatrix::identity(n, n) + DMatrix::from_vec(n, n, random_vector(n * n, 3));
        let right = DVector::from_vec(random_vector(n, 4));
        let expected = matrix.clone().lu().solve(&right).unwrap();
        let mut x = right.clone();
        let mut products = 0;
        let apply = |x: &[f64], y: &mut [f64]| {
            products += 1;
            y.copy_from_slice((&matrix * DVector::from_column_slice(x)).as_slice());
        };
        let rest = gmres(apply, x.as_mut_slice(), 1e-12, 50);
        assert!(rest <= 1e-12 && products <= n, "{rest:e} after {products}");
        assert!((x - &expected).amax() < 1e-9 * expected.amax());
    }

    #[test]
    fn one_product_shows_that_a_matrix_does_nothing() {
        let mut products = 0;
        let mut x = vec![3.0, -4.0];
        let apply = |x: &[f64], y: &mut [f64]| {
            products += 1;
            y.copy_from_slice(x);
        };
        gmres(apply, &mut x, 1e-12, 50);
        assert_eq!((x, products), (vec![3.0, -4.0], 1));
        let mut zero = vec![0.0; 2];
        assert_eq!(gmres(|_, _| unreachable!("nothing to solve"), &mut zero, 1e-12, 50), 0.0);
    }
}
