//! What all elements with the same sides in their parameters share.

use crate::mesh::SurfacePoint;
use crate::shape::{Polynomial, acm};
use crate::strain::CurvatureLaw;

use super::projection::Projection;

/// The element types, by the names that scenes use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `r`, `r_x`, `r_y` at four nodes, incomplete quartic shape functions.
    Thin36,
}

impl Kind {
    /// All element types.
    pub const ALL: [Self; 1] = [Self::Thin36];

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Thin36 => "thin36",
        }
    }

    /// The vectors at each node, as the derivative orders of the position that they are.
    pub fn nodal_vectors(self) -> &'static [NodalVector] {
        match self {
            Self::Thin36 => &[NodalVector::R, NodalVector::RX, NodalVector::RY],
        }
    }

    /// The derivatives of the shape functions of an element with the given sides, `in_x` and `in_y` times, at
    /// `(xi, eta)`.
    pub(crate) fn shape_functions(self, sides: [f64; 2], orders: [usize; 2], at: [f64; 2]) -> Vec<f64> {
        match self {
            Self::Thin36 => derivative(&acm(sides[0], sides[1]), sides, orders, at).to_vec(),
        }
    }
}

/// A vector at a node: the position or one of its gradients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodalVector {
    /// The position `r`.
    R,
    /// The gradient `r_x`.
    RX,
    /// The gradient `r_y`.
    RY,
}

impl NodalVector {
    /// All nodal vectors that some element has.
    pub const ALL: [Self; 3] = [Self::R, Self::RX, Self::RY];

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::R => "r",
            Self::RX => "r_x",
            Self::RY => "r_y",
        }
    }

    /// The vector at a point of a reference surface.
    pub fn of(self, point: &SurfacePoint) -> [f64; 3] {
        match self {
            Self::R => point.r,
            Self::RX => point.r_x,
            Self::RY => point.r_y,
        }
    }

    /// How often the position is differentiated along x and along y.
    pub fn orders(self) -> (i32, i32) {
        match self {
            Self::R => (0, 0),
            Self::RX => (1, 0),
            Self::RY => (0, 1),
        }
    }
}

/// Strain samples of one measure: the points, their shape tables, and how the samples are weighted.
#[derive(Clone, Debug)]
pub(crate) struct Samples<const N: usize, const D: usize> {
    /// Derivatives of the shape functions that make up the gradient vectors, at each point.
    pub tables: Vec<[[f64; N]; D]>,
    /// Quadrature weight of each point over the parameter rectangle.
    pub weights: Vec<f64>,
    /// Generalised strains that carry (most of) the energy in place of the samples themselves.
    pub projection: Option<Projection>,
}

/// A group of samples with its strain measure.
#[derive(Clone, Debug)]
pub(crate) enum Group<const N: usize> {
    /// Membrane strain of a surface.
    Membrane(Samples<N, 2>),
    /// Curvature of a surface.
    Bending(Samples<N, 5>, CurvatureLaw),
}

impl<const N: usize> Group<N> {
    /// Number of sample points and of generalised strains.
    pub fn size(&self) -> (usize, usize) {
        let modes = |projection: &Option<Projection>| projection.as_ref().map_or(0, |p| p.modes.len());
        match self {
            Self::Membrane(samples) => (samples.tables.len(), modes(&samples.projection)),
            Self::Bending(samples, _) => (samples.tables.len(), modes(&samples.projection)),
        }
    }
}

/// The tables of an element with `N` nodal vectors.
#[derive(Clone, Debug)]
pub(crate) struct Tables<const N: usize> {
    /// Sides of the element in its parameters.
    pub sides: [f64; 2],
    /// The shape functions in `xi = x / l`, `eta = y / w`.
    pub functions: [Polynomial; N],
    /// The sample groups that make up the energy.
    pub groups: Vec<Group<N>>,
    /// Shape functions and their first derivatives at the mass quadrature points, with the weights.
    pub mass: Vec<(Derivatives<N>, f64)>,
}

/// `N`, `N_x` and `N_y` at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Derivatives<const N: usize> {
    pub value: [f64; N],
    pub x: [f64; N],
    pub y: [f64; N],
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
