//! What the section of a body carries at a point: strain and stress of its layers, forces and moments.

use nalgebra::{Matrix3, Vector3};

use crate::element::{Membrane, RoughShares, followed};
use crate::model::{Body, Model, Plate};
use crate::quadrature::{Rule, legendre};
use crate::strain::SOLID_PAIRS;

use super::station::Station;

/// A point of an element with what its membrane strain depends on.
///
/// The energy of `projected` and `lobatto` does not see the strain at a point but a polynomial through the samples; so do
/// forces and stresses, or a bent element would show the membrane forces that its cure of locking leaves out.
pub(super) struct Section {
    plate: Plate,
    pub at: Station,
    /// Share of each covariant strain component of these points in the strain that carries energy here.
    samples: Vec<(Station, Vector3<f64>)>,
}

impl Section {
    /// The section at a point of an element; without `membrane` it knows of curvature only.
    pub fn new(model: &Model, body: &Body, element: usize, point: [f64; 2], membrane: bool) -> Self {
        let station = |at| Station::new(model, body, element, at);
        let samples = match body.membrane().filter(|_| membrane) {
            None => Vec::new(),
            Some(Membrane::Full) => vec![(point, Vector3::repeat(1.0))],
            Some(Membrane::Lobatto) => {
                let [x, y] = point.map(|at| lagrange(Rule::Lobatto3, at));
                let product = |k: usize| Vector3::repeat(x[k % 3] * y[k / 3]);
                Rule::Lobatto3.square().into_iter().enumerate().map(|(k, (at, _))| (at, product(k))).collect()
            }
            Some(Membrane::Projected) => {
                let rule = Rule::Gauss(4);
                let centre = station([0.5; 2]);
                let [l, w] = body.grid().element_sides();
                let sides = [l * centre.reference[1].norm(), w * centre.reference[2].norm()];
                let thickness = body.plate().thickness;
                let share = (thickness / sides[0].max(sides[1])).powi(2).min(1.0);
                let lengths = sides.map(|side| side / followed(body.plate().element));
                let shape = Rule::Gauss(3).square().into_iter().map(|(at, weight)| {
                    let [_, x, y, xx, yy, xy] = station(at).reference;
                    (weight, [x, y, xx, yy, xy])
                });
                let rough = RoughShares::new(shape, thickness, lengths);
                let [cubic_x, cubic_y] = point.map(|at| lagrange(rule, at));
                let [fit_x, fit_y] = point.map(|at| least_squares(rule, at));
                let weights = |k: usize| {
                    let [x, y] = [fit_x[k % 4], fit_y[k / 4]];
                    let [in_x, in_y] = [x[0] + x[1], y[0] + y[1]];
                    // What is not bilinear carries its share of energy, and of force.
                    let along_x = in_x * (in_y + rough.normal * (cubic_y[k / 4] - in_y));
                    let along_y = in_y * (in_x + rough.normal * (cubic_x[k % 4] - in_x));
                    let shear = in_x * in_y + rough.shear[0] * x[2] * y[0] + rough.shear[1] * x[0] * y[2];
                    (1.0 - share) * Vector3::new(along_x, along_y, shear)
                };
                let projected = rule.square().into_iter().enumerate().map(|(k, (at, _))| (at, weights(k)));
                projected.chain([(point, Vector3::repeat(share))]).collect()
            }
        };
        let samples = samples.into_iter().map(|(at, weights)| (station(at), weights)).collect();
        Self { plate: *body.plate(), at: station(point), samples }
    }

    /// The membrane strain that carries energy: `E_xx`, `E_yy`, `2 E_xy` in the frame.
    fn membrane_strain(&self, q: &[f64]) -> Vector3<f64> {
        let parts = self.samples.iter().map(|(station, weights)| station.covariant_strain(q).component_mul(weights));
        self.at.frame.strain(parts.sum())
    }

    /// Green-Lagrange strain and second Piola-Kirchhoff stress at a height in units of half the thickness.
    pub fn layer(&self, side: f64, q: &[f64]) -> (Matrix3<f64>, Matrix3<f64>) {
        let z = 0.5 * side * self.plate.thickness;
        if self.plate.element.is_solid() {
            let strain = self.at.solid_strain(z, q);
            (strain, self.solid_stress(&strain))
        } else {
            let strain = self.membrane_strain(q) - z * self.at.curvature(q);
            let across = self.plate.material.strain_across(strain.x + strain.y);
            let half = 0.5 * strain.z;
            let tensor = Matrix3::new(strain.x, half, 0.0, half, strain.y, 0.0, 0.0, 0.0, across);
            let stress = self.plane_stress(&strain);
            (tensor, Matrix3::new(stress.x, stress.z, 0.0, stress.z, stress.y, 0.0, 0.0, 0.0, 0.0))
        }
    }

    /// `N_xx`, `N_yy`, `N_xy`, N/m.
    pub fn membrane_force(&self, q: &[f64]) -> Vector3<f64> {
        if self.plate.element.is_solid() {
            self.integrate(q, |_, stress| in_plane(stress))
        } else {
            self.plate.thickness * self.plane_stress(&self.membrane_strain(q))
        }
    }

    /// `M_xx`, `M_yy`, `M_xy`, N m/m.
    pub fn moment(&self, q: &[f64]) -> Vector3<f64> {
        if self.plate.element.is_solid() {
            self.integrate(q, |z, stress| -z * in_plane(stress))
        } else {
            self.plate.thickness.powi(3) / 12.0 * self.plane_stress(&self.at.curvature(q))
        }
    }

    /// Transverse shear force of a solid, `xz`, `yz`, N/m.
    pub fn solid_shear_force(&self, q: &[f64]) -> Vector3<f64> {
        self.integrate(q, |_, stress| Vector3::new(stress[(0, 2)], stress[(1, 2)], 0.0))
    }

    /// Integral through the thickness of a solid. Stress is quadratic in z, so that two Gauss points are exact.
    fn integrate(&self, q: &[f64], part: impl Fn(f64, &Matrix3<f64>) -> Vector3<f64>) -> Vector3<f64> {
        let h = self.plate.thickness;
        let at = |(zeta, weight): (f64, f64)| {
            let side = 2.0 * zeta - 1.0;
            h * weight * part(0.5 * h * side, &self.layer(side, q).1)
        };
        Rule::Gauss(2).points().into_iter().map(at).sum()
    }

    fn plane_stress(&self, strain: &Vector3<f64>) -> Vector3<f64> {
        let stiffness = self.plate.material.plane_stress([1.0, 1.0, 0.0]);
        stiffness.map(|row| Vector3::from(row).dot(strain)).into()
    }

    fn solid_stress(&self, strain: &Matrix3<f64>) -> Matrix3<f64> {
        let components = SOLID_PAIRS.map(|(i, j)| strain[(i, j)] * if i == j { 1.0 } else { 2.0 });
        let stiffness = self.plate.material.hooke([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let mut stress = Matrix3::zeros();
        for (row, (i, j)) in stiffness.iter().zip(SOLID_PAIRS) {
            let value = row.iter().zip(components).map(|(c, e)| c * e).sum();
            (stress[(i, j)], stress[(j, i)]) = (value, value);
        }
        stress
    }
}

/// `xx`, `yy`, `xy`.
pub(super) fn in_plane(tensor: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(tensor[(0, 0)], tensor[(1, 1)], tensor[(0, 1)])
}

/// Cauchy stress in the frame of the deformed layer, x along its `r_x`, z normal to it: with the deformation gradient that
/// is upper triangular in this frame. Not a number where the material has collapsed.
///
/// # Source
///
/// Bonet and Wood, Nonlinear Continuum Mechanics (2008), 5.5: `sigma = F S F^T / det F`.
pub(super) fn cauchy(strain: &Matrix3<f64>, stress: &Matrix3<f64>) -> Matrix3<f64> {
    match (Matrix3::identity() + 2.0 * strain).cholesky() {
        Some(factor) => factor.l().transpose() * stress * factor.l() / factor.l().determinant(),
        None => Matrix3::repeat(f64::NAN),
    }
}

/// The larger and the smaller principal value in the plane.
pub(super) fn principal(stress: &Matrix3<f64>) -> Vector3<f64> {
    let [x, y, xy]: [f64; 3] = in_plane(stress).into();
    let (mean, radius) = (0.5 * (x + y), (0.5 * (x - y)).hypot(xy));
    Vector3::new(mean + radius, mean - radius, 0.0)
}

/// Von Mises' equivalent stress.
pub(super) fn von_mises(stress: &Matrix3<f64>) -> f64 {
    let deviator = stress - Matrix3::identity() * (stress.trace() / 3.0);
    (1.5 * deviator.norm_squared()).sqrt()
}

/// The polynomials that are one at one point of a rule and zero at the others.
fn lagrange(rule: Rule, at: f64) -> Vec<f64> {
    let points: Vec<f64> = rule.points().into_iter().map(|(x, _)| x).collect();
    let others = |i: usize| (0..points.len()).filter(move |j| *j != i);
    (0..points.len()).map(|i| others(i).map(|j| (at - points[j]) / (points[i] - points[j])).product()).collect()
}

/// The parts of degree 0 to 2 of the least-squares fit to values at the points of a Gauss rule, at a place, by value.
fn least_squares(rule: Rule, at: f64) -> Vec<[f64; 3]> {
    let fit = |(x, weight): (f64, f64)| [0, 1, 2].map(|degree| weight * legendre(degree, x) * legendre(degree, at));
    rule.points().into_iter().map(fit).collect()
}
