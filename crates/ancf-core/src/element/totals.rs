//! What several elements side by side give: energy, force and tangent.

use pulp::Simd;

use crate::lanes::{Lanes, Vector};
use crate::strain::Block;

use super::moments::Moments;

/// What a batch gives; each part is added to.
#[repr(C, align(64))]
pub(crate) struct Totals<S: Simd, const N: usize> {
    /// Force on each vector.
    pub force: [Vector<S>; N],
    /// Membrane and bending energy: of a solid that of strains which are odd across the thickness is the second, all else the
    /// first.
    pub energy: [Lanes<S>; 2],
    /// Power of a unit viscosity, and the energy that mean forces miss.
    pub rates: [Lanes<S>; 2],
    /// Forces on the gradient vectors of a patch, which become those on the nodal vectors.
    pub(super) on_gradients: [Vector<S>; MOST_GRADIENTS],
}

/// The tangent of a batch, which is added to.
#[repr(C, align(64))]
pub(crate) struct Tangent<S: Simd, const N: usize> {
    /// `blocks[b][a]` for the vectors `a <= b`, unless `empty`.
    pub blocks: [[Block<S>; N]; N],
    /// Stiffness of the points of a patch with respect to their gradient vectors; in the end the tangent by pairs of
    /// corners.
    pub(super) forms: [Block<S>; MOST_PAIRS],
    /// Whether nothing has been added.
    pub empty: bool,
}

/// The most gradient vectors of a patch: two at 4 x 4 points, three for a solid.
pub(super) const MOST_GRADIENTS: usize = 48;

/// The most pairs of gradient vectors at the points of a patch, 135 for the curvature at 3 x 3 points, and the tangent of
/// 16 vectors, 160 blocks.
const MOST_PAIRS: usize = 160;

impl<S: Simd, const N: usize> Totals<S, N> {
    /// Zeros.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        Self { energy: [zero; 2], rates: [zero; 2], force: [[zero; 3]; N], on_gradients: [[zero; 3]; MOST_GRADIENTS] }
    }

    /// Zeros again.
    #[inline(always)]
    pub fn clear(&mut self, simd: S) {
        let zero = Lanes::splat(simd, 0.0);
        self.energy.fill(zero);
        self.rates.fill(zero);
        self.force.fill([zero; 3]);
    }

    /// Counts the energy of the part of a solid's strain that is odd across the thickness as bending: `twice` that part,
    /// at two points on top of each other with the constants `below` and `above`.
    #[inline(always)]
    pub(super) fn split<const C: usize>(&mut self, below: &[Lanes<S>], above: &[Lanes<S>], twice: [Lanes<S>; C]) {
        let weights = (&below[1 + C..], &above[1 + C..]);
        for i in 0..C {
            for j in 0..C {
                let energy = (weights.0[C * i + j] + weights.1[C * i + j]) * twice[j] * twice[i] * 0.125;
                self.energy[0] = self.energy[0] - energy;
                self.energy[1] = self.energy[1] + energy;
            }
        }
    }

    /// Adds what strain rates do: `viscous` is their stress for a unit viscosity, `stress` the elastic one.
    #[inline(always)]
    pub fn add_rates(&mut self, stress: &[Lanes<S>], viscous: &[Lanes<S>], rate: &[Lanes<S>], missed: &[Lanes<S>]) {
        for k in 0..rate.len() {
            self.rates[0] = viscous[k].mul_add(rate[k], self.rates[0]);
            self.rates[1] = stress[k].mul_add(missed[k], self.rates[1]);
        }
    }
}

impl<S: Simd, const N: usize> Tangent<S, N> {
    /// Zeros.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let none = [[Lanes::splat(simd, 0.0); 3]; 3];
        Self { blocks: [[none; N]; N], forms: [none; MOST_PAIRS], empty: true }
    }

    /// Adds what the stiffness of the points in the first `count` of `forms` makes.
    #[inline(always)]
    pub(super) fn add_moments(&mut self, moments: &Moments, count: usize) {
        let Self { blocks, forms, empty } = self;
        if *empty {
            moments.add::<S, N, true>(&mut forms[..count], blocks);
        } else {
            moments.add::<S, N, false>(&mut forms[..count], blocks);
        }
        *empty = false;
    }
}
