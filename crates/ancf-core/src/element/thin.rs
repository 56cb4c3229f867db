//! The thin elements: membrane strain and curvature of a surface.

use crate::quadrature::Rule;
use crate::shape::{Polynomial, acm, hermite};

use super::corners::functions;
use super::kind::{Kind, Variant};
use super::projection::Projection;
use super::tables::{Derivatives, Group, Samples, Tables, derivative};

/// How the membrane strain is sampled and weighted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Membrane {
    /// 4 x 4 Gauss points, the strain projected on what the element can control: best in bending and on shells.
    #[default]
    Projected,
    /// 4 x 4 Gauss points: the element of the paper; locks when bent by few elements.
    Full,
    /// 3 x 3 Lobatto points, with 2 x 2 Gauss points for the curvature: the cheapest.
    Lobatto,
}

impl Membrane {
    /// All variants.
    pub const ALL: [Self; 3] = [Self::Projected, Self::Full, Self::Lobatto];

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Projected => "projected",
            Self::Full => "full",
            Self::Lobatto => "lobatto",
        }
    }

    /// The rules for membrane strain and curvature.
    pub(crate) fn rules(self) -> (Rule, Rule) {
        match self {
            Self::Projected | Self::Full => (Rule::Gauss(4), Rule::Gauss(3)),
            Self::Lobatto => (Rule::Lobatto3, Rule::Gauss(2)),
        }
    }
}

/// The thin plate of the paper with 36 degrees of freedom, for parameters of the given sides.
///
/// # Source
///
/// Dufva and Shabana (2005), section 3 and Appendix 2.
pub(crate) fn thin36(sides: [f64; 2], variant: Variant) -> Tables<12> {
    tables(sides, acm(sides), variant, followed(Kind::Thin36))
}

/// The thin plate with 48 degrees of freedom, whose slope is continuous too.
///
/// # Source
///
/// Dmitrochenko and Pogorelov (2003).
pub(crate) fn thin48(sides: [f64; 2], variant: Variant) -> Tables<16> {
    tables(sides, hermite(sides), variant, followed(Kind::Thin48))
}

/// The wave number times the side up to which an element follows a curved surface that bends without stretching.
pub(crate) fn followed(kind: Kind) -> f64 {
    if kind == Kind::Thin48 { 12.0_f64.sqrt().sqrt() } else { 1.0 }
}

/// The tables of a thin element with any shape functions; `followed` is for the [projection](Projection).
fn tables<const N: usize>(
    sides: [f64; 2],
    functions: [Polynomial; N],
    Variant { membrane, curvature }: Variant,
    followed: f64,
) -> Tables<N> {
    let (membrane_rule, bending_rule) = membrane.rules();
    let area = sides[0] * sides[1];
    let at = |orders: [usize; 2], point: [f64; 2]| derivative(&functions, sides, orders, point);
    let units = [1.0, sides[0], sides[1], area];
    let bent = samples(units, bending_rule, |p| [[1, 0], [0, 1], [2, 0], [0, 2], [1, 1]].map(|d| at(d, p)));
    let stretched = samples(units, membrane_rule, |p| [[1, 0], [0, 1]].map(|d| at(d, p)));
    let stretched = match membrane {
        Membrane::Projected => {
            let projection = Projection::membrane(&stretched, followed);
            Group::Projected(stretched, projection)
        }
        Membrane::Full | Membrane::Lobatto => Group::Membrane(stretched),
    };
    let groups = vec![Group::Bending(bent, curvature), stretched];
    let mass = Rule::Gauss(5).square().into_iter().map(|(point, weight)| {
        (Derivatives { value: at([0, 0], point), x: at([1, 0], point), y: at([0, 1], point), z: None }, weight * area)
    });
    Tables { sides, functions, mass: mass.collect(), groups }
}

/// Samples at the points of a rule; `units` are those of the kinds of shape functions, the last one the area.
fn samples<const N: usize, const D: usize>(
    units: [f64; 4],
    rule: Rule,
    table: impl Fn([f64; 2]) -> [[f64; N]; D],
) -> Samples<N, D> {
    let points = rule.square().into_iter();
    let table = |p| table(p).map(|row| functions(&row, &units));
    let (tables, weights) = points.map(|(p, weight)| (table(p), weight * units[3])).unzip();
    Samples::new(rule, tables, weights)
}
