//! What all elements with the same sides in their parameters share.

use crate::quadrature::Rule;
use crate::shape::Polynomial;
use crate::strain::{CurvatureLaw, SOLID_PAIRS};

use super::constants::COMPONENTS;
use super::kernel::point_constants;
use super::patch::Patch;
use super::projection::{MODES, Projection};

/// Strain samples of one measure: the points, their shape tables, and how the samples are weighted.
#[derive(Clone, Debug)]
pub(crate) struct Samples<const N: usize, const D: usize> {
    /// Derivatives of the shape functions that make up the gradient vectors, at each point, for the sums and differences
    /// over the corners (see `corners`).
    pub tables: Vec<[[f64; N]; D]>,
    /// Quadrature weight of each point over the parameter rectangle.
    pub weights: Vec<f64>,
    /// The points as squares, one after the other.
    pub patches: Vec<Patch<N>>,
}

impl<const N: usize, const D: usize> Samples<N, D> {
    /// Samples with the given tables and quadrature weights at the square of the points of a rule, or at several such
    /// squares on top of each other.
    pub fn new(rule: Rule, tables: Vec<[[f64; N]; D]>, weights: Vec<f64>) -> Self {
        let points: Vec<f64> = rule.points().into_iter().map(|(x, _)| x).collect();
        // With respect to two second derivatives, the stiffness of a curvature is a multiple of `n n^T`.
        let symmetric = |d: usize, e: usize| d == e || d.min(e) >= 2 && D == 5;
        let patches = tables.chunks(points.len().pow(2)).map(|tables| Patch::new(tables, &points, symmetric)).collect();
        Self { tables, weights, patches }
    }
}

/// A group of samples with its strain measure.
#[derive(Clone, Debug)]
pub(crate) enum Group<const N: usize> {
    /// Membrane strain of a surface.
    Membrane(Samples<N, 2>),
    /// Membrane strain of a surface, with its energy by generalised strains and a share of it by the samples.
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
            Self::Projected(samples, _) => samples.tables.len() * point_constants(COMPONENTS) + MODES * (MODES + 1) / 2,
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
