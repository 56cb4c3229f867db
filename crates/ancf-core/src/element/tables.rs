//! What all elements with the same sides in their parameters share.

use crate::shape::Polynomial;
use crate::strain::{CurvatureLaw, SOLID_PAIRS};

use super::constants::COMPONENTS;
use super::kernel::{AT_ONCE, point_constants};
use super::projection::{MODES, Projection};

/// Strain samples of one measure: the points, their shape tables, and how the samples are weighted.
#[derive(Clone, Debug)]
pub(crate) struct Samples<const N: usize, const D: usize> {
    /// Derivatives of the shape functions that make up the gradient vectors, at each point, for the sums and differences
    /// over the corners (see `corners`).
    pub tables: Vec<[[f64; N]; D]>,
    /// Quadrature weight of each point over the parameter rectangle.
    pub weights: Vec<f64>,
    /// The entries of the tables that are not zero, for some points at a time.
    pub patches: Vec<Patch<N>>,
}

/// What is not zero in the tables of consecutive points, whose gradient vectors are numbered through.
#[derive(Clone, Debug)]
pub(crate) struct Patch<const N: usize> {
    /// For each gradient vector the functions it consists of, with their values.
    pub gradients: Vec<Vec<(usize, f64)>>,
    /// For each function the gradient vectors it is part of, with its values.
    pub functions: [Vec<(usize, f64)>; N],
}

impl<const N: usize, const D: usize> Samples<N, D> {
    /// Samples with the given tables and quadrature weights.
    pub fn new(tables: Vec<[[f64; N]; D]>, weights: Vec<f64>) -> Self {
        let patches = tables.chunks(AT_ONCE / D).map(Patch::new).collect();
        Self { tables, weights, patches }
    }
}

impl<const N: usize> Patch<N> {
    fn new<const D: usize>(tables: &[[[f64; N]; D]]) -> Self {
        let rows = tables.as_flattened();
        let not_zero =
            |entries: &mut dyn Iterator<Item = f64>| entries.enumerate().filter(|(_, t)| *t != 0.0).collect();
        Self {
            gradients: rows.iter().map(|row| not_zero(&mut row.iter().copied())).collect(),
            functions: std::array::from_fn(|a| not_zero(&mut rows.iter().map(|row| row[a]))),
        }
    }
}

/// A group of samples with its strain measure.
#[derive(Clone, Debug)]
pub(crate) enum Group<const N: usize> {
    /// Membrane strain of a surface, with its whole energy or, beside a projected group, a share of it.
    Membrane(Samples<N, 2>),
    /// Membrane strain of a surface by generalised strains.
    Projected(Samples<N, 2>, Projection<N>),
    /// Curvature of a surface.
    Bending(Samples<N, 5>, CurvatureLaw),
    /// Strain of a solid.
    Solid(Samples<N, 3>),
}

impl<const N: usize> Group<N> {
    /// Number of constants of an element for this group.
    pub fn constants(&self) -> usize {
        match self {
            Self::Membrane(samples) => samples.tables.len() * point_constants(COMPONENTS),
            Self::Projected(samples, _) => samples.tables.len() * COMPONENTS + MODES * (MODES + 1) / 2,
            Self::Bending(samples, _) => samples.tables.len() * point_constants(COMPONENTS),
            Self::Solid(samples) => samples.tables.len() * point_constants(SOLID_PAIRS.len()),
        }
    }
}

/// The tables of an element with `N` nodal vectors.
#[derive(Clone, Debug)]
pub(crate) struct Tables<const N: usize> {
    /// Sides of the element in its parameters.
    pub sides: [f64; 2],
    /// The shape functions on the middle surface, in `xi = x / l`, `eta = y / w`.
    pub functions: [Polynomial; N],
    /// The sample groups that make up the energy.
    pub groups: Vec<Group<N>>,
    /// Shape functions and their first derivatives at the mass quadrature points, with the weights.
    pub mass: Vec<(Derivatives<N>, f64)>,
}

/// `N`, `N_x`, `N_y` at a point, and `N_z` if the element has a direction of its own through the thickness.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Derivatives<const N: usize> {
    pub value: [f64; N],
    pub x: [f64; N],
    pub y: [f64; N],
    pub z: Option<[f64; N]>,
}

impl<const N: usize> Tables<N> {
    /// The derivatives of the shape functions, `in_x` and `in_y` times, at `(xi, eta)`.
    pub fn derivative(&self, [in_x, in_y]: [usize; 2], [xi, eta]: [f64; 2]) -> [f64; N] {
        derivative(&self.functions, self.sides, [in_x, in_y], [xi, eta])
    }
}

/// The derivatives of `functions` of `xi = x / l`, `eta = y / w` with respect to `x` and `y`.
pub(crate) fn derivative<const N: usize>(
    functions: &[Polynomial; N],
    [l, w]: [f64; 2],
    [in_x, in_y]: [usize; 2],
    [xi, eta]: [f64; 2],
) -> [f64; N] {
    let scale = l.powi(in_x as i32) * w.powi(in_y as i32);
    functions.map(|f| f.derivative(in_x, in_y, xi, eta) / scale)
}
