//! What all elements with congruent reference shapes share: `eps_0`, `W` and the mass matrix.

use nalgebra::Vector3;
use pulp::{Scalar, Simd};

use crate::lanes::{Lanes, Vector};
use crate::material::Material;
use crate::strain::{Curvature, Measure, Metric, packed};

use super::tables::{Group, Samples, Tables};

/// The numbers of one class of congruent elements, in the order in which the kernel reads them.
///
/// For each group of samples: for each point the reference area stretch `|R_x x R_y|`, the reference strain (C) and
/// the weight (C x C), then the packed matrix of weights of the generalised strains if there are any.
#[derive(Clone, Debug)]
pub(crate) struct Constants {
    pub values: Vec<f64>,
    /// Packed scalar mass matrix: `integral of rho h N_a N_b`.
    pub mass: Vec<f64>,
    /// `integral of rho h N_a`: the mass that each nodal vector stands for in a uniform field.
    pub weight: Vec<f64>,
}

/// What a body is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Section {
    pub material: Material,
    /// Thickness of the plate, m.
    pub thickness: f64,
}

/// Number of strain components of a surface measure.
pub(crate) const COMPONENTS: usize = 3;

/// Number of constants at a point with `c` strain components.
pub(crate) const fn point_stride(c: usize) -> usize {
    1 + c + c * c
}

impl Constants {
    /// The constants of an element with the reference coordinates `reference`.
    ///
    /// # Source
    ///
    /// Dufva and Shabana (2005), (12), (15)-(17), (25), (30)-(34), (37): strains relative to the element's own field,
    /// components covariant, integrals over the reference area.
    pub fn new<const N: usize>(tables: &Tables<N>, reference: &[[f64; 3]; N], section: Section) -> Self {
        let mut values = Vec::new();
        for group in &tables.groups {
            match group {
                Group::Membrane(samples) => {
                    let factor = section.thickness;
                    let delta = full_share(tables, reference, section.thickness);
                    append::<Metric<Scalar>, N, 2>(
                        &mut values,
                        samples,
                        (),
                        reference,
                        section.material,
                        factor,
                        delta,
                    );
                }
                Group::Bending(samples, law) => {
                    let factor = section.thickness.powi(3) / 12.0;
                    append::<Curvature<Scalar>, N, 5>(
                        &mut values,
                        samples,
                        *law,
                        reference,
                        section.material,
                        factor,
                        0.0,
                    );
                }
            }
        }

        let mut mass = vec![0.0; N * (N + 1) / 2];
        let mut weight = vec![0.0; N];
        for (shape, quadrature) in &tables.mass {
            let area = interpolate(&shape.x, reference).cross(&interpolate(&shape.y, reference)).norm();
            let factor = section.material.density() * section.thickness * area * quadrature;
            for b in 0..N {
                weight[b] += factor * shape.value[b];
                for a in 0..=b {
                    mass[packed(a, b)] += factor * shape.value[a] * shape.value[b];
                }
            }
        }
        Self { values, mass, weight }
    }
}

/// The share of the fully integrated membrane energy in the projected one, `min(1, (h / l)^2)`, `l` the larger side:
/// enough to control every mode, and the whole energy where the element is as thick as it is long.
fn full_share<const N: usize>(tables: &Tables<N>, reference: &[[f64; 3]; N], thickness: f64) -> f64 {
    let mut sides = [0.0; 2];
    let mut total = 0.0;
    for (shape, weight) in &tables.mass {
        sides[0] += weight * interpolate(&shape.x, reference).norm();
        sides[1] += weight * interpolate(&shape.y, reference).norm();
        total += weight;
    }
    let longer = (sides[0] * tables.sides[0]).max(sides[1] * tables.sides[1]) / total;
    (thickness / longer).powi(2).min(1.0)
}

/// Appends the constants of a group of surface samples.
fn append<M: Measure<Scalar, D, 3>, const N: usize, const D: usize>(
    values: &mut Vec<f64>,
    samples: &Samples<N, D>,
    law: M::Law,
    reference: &[[f64; 3]; N],
    material: Material,
    factor: f64,
    full_share: f64,
) {
    let splat = |x: f64| Lanes::splat(Scalar::new(), x);
    let mut weights = Vec::with_capacity(samples.tables.len());
    for (table, weight) in samples.tables.iter().zip(&samples.weights) {
        let gradients = table.map(|row| interpolate(&row, reference));
        let metric =
            [gradients[0].dot(&gradients[0]), gradients[1].dot(&gradients[1]), gradients[0].dot(&gradients[1])];
        let determinant = metric[0] * metric[1] - metric[2] * metric[2];
        let area = determinant.sqrt();
        let stiffness =
            material.plane_stress([metric[1] / determinant, metric[0] / determinant, -metric[2] / determinant]);
        let stiffness = stiffness.map(|row| row.map(|c| factor * area * weight * c));
        let pointwise = if samples.projection.is_some() { full_share } else { 1.0 };

        let lanes: [Vector<Scalar>; D] = gradients.map(|g| [splat(g.x), splat(g.y), splat(g.z)]);
        values.push(area);
        values.extend(M::new(law, lanes, splat(area)).strain().map(Lanes::value));
        values.extend(stiffness.iter().flatten().map(|c| pointwise * c));
        weights.push(stiffness);
    }
    if let Some(projection) = &samples.projection {
        for (l, second) in projection.modes.iter().enumerate() {
            for first in &projection.modes[..=l] {
                let entry: f64 = first
                    .basis
                    .iter()
                    .flat_map(|&(g, phi)| {
                        second.basis.iter().filter(move |(other, _)| *other == g).map(move |&(_, psi)| (g, phi * psi))
                    })
                    .map(|(g, product)| product * weights[g][first.component][second.component])
                    .sum();
                values.push((1.0 - full_share) * entry);
            }
        }
    }
}

/// `sum_a table_a e_a`.
fn interpolate<const N: usize>(table: &[f64; N], coordinates: &[[f64; 3]; N]) -> Vector3<f64> {
    table.iter().zip(coordinates).map(|(&t, e)| Vector3::from(*e) * t).sum()
}

/// The same constants in lanes: one class for all lanes, or one for each.
#[inline(always)]
pub(crate) fn to_lanes<S: Simd>(simd: S, classes: &[&Constants], lanes: &mut Vec<Lanes<S>>) {
    lanes.clear();
    let first = classes[0];
    if classes.iter().all(|class| std::ptr::eq(*class, first)) {
        for &value in &first.values {
            lanes.push(Lanes::splat(simd, value));
        }
    } else {
        for i in 0..first.values.len() {
            lanes.push(Lanes::from_fn(simd, |lane| classes[lane].values[i]));
        }
    }
}
