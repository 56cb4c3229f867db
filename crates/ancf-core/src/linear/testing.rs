//! Small matrices for the tests of this module.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::{Pattern, SymmetricMatrix};

/// Uniform numbers in [-1, 1); a linear congruential generator with Knuth's MMIX constants.
pub(super) fn random_vector(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..n)
        .map(|_| {
            next();
            next()
        })
        .collect()
}

/// Chain of overlapping groups of six, closed by a few far couplings.
pub(super) fn random_pattern(n: usize) -> Pattern {
    let mut groups: Vec<Vec<usize>> = (0..n).step_by(3).map(|k| (k..n.min(k + 6)).collect()).collect();
    groups.extend((0..n / 4).step_by(5).map(|k| vec![k, n - 1 - k]));
    Pattern::from_groups(n, &groups).unwrap()
}

/// Random values on such a pattern: indefinite.
pub(super) fn random_matrix(n: usize, seed: u64) -> SymmetricMatrix {
    let pattern = Arc::new(random_pattern(n));
    let values = random_vector(pattern.nnz(), seed);
    SymmetricMatrix::new(pattern, values)
}

/// Both triangles.
pub(super) fn dense(matrix: &SymmetricMatrix) -> DMatrix<f64> {
    let pattern = matrix.pattern();
    DMatrix::from_fn(pattern.n(), pattern.n(), |i, j| pattern.slot(i, j).map_or(0.0, |slot| matrix.values()[slot]))
}
