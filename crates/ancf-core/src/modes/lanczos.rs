//! The largest eigenvalues of `(K + s M)^-1 M` by the band Lanczos method with full orthogonalisation and thick restarts.
//!
//! The basis is orthonormal in the mass matrix. It grows by one vector at a time, several ahead of the one that the
//! operator acts on, so that eigenvalues of a multiplicity up to their number are all found.
//!
//! # Source
//!
//! Ruhe (1979) for the band method; Wu and Simon (2000) for thick restarts; Ericsson and Ruhe (1980) for the shift.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::assembly::System;
use crate::linear::dot;

/// Vectors ahead of the operator: a free body has six modes with the same eigenvalue.
const AHEAD: usize = 6;
/// Part of a vector that is left after orthogonalisation, below which it is rounding.
const LEFT: f64 = 1e-10;

/// An approximate eigenpair.
pub(super) struct Ritz {
    /// Eigenvalue `theta` of the operator.
    pub value: f64,
    /// Norm of `A x - theta x` for the vector `x` of norm one.
    pub residual: f64,
    weights: Vec<f64>,
}

/// A basis of a Krylov space and the operator in it. The factorised tangent of the system is `K + s M`.
pub(super) struct Lanczos {
    /// Orthonormal vectors over all coordinates, zero where these are fixed.
    basis: Vec<Vec<f64>>,
    /// `basis_i . M A basis_j` in column j, for the first vectors, those that the operator has acted on.
    columns: Vec<Vec<f64>>,
    dimension: usize,
    seed: u64,
    products: usize,
}

impl Lanczos {
    /// A space of a few vectors without a pattern, so that no mode is missed.
    pub fn new(system: &System) -> Self {
        let dimension = system.free().len();
        let mut lanczos = Self { basis: Vec::new(), columns: Vec::new(), dimension, seed: 1, products: 0 };
        for _ in 0..AHEAD {
            lanczos.add_random(system);
        }
        lanczos
    }

    /// Number of vectors that the operator has acted on.
    pub fn acted(&self) -> usize {
        self.columns.len()
    }

    /// Whether the operator is known in the whole space.
    pub fn is_complete(&self) -> bool {
        self.columns.len() == self.dimension
    }

    /// Times that the operator has acted.
    pub fn products(&self) -> usize {
        self.products
    }

    /// Adds a random vector, unless the space is the whole one.
    pub fn add_random(&mut self, system: &System) {
        if self.basis.len() == self.dimension {
            return;
        }
        loop {
            let mut x = vec![0.0; system.coordinates()];
            for &coordinate in system.free() {
                // A linear congruential generator with Knuth's constants.
                self.seed = self.seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                x[coordinate] = (self.seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
            }
            if self.orthonormalize(system, &mut x).1 > 0.0 {
                self.basis.push(x);
                return;
            }
        }
    }

    /// Lets the operator act on the next vector.
    pub fn extend(&mut self, system: &mut System) {
        let next = &self.basis[self.columns.len()];
        let mut image = vec![0.0; next.len()];
        system.solve(&mass_times(system, next), &mut image);
        self.products += 1;
        let (mut column, norm) = self.orthonormalize(system, &mut image);
        if norm > 0.0 {
            column.push(norm);
            self.basis.push(image);
        }
        self.columns.push(column);
        if self.columns.len() == self.basis.len() {
            // The space is invariant; what is left out of it begins anew.
            self.add_random(system);
        }
    }

    /// Takes from `x` its parts along the basis and divides it by the norm of what is left. Returns the parts and the
    /// norm, which is zero, and `x` useless, if nothing but rounding was left.
    fn orthonormalize(&self, system: &System, x: &mut [f64]) -> (Vec<f64>, f64) {
        let before = dot(x, &mass_times(system, x)).sqrt();
        let mut parts = vec![0.0; self.basis.len()];
        // Twice is enough: Giraud et al. (2005).
        for _ in 0..2 {
            let momentum = mass_times(system, x);
            for (sum, vector) in parts.iter_mut().zip(&self.basis) {
                let part = dot(vector, &momentum);
                *sum += part;
                x.iter_mut().zip(vector).for_each(|(x, v)| *x -= part * v);
            }
        }
        let norm = dot(x, &mass_times(system, x)).sqrt();
        if self.basis.len() == self.dimension || norm <= LEFT * before {
            return (parts, 0.0);
        }
        x.iter_mut().for_each(|x| *x /= norm);
        (parts, norm)
    }

    /// Approximate eigenpairs, the largest eigenvalues first.
    pub fn ritz(&self) -> Vec<Ritz> {
        let size = self.columns.len();
        let entry = |i: usize, j: usize| self.columns[j].get(i).copied().unwrap_or(0.0);
        let eigen = SymmetricEigen::new(DMatrix::from_fn(size, size, |i, j| entry(i.min(j), i.max(j))));
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let pair = |k: usize| {
            let weights: Vec<f64> = eigen.eigenvectors.column(k).iter().copied().collect();
            let beyond = (size..self.basis.len()).map(|i| (0..size).map(|j| entry(i, j) * weights[j]).sum::<f64>());
            let residual = beyond.map(|x| x * x).sum::<f64>().sqrt();
            Ritz { value: eigen.eigenvalues[k], residual, weights }
        };
        order.into_iter().map(pair).collect()
    }

    /// The vector of an eigenpair, of norm one.
    pub fn vector(&self, ritz: &Ritz) -> Vec<f64> {
        let mut x = vec![0.0; self.basis[0].len()];
        for (weight, vector) in ritz.weights.iter().zip(&self.basis) {
            x.iter_mut().zip(vector).for_each(|(x, v)| *x += weight * v);
        }
        x
    }

    /// Makes the space smaller: the given eigenpairs and the vectors ahead.
    pub fn restart(&mut self, kept: &[Ritz]) {
        let size = self.columns.len();
        let vectors = kept.iter().map(|ritz| self.vector(ritz)).collect::<Vec<_>>();
        let column = |(k, ritz): (usize, &Ritz)| {
            let mut column = vec![0.0; kept.len()];
            column[k] = ritz.value;
            let entry = |i: usize, j: usize| self.columns[j].get(i).copied().unwrap_or(0.0);
            let ahead = size..self.basis.len();
            column.extend(ahead.map(|i| ritz.weights.iter().enumerate().map(|(j, w)| entry(i, j) * w).sum::<f64>()));
            column
        };
        self.columns = kept.iter().enumerate().map(column).collect();
        self.basis.splice(..size, vectors);
    }
}

fn mass_times(system: &System, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    system.add_mass_times(x, &mut y);
    y
}
