//! Strain measures: what a sample of the strain is, as a function of a few gradient vectors at its point.
//!
//! A measure says value, first and second derivative; force, tangent and everything built on them follow in
//! `element::kernel`, once for all measures.

mod curvature;
mod metric;

use pulp::Simd;

use crate::lanes::{Lanes, Vector};

pub use curvature::{Curvature, CurvatureLaw};
pub use metric::Metric;

/// A 3 x 3 block of a tangent, row by row.
pub type Block<S> = [Vector<S>; 3];

/// Position of the block of nodal vectors `a <= b` in a packed symmetric matrix, column by column.
#[inline(always)]
pub const fn packed(a: usize, b: usize) -> usize {
    b * (b + 1) / 2 + a
}

/// A strain measure at one point: `C` components that depend on `D` gradient vectors.
pub trait Measure<S: Simd, const D: usize, const C: usize>: Copy {
    /// What is fixed for all points and elements, such as the choice of a variant.
    type Law: Copy;

    /// Evaluates the measure for the given gradient vectors; `area` is the reference area stretch `|R_x x R_y|`.
    fn new(law: Self::Law, gradients: [Vector<S>; D], area: Lanes<S>) -> Self;

    /// The strain components, sheared and twisted ones doubled.
    fn strain(&self) -> [Lanes<S>; C];

    /// The change of the strain with the gradient vectors, to first order.
    fn change(&self, gradients: &[Vector<S>; D]) -> [Lanes<S>; C];

    /// The derivative of `stress . strain` with respect to each gradient vector.
    fn forces(&self, stress: [Lanes<S>; C]) -> [Vector<S>; D];

    /// The derivative of each component with respect to a nodal vector whose table entries are `table`.
    fn row(&self, table: [f64; D]) -> [Vector<S>; C];

    /// Adds the second derivative of `stress . strain` with respect to all nodal vectors to the packed `blocks`.
    fn add_second<const N: usize>(&self, stress: [Lanes<S>; C], tables: &[[f64; N]; D], blocks: &mut [Block<S>]);
}
