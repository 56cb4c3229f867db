//! Stability under loads that follow the body.
//!
//! Their tangent `K = S + N` has a skew half `N` where they have no potential, as a pressure on a shell with a free edge. The
//! structure leaves an equilibrium where an eigenvalue of `K` passes zero. `S` loses its definiteness before (Bromwich): it
//! is a bound, not the criterion.

use nalgebra::{DMatrix, Schur};

use crate::linear::{Inertia, dot};

use super::System;

/// More negative pivots than this are taken for what they are: so many are no matter of the skew half.
const MOST: usize = 8;
/// Largest part of a solution with the skew half that may be missing.
const MISSING: f64 = 1e-3;
/// Sweeps in which the eigenvalues of a small matrix are found, if it is one of numbers.
const MOST_SWEEPS: usize = 200;

impl System {
    /// In how many directions the structure leaves a state whose tangent was factorised, with this inertia: those of the
    /// negative pivots of `S`, less those in which `N` holds it.
    ///
    /// With vectors `Z^T S Z = -I` in the directions of the negative pivots, `S + 2 S Z Z^T S` is positive definite, and with
    /// `N` it still has no eigenvalue of negative real part. So the sign of `det K` is that of `det A`,
    /// `A = -I - 2 Z^T N W` with `(S + N) W = S Z`: without `N` each pivot counts, and none does as long as `K` has not
    /// become singular since `S` was definite.
    ///
    /// # Source
    ///
    /// Bolotin, Nonconservative Problems of the Theory of Elastic Stability (1963), for divergence; Schweizerhof and Ramm
    /// (1984), Displacement dependent pressure loads in nonlinear finite element analyses, for the halves of the tangent.
    pub fn instabilities(&mut self, inertia: Inertia) -> usize {
        let n = inertia.negative;
        if n == 0 || n > MOST || !self.is_skew() {
            return n;
        }
        let z = self.descents();
        let mut a = DMatrix::from_diagonal_element(n, n, -1.0);
        for (j, z_j) in z.iter().enumerate() {
            let mut w = z_j.clone();
            if self.bring_in_skew(&mut w) > MISSING {
                return n;
            }
            let mut n_w = vec![0.0; w.len()];
            self.subtract_skew_times(self.tangent_at(), &w, &mut n_w);
            for (i, z_i) in z.iter().enumerate() {
                a[(i, j)] -= 2.0 * dot(z_i, &n_w);
            }
        }
        let eigenvalues = Schur::try_new(a, f64::EPSILON, MOST_SWEEPS).map(|schur| schur.complex_eigenvalues());
        eigenvalues.map_or(n, |values| values.iter().filter(|value| value.re < 0.0).count())
    }
}
