//! Strain of a solid: half the metric in space, whose change from the reference is the Green-Lagrange strain.

use pulp::Simd;

use super::{Form, Measure, SOLID_PAIRS, add_outer};
use crate::lanes::{Lanes, Vector, axpy, dot, scale};

/// The component of each pair of directions in [`SOLID_PAIRS`].
const COMPONENT: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];

/// `r_a . r_a / 2` and `r_a . r_b` for the gradients `r_x`, `r_y`, `r_z`, in the order of [`SOLID_PAIRS`].
///
/// # Source
///
/// Dufva and Shabana (2005), (13), without the constant part.
#[derive(Clone, Copy)]
pub struct GreenLagrange<S: Simd> {
    gradients: [Vector<S>; 3],
}

impl<S: Simd> Measure<S, 3, 6> for GreenLagrange<S> {
    type Law = ();
    const FORCE: usize = 33 + 45;
    const STIFFNESS: usize = 18 * (18 + 18);

    #[inline(always)]
    fn new((): (), gradients: [Vector<S>; 3], _stretch: Lanes<S>) -> Self {
        Self { gradients }
    }

    #[inline(always)]
    fn strain(&self) -> [Lanes<S>; 6] {
        let r = &self.gradients;
        let mut strain = [r[0][0]; 6];
        for (c, (a, b)) in SOLID_PAIRS.into_iter().enumerate() {
            strain[c] = dot(r[a], r[b]) * if a == b { 0.5 } else { 1.0 };
        }
        strain
    }

    #[inline(always)]
    fn change(&self, d: &[Vector<S>; 3]) -> [Lanes<S>; 6] {
        let r = &self.gradients;
        let mut change = [r[0][0]; 6];
        for (c, (a, b)) in SOLID_PAIRS.into_iter().enumerate() {
            change[c] = if a == b { dot(r[a], d[a]) } else { dot(r[a], d[b]) + dot(r[b], d[a]) };
        }
        change
    }

    #[inline(always)]
    fn forces(&self, stress: [Lanes<S>; 6]) -> [Vector<S>; 3] {
        let r = &self.gradients;
        let mut forces = *r;
        for (d, [x, y, z]) in COMPONENT.into_iter().enumerate() {
            forces[d] = axpy(stress[x], r[0], axpy(stress[y], r[1], scale(stress[z], r[2])));
        }
        forces
    }

    /// The strain `de` changes with the gradient `r_d` by `r_e`.
    #[inline(always)]
    fn stiffness(&self, weight: &[[Lanes<S>; 6]; 6], stress: [Lanes<S>; 6], mut form: Form<'_, S>) {
        let r = &self.gradients;
        let zero = stress[0].like(0.0);
        for d in 0..3 {
            for e in d..3 {
                let normal = stress[COMPONENT[d][e]];
                let mut block = [[normal, zero, zero], [zero, normal, zero], [zero, zero, normal]];
                for k in 0..3 {
                    let weight = &weight[COMPONENT[d][k]];
                    let mut sum = [zero; 3];
                    for l in 0..3 {
                        sum = axpy(weight[COMPONENT[e][l]], r[l], sum);
                    }
                    block = add_outer(r[k], sum, block);
                }
                form.set(d, e, block);
            }
        }
    }
}
