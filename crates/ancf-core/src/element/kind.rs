//! The registry of elements and of the vectors at their nodes.

use crate::error::InputError;
use crate::mesh::SurfacePoint;
use crate::shape::{acm, bilinear, hermite};
use crate::strain::CurvatureLaw;

use super::block::{Block, ElementBlock};
use super::constants::Section;
use super::full48::{director, full48a, full48b, hermite_middle, quartic_middle};
use super::tables::{Tables, derivative};
use super::thin::{Membrane, thin36, thin48};

/// The element types, by the names that scenes use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `r`, `r_x`, `r_y` at four nodes, incomplete quartic shape functions, thin.
    Thin36,
    /// `r`, `r_x`, `r_y`, `r_xy` at four nodes, bicubic shape functions, thin.
    Thin48,
    /// `r`, `r_x`, `r_y`, `r_z` at four nodes, incomplete quartic middle surface, a solid.
    Full48a,
    /// `r`, `r_x`, `r_y`, `r_z` at four nodes, bicubic middle surface without twist, a solid.
    Full48b,
}

/// How the energy of a thin element is sampled and measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Variant {
    pub membrane: Membrane,
    pub curvature: CurvatureLaw,
}

impl Kind {
    /// All element types.
    pub const ALL: [Self; 4] = [Self::Thin36, Self::Thin48, Self::Full48a, Self::Full48b];

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Thin36 => "thin36",
            Self::Thin48 => "thin48",
            Self::Full48a => "full48a",
            Self::Full48b => "full48b",
        }
    }

    /// The vectors at each node.
    pub fn nodal_vectors(self) -> &'static [NodalVector] {
        use NodalVector::{R, RX, RXY, RY, RZ};
        match self {
            Self::Thin36 => &[R, RX, RY],
            Self::Thin48 => &[R, RX, RY, RXY],
            Self::Full48a | Self::Full48b => &[R, RX, RY, RZ],
        }
    }

    /// Whether the element is a solid, with strain in all directions, and not a surface.
    pub fn is_solid(self) -> bool {
        self.nodal_vectors().contains(&NodalVector::RZ)
    }

    /// The derivatives of the shape functions on the middle surface of an element with the given sides, `in_x` and
    /// `in_y` times, at `(xi, eta)`.
    pub(crate) fn shape_functions(self, sides: [f64; 2], orders: [usize; 2], at: [f64; 2]) -> Vec<f64> {
        match self {
            Self::Thin36 => derivative(&acm(sides), sides, orders, at).to_vec(),
            Self::Thin48 => derivative(&hermite(sides), sides, orders, at).to_vec(),
            Self::Full48a => derivative(&quartic_middle(sides), sides, orders, at).to_vec(),
            Self::Full48b => derivative(&hermite_middle(sides), sides, orders, at).to_vec(),
        }
    }

    /// The shape functions of the vector that a moment about an edge turns, at a point `(xi, eta)` of the edge; `across`
    /// is the parameter that is constant there.
    ///
    /// It is what the nodal vectors of the edge itself tell: the gradient across it, and in a solid `r_z`, which
    /// tractions do work on that are linear over the thickness. Of `thin36` that is the linear part of the gradient.
    /// The rest depends on the far nodes and is the same on opposite edges of an element, so that constant moments
    /// inside do no work on it; if those on the edge did, plates would bend too far.
    pub(crate) fn edge_director(self, sides: [f64; 2], across: usize, at: [f64; 2]) -> Vec<f64> {
        let turned = match self {
            Self::Thin48 => return self.shape_functions(sides, if across == 0 { [1, 0] } else { [0, 1] }, at),
            Self::Thin36 => 1 + across,
            Self::Full48a | Self::Full48b => 3,
        };
        let mut table = vec![0.0; 4 * self.nodal_vectors().len()];
        let corners = derivative(&bilinear(), sides, [0, 0], at);
        table.iter_mut().skip(turned).step_by(self.nodal_vectors().len()).zip(corners).for_each(|(t, n)| *t = n);
        table
    }

    /// The derivatives of the shape functions of a solid's vector through the thickness, as
    /// [`shape_functions`](Self::shape_functions).
    pub(crate) fn director_functions(self, sides: [f64; 2], orders: [usize; 2], at: [f64; 2]) -> Vec<f64> {
        derivative(&director(), sides, orders, at).to_vec()
    }

    /// The variant of the element, the default where nothing is given.
    ///
    /// # Errors
    ///
    /// `thin48` has no `lobatto`, and a solid has neither membrane strain nor curvature to choose.
    pub(crate) fn variant(
        self,
        membrane: Option<Membrane>,
        curvature: Option<CurvatureLaw>,
    ) -> Result<Variant, InputError> {
        let given = [("membrane", membrane.map(Membrane::name)), ("curvature", curvature.map(CurvatureLaw::name))];
        let allowed = format!("none: {} has the strain of a solid, not of membrane and curvature", self.name());
        for (argument, value) in given {
            if let (true, Some(value)) = (self.is_solid(), value) {
                return Err(InputError::new(argument, format!("{value:?}"), allowed));
            }
        }
        let allowed = "projected or full: nine motions of a thin48 cost no energy with lobatto, not six";
        let soft = self == Self::Thin48 && membrane == Some(Membrane::Lobatto);
        InputError::check("membrane", format!("{:?}", Membrane::Lobatto.name()), !soft, allowed)?;
        Ok(Variant { membrane: membrane.unwrap_or_default(), curvature: curvature.unwrap_or_default() })
    }

    /// Elements of this type with the given sides in their parameters on the given nodal vectors, one element after
    /// the other; `reference` are the nodal coordinates of the whole model at rest.
    pub(crate) fn block(
        self,
        sides: [f64; 2],
        variant: Variant,
        section: Section,
        vectors: &[u32],
        reference: &[f64],
    ) -> Box<dyn ElementBlock> {
        fn boxed<const N: usize>(
            tables: Tables<N>,
            vectors: &[u32],
            reference: &[f64],
            section: Section,
        ) -> Box<dyn ElementBlock> {
            Box::new(Block::new(tables, vectors.as_chunks().0.to_vec(), reference, section))
        }
        match self {
            Self::Thin36 => boxed(thin36(sides, variant), vectors, reference, section),
            Self::Thin48 => boxed(thin48(sides, variant), vectors, reference, section),
            Self::Full48a => boxed(full48a(sides, section.thickness), vectors, reference, section),
            Self::Full48b => boxed(full48b(sides, section.thickness), vectors, reference, section),
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
    /// The mixed second derivative `r_xy`.
    RXY,
    /// The gradient `r_z` through the thickness.
    RZ,
}

impl NodalVector {
    /// All nodal vectors that some element has.
    pub const ALL: [Self; 5] = [Self::R, Self::RX, Self::RY, Self::RXY, Self::RZ];

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::R => "r",
            Self::RX => "r_x",
            Self::RY => "r_y",
            Self::RXY => "r_xy",
            Self::RZ => "r_z",
        }
    }

    /// The vector at a point of a reference surface; through the thickness it is the unit normal.
    pub fn of(self, point: &SurfacePoint) -> [f64; 3] {
        match self {
            Self::R => point.r,
            Self::RX => point.r_x,
            Self::RY => point.r_y,
            Self::RXY => point.r_xy,
            Self::RZ => point.normal(),
        }
    }

    /// How often the position on the middle surface is differentiated along x and along y; none for `r_z`.
    pub fn orders(self) -> Option<(i32, i32)> {
        match self {
            Self::R => Some((0, 0)),
            Self::RX => Some((1, 0)),
            Self::RY => Some((0, 1)),
            Self::RXY => Some((1, 1)),
            Self::RZ => None,
        }
    }
}
