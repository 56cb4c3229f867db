//! Strain measures: what a sample of the strain is, as a function of a few gradient vectors at its point.
//!
//! A measure says value, first and second derivative with respect to the gradient vectors; force, tangent and
//! everything built on them follow in `element::kernel`, once for all measures.

mod curvature;
mod green_lagrange;
mod metric;

use pulp::Simd;

use crate::lanes::{Lanes, Vector, axpy};

pub use curvature::{Curvature, CurvatureLaw};
pub use green_lagrange::GreenLagrange;
pub use metric::Metric;

/// A 3 x 3 block of a tangent, row by row.
pub type Block<S> = [Vector<S>; 3];

/// Position of the block of nodal vectors `a <= b` in a packed symmetric matrix, column by column.
#[inline(always)]
pub const fn packed(a: usize, b: usize) -> usize {
    b * (b + 1) / 2 + a
}

/// The pair of directions of each strain component of a surface: `xx`, `yy`, `xy`.
pub const SURFACE_PAIRS: [(usize, usize); 3] = [(0, 0), (1, 1), (0, 1)];

/// The pair of directions of each strain component of a solid: `xx`, `yy`, `zz`, `yz`, `xz`, `xy`.
pub const SOLID_PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

/// A strain measure at one point: `C` components that depend on `D` gradient vectors.
pub trait Measure<S: Simd, const D: usize, const C: usize>: Copy {
    /// What is fixed for all points and elements, such as the choice of a variant.
    type Law: Copy;

    /// Floating-point operations of [`new`](Self::new), [`strain`](Self::strain) and [`forces`](Self::forces), a fused
    /// multiply-add two.
    const FORCE: usize;

    /// The same of [`stiffness`](Self::stiffness).
    const STIFFNESS: usize;

    /// Evaluates the measure for the given gradient vectors; `stretch` is that of the reference: the area
    /// `|R_x x R_y|` of a surface, the volume `|R_x x R_y . R_z|` of a solid for a unit of the parameters.
    fn new(law: Self::Law, gradients: [Vector<S>; D], stretch: Lanes<S>) -> Self;

    /// The strain components, sheared and twisted ones doubled.
    fn strain(&self) -> [Lanes<S>; C];

    /// The change of the strain with the gradient vectors, to first order.
    fn change(&self, gradients: &[Vector<S>; D]) -> [Lanes<S>; C];

    /// The derivative of `stress . strain` with respect to each gradient vector.
    fn forces(&self, stress: [Lanes<S>; C]) -> [Vector<S>; D];

    /// The second derivative of `1/2 strain . weight strain` with respect to the gradient vectors, where `stress` stands
    /// for `weight strain`: a block for each pair of vectors `d <= e`.
    fn stiffness(&self, weight: &[[Lanes<S>; C]; C], stress: [Lanes<S>; C], form: Form<'_, S>);
}

/// The stiffness of one of several points, kept pair by pair of gradient vectors, the points side by side.
pub struct Form<'a, S: Simd> {
    blocks: &'a mut [Block<S>],
    points: usize,
    point: usize,
}

impl<'a, S: Simd> Form<'a, S> {
    /// The place for `point` in `blocks`, which are those of so many points.
    #[inline(always)]
    pub fn new(blocks: &'a mut [Block<S>], points: usize, point: usize) -> Self {
        Self { blocks, points, point }
    }

    /// Sets the block of the gradient vectors `d <= e`.
    #[inline(always)]
    fn set(&mut self, d: usize, e: usize, block: Block<S>) {
        self.blocks[packed(d, e) * self.points + self.point] = block;
    }
}

/// `a b^T + block`.
#[inline(always)]
fn add_outer<S: Simd>(a: Vector<S>, b: Vector<S>, block: Block<S>) -> Block<S> {
    [axpy(a[0], b, block[0]), axpy(a[1], b, block[1]), axpy(a[2], b, block[2])]
}
