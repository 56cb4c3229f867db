//! Floating-point operations of an element, counted from its tables and from the formulas of its strain measures.

use pulp::Scalar;

use crate::strain::{Curvature, GreenLagrange, Measure, Metric};

use super::constants::Couplings;
use super::projection::{MODES, Projection};
use super::tables::{Group, Samples, Tables};

/// Floating-point operations of one element: an addition, a multiplication, a division or a root is one, a fused
/// multiply-add two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// For energy and force.
    pub force: usize,
    /// For energy, force and tangent.
    pub tangent: usize,
}

impl Operations {
    /// Adds operations of both.
    fn add(&mut self, force: usize, stiffness: usize) {
        self.force += force;
        self.tangent += force + stiffness;
    }

    /// Of an element at rest, without damping and extrapolated stress.
    pub(super) fn count<const N: usize>(tables: &Tables<N>, couplings: &Couplings) -> Self {
        let mut operations = Self::default();
        for group in &tables.groups {
            match group {
                Group::Membrane(samples) => operations.add_samples::<Metric<Scalar>, N, 2, 3>(samples),
                Group::Projected(samples, projection) => {
                    operations.add_samples::<Metric<Scalar>, N, 2, 3>(samples);
                    operations.add_projection(projection, couplings);
                }
                Group::Bending(samples, _) => operations.add_samples::<Curvature<Scalar>, N, 5, 3>(samples),
                Group::Solid(samples) => operations.add_samples::<GreenLagrange<Scalar>, N, 3, 6>(samples),
            }
        }
        // Sums and differences over the corners: 8 for each kind and component of the vectors and of the forces, 64 for
        // those of a block of the tangent; then its factor and the inertia.
        let kinds = N / 4;
        let components = 6 * kinds + 9 * kinds * (kinds - 1) / 2;
        operations.add(2 * 8 * 3 * kinds, 64 * components + (9 + 4) * N * (N + 1) / 2);
        operations
    }

    fn add_samples<M: Measure<Scalar, D, C>, const N: usize, const D: usize, const C: usize>(
        &mut self,
        samples: &Samples<N, D>,
    ) {
        let points = samples.tables.len();
        let not_zero = samples.tables.as_flattened().as_flattened().iter().filter(|entry| **entry != 0.0).count();
        // Gradient vectors and forces from the tables; strain less reference, stress and energy.
        let force = 12 * not_zero + points * (M::FORCE + C + C * (2 * C - 1) + 3 * C);
        let moments: usize = samples.patches.iter().map(|patch| patch.moments.operations(D)).sum();
        self.add(force, points * M::STIFFNESS + moments);
    }

    fn add_projection<const N: usize>(&mut self, projection: &Projection<N>, couplings: &Couplings) {
        let values: usize = projection.modes.iter().map(|mode| mode.basis.len()).sum();
        let coupled: usize = couplings.iter().map(Vec::len).sum();
        let points = 6 * super::projection::POINTS;
        let rows: usize = projection.rows.iter().flatten().map(|row| row.gradients.len()).sum();
        let sums: usize = (0..N).map(|a| (N - a) * projection.rows[a].len()).sum();
        self.add(4 * values + 2 * coupled + 3 * MODES + points, 6 * rows + 6 * N * coupled + 18 * sums);
    }
}
