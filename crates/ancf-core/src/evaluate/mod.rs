//! Quantities at material points.

mod quantity;
mod section;
mod station;

use nalgebra::Vector3;

use crate::error::InputError;
use crate::mesh::Grid;
use crate::model::{BodyId, Model};
use crate::quadrature::Rule;

pub use quantity::{Layer, Quantity};
use section::{Section, cauchy, in_plane, principal, von_mises};

/// A quantity at a material point, ready to be evaluated in many states.
///
/// Strains, forces and second Piola-Kirchhoff stresses have their components in the orthonormal frame that the reference
/// surface has at the point: x along `R_x`, y across it in the tangent plane. Stresses of a solid element are those of
/// its strain there, its forces and moments integrals of them through the thickness; its membrane strain and curvature
/// are those of the middle surface.
pub struct MaterialPoint {
    quantity: Quantity,
    section: Section,
    /// For the shear force of a thin element: points around, with the derivatives there of a field that is given at these
    /// points.
    around: Vec<(Section, [f64; 2])>,
}

impl MaterialPoint {
    /// A quantity at the point of a body with the given natural coordinates.
    ///
    /// # Errors
    ///
    /// The point must lie in the body.
    pub fn new(model: &Model, body: BodyId, point: [f64; 2], quantity: Quantity) -> Result<Self, InputError> {
        let body = model.body(body);
        let (element, at) = body.grid().locate(point)?;
        let section = |element, at, membrane| Section::new(model, body, element, at, membrane);
        let around = match quantity {
            Quantity::ShearForce if !body.plate().element.is_solid() => moment_points(body.grid(), element, at)
                .into_iter()
                .map(|(element, point, derivative)| (section(element, point, false), derivative))
                .collect(),
            _ => Vec::new(),
        };
        Ok(Self { quantity, section: section(element, at, quantity.needs_membrane()), around })
    }

    /// The components at nodal coordinates `q` and velocities `v`; those that a quantity does not have are zero.
    pub fn evaluate(&self, q: &[f64], v: &[f64]) -> [f64; 3] {
        let (section, at) = (&self.section, &self.section.at);
        let stress = |layer: Layer| {
            let (strain, stress) = section.layer(layer.side(), q);
            cauchy(&strain, &stress)
        };
        let values = match self.quantity {
            Quantity::Position => at.interpolate(0, q),
            Quantity::Displacement => at.interpolate(0, q) - at.reference[0],
            Quantity::Velocity => at.interpolate(0, v),
            Quantity::Normal => at.interpolate(1, q).cross(&at.interpolate(2, q)).normalize(),
            Quantity::MembraneStrain => at.membrane_strain(q),
            Quantity::Curvature => at.curvature(q),
            Quantity::MembraneForce => section.membrane_force(q),
            Quantity::Moment => section.moment(q),
            Quantity::ShearForce if self.around.is_empty() => section.solid_shear_force(q),
            Quantity::ShearForce => {
                let moments = self.around.iter().map(|(near, by)| (near.at.frame.tensor(near.moment(q)), by));
                let divergence: Vector3<f64> = moments.map(|(m, by)| m * at.frame.gradient(*by)).sum();
                let [x, y] = at.frame.axes;
                Vector3::new(-divergence.dot(&x), -divergence.dot(&y), 0.0)
            }
            Quantity::Stress(layer) => in_plane(&section.layer(layer.side(), q).1),
            Quantity::CauchyStress(layer) => in_plane(&stress(layer)),
            Quantity::PrincipalStress(layer) => principal(&stress(layer)),
            Quantity::VonMises(layer) => Vector3::new(von_mises(&stress(layer)), 0.0, 0.0),
        };
        values.into()
    }
}

/// Gauss points near a place `at` of an element, with the derivatives there along x and y of a field that is given at
/// these points: element, place in it, derivatives.
///
/// Moments are most accurate at the 2 x 2 Gauss points of an element, and the slopes between these in its middle. So a
/// slope is taken on the straight line through those of two elements: the slope of one alone is off by as much as shear
/// changes over half of it.
fn moment_points(grid: &Grid, element: usize, at: [f64; 2]) -> Vec<(usize, [f64; 2], [f64; 2])> {
    let sides = grid.element_sides();
    let points: Vec<f64> = Rule::Gauss(2).points().into_iter().map(|(x, _)| x).collect();
    let slope = 1.0 / (points[1] - points[0]);
    let linear = at.map(|at| [(points[1] - at) * slope, (at - points[0]) * slope]);
    let mut around = Vec::new();
    for along in [0, 1] {
        let across = 1 - along;
        for (element, share) in middles(grid, element, along, at[along]) {
            for place in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                let mut derivatives = [0.0; 2];
                derivatives[along] =
                    share * [-slope, slope][place[along]] / sides[along] * linear[across][place[across]];
                around.push((element, place.map(|i| points[i]), derivatives));
            }
        }
    }
    around
}

/// An element and its neighbour along x or y that is nearer to the place `at` in it, with their shares in the value there
/// of a straight line that is given in their middles.
fn middles(grid: &Grid, element: usize, along: usize, at: f64) -> Vec<(usize, f64)> {
    let [nx, _] = grid.divisions();
    let (index, stride) = [(element % nx, 1), (element / nx, nx)][along];
    let beyond = at - 0.5;
    let is_first = index == 0;
    let is_last = index + 1 == grid.divisions()[along];
    if is_first && is_last {
        vec![(element, 1.0)]
    } else if is_first || (beyond > 0.0 && !is_last) {
        vec![(element, 1.0 - beyond), (element + stride, beyond)]
    } else {
        vec![(element, 1.0 + beyond), (element - stride, -beyond)]
    }
}
