//! The linear equations for the free coordinates.

use std::sync::Arc;
use std::time::Instant;

use crate::linear::{Inertia, LinearError, Pattern, SymmetricMatrix, gmres};

use super::System;

/// Accuracy of solutions with the skew part of the followers: Newton corrects what is left.
const SKEW_TOLERANCE: f64 = 1e-8;
/// Most products with the skew part in a solution.
const SKEW_PRODUCTS: usize = 40;

impl System {
    /// The pattern and the values of the tangent that was assembled last, over the free coordinates.
    pub fn tangent(&self) -> (&Pattern, &[f64]) {
        (self.scatter.pattern(), &self.values)
    }

    /// The tangent that was assembled last, over the free coordinates.
    pub fn tangent_matrix(&self) -> SymmetricMatrix {
        SymmetricMatrix::new(Arc::clone(self.scatter.pattern()), self.values.clone())
    }

    /// The state of the last tangent, for the skew part of the followers: coordinates, and the factor of each load.
    pub(crate) fn tangent_at(&self) -> &(Vec<f64>, Vec<f64>) {
        &self.tangent_at
    }

    /// Subtracts the skew half of a tangent, that of loads which follow the body, times `x` from `y`; `at` is its
    /// [`tangent_at`](Self::tangent_at).
    pub(crate) fn subtract_skew_times(&self, at: &(Vec<f64>, Vec<f64>), x: &[f64], y: &mut [f64]) {
        self.loads.subtract_skew_times(&self.blocks, self.model.reference(), at, x, y);
    }

    /// Factorises a tangent that was assembled earlier.
    ///
    /// # Errors
    ///
    /// As [`factorize`](Self::factorize).
    pub(crate) fn restore(&mut self, values: &[f64], at: &(Vec<f64>, Vec<f64>)) -> Result<Inertia, LinearError> {
        self.values.copy_from_slice(values);
        self.tangent_at = at.clone();
        self.factorize()
    }

    /// Factorises the tangent that was assembled last.
    ///
    /// # Errors
    ///
    /// It must be finite and not singular.
    pub fn factorize(&mut self) -> Result<Inertia, LinearError> {
        let start = Instant::now();
        self.factorizations += 1;
        let result = self.factorization.factorize(&self.values);
        self.timers.factorization += start.elapsed();
        result
    }

    /// Solves for the free coordinates: `solution = tangent^-1 right`, zero where fixed.
    ///
    /// The factorised tangent has the symmetric half of the loads' part only; the skew half is brought in afterwards.
    pub fn solve(&mut self, right: &[f64], solution: &mut [f64]) {
        let start = Instant::now();
        solution.fill(0.0);
        self.solve_symmetric(right, solution);
        if self.is_skew() {
            self.bring_in_skew(solution);
        }
        self.timers.solve += start.elapsed();
    }

    /// Whether the tangent has a skew half.
    pub(super) fn is_skew(&self) -> bool {
        self.tangent_at.1.iter().any(|factor| *factor != 0.0)
    }

    /// Solves with the symmetric half of the tangent; fixed coordinates stay as they are.
    fn solve_symmetric(&mut self, right: &[f64], solution: &mut [f64]) {
        let Self { numbering, factorization, free, .. } = self;
        for (value, &coordinate) in free.iter_mut().zip(&numbering.coordinate) {
            *value = right[coordinate];
        }
        factorization.solve(free);
        for (value, &coordinate) in free.iter().zip(&numbering.coordinate) {
            solution[coordinate] = *value;
        }
    }

    /// Makes of `S^-1 b` the solution of `(S + N) x = b`, with the symmetric and the skew half of the tangent. Returns
    /// what is missing, relative to `S^-1 b`.
    ///
    /// The matrix of GMRES is `I + S^-1 N`: where S is positive definite its eigenvalues lie on a line through 1, so a few
    /// products suffice.
    pub(super) fn bring_in_skew(&mut self, x: &mut [f64]) -> f64 {
        let at = std::mem::take(&mut self.tangent_at);
        let mut skew = vec![0.0; x.len()];
        let with_skew = |x: &[f64], y: &mut [f64]| {
            skew.fill(0.0);
            self.subtract_skew_times(&at, x, &mut skew);
            self.solve_symmetric(&skew, y);
            y.iter_mut().zip(x).for_each(|(y, x)| *y += x);
        };
        let missing = gmres(with_skew, x, SKEW_TOLERANCE, SKEW_PRODUCTS);
        self.tangent_at = at;
        missing
    }

    /// The vectors of [`Factorization::descents`](crate::linear::Factorization::descents) over all coordinates.
    pub(super) fn descents(&mut self) -> Vec<Vec<f64>> {
        let n = self.coordinates();
        let all = |free: Vec<f64>| {
            let mut z = vec![0.0; n];
            self.numbering.coordinate.iter().zip(free).for_each(|(&coordinate, value)| z[coordinate] = value);
            z
        };
        self.factorization.descents().into_iter().map(all).collect()
    }
}
