//! A square of sample points: gradient vectors from the vectors of an element and forces back to them.

use pulp::Simd;

use crate::lanes::{Vector, table_axpy};

use super::moments::Moments;

/// What is not zero in the tables of the points of a square, whose gradient vectors are numbered through.
#[derive(Clone, Debug)]
pub(crate) struct Patch<const N: usize> {
    /// Number of points.
    pub points: usize,
    /// For each gradient vector the functions it consists of, with their values.
    gradients: Vec<Vec<(usize, f64)>>,
    /// For each function the gradient vectors it is part of, with its values.
    functions: [Vec<(usize, f64)>; N],
    /// The tangent from the stiffness of the points.
    pub moments: Moments,
}

impl<const N: usize> Patch<N> {
    /// For points in a square, whose coordinates along each side are `points`; `symmetric` as in [`Moments::new`].
    pub fn new<const D: usize>(tables: &[[[f64; N]; D]], points: &[f64], symmetric: fn(usize, usize) -> bool) -> Self {
        let rows = tables.as_flattened();
        let not_zero =
            |entries: &mut dyn Iterator<Item = f64>| entries.enumerate().filter(|(_, t)| *t != 0.0).collect();
        Self {
            points: tables.len(),
            gradients: rows.iter().map(|row| not_zero(&mut row.iter().copied())).collect(),
            functions: std::array::from_fn(|a| not_zero(&mut rows.iter().map(|row| row[a]))),
            moments: Moments::new(tables, points, symmetric),
        }
    }

    /// The gradient vectors at a point.
    #[inline(always)]
    pub fn gradients<S: Simd, const D: usize>(&self, point: usize, vectors: &[Vector<S>; N]) -> [Vector<S>; D] {
        let mut gradients = [[vectors[0][0].like(0.0); 3]; D];
        for d in 0..D {
            gradients[d] = combination(gradients[d], &self.gradients[point * D + d], vectors);
        }
        gradients
    }

    /// Adds the forces on the vectors that the forces on the gradient vectors make.
    #[inline(always)]
    pub fn add_forces<S: Simd>(&self, forces: &[Vector<S>], totals: &mut [Vector<S>; N]) {
        for a in 0..N {
            totals[a] = combination(totals[a], &self.functions[a], forces);
        }
    }
}

/// `sum + sum_i factor_i vectors_i` over the entries `(i, factor_i)`.
#[inline(always)]
pub(super) fn combination<S: Simd>(mut sum: Vector<S>, entries: &[(usize, f64)], vectors: &[Vector<S>]) -> Vector<S> {
    for &(i, factor) in entries {
        sum = table_axpy(factor, vectors[i], sum);
    }
    sum
}
