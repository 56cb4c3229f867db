//! What all elements with congruent reference shapes share: `eps_0`, `W` and the mass matrix.

use nalgebra::Vector3;
use pulp::{Scalar, Simd};

use crate::lanes::{Lanes, Vector};
use crate::material::Material;
use crate::strain::{Curvature, Measure, Metric, packed};

use super::corners::combine_all;
use super::tables::{Group, Samples, Tables};

/// The numbers of one class of congruent elements, in the order in which the kernel reads them.
///
/// For each group of samples that are weighted point by point: the reference area stretch `|R_x x R_y|`, the reference
/// strain (C) and the weight (C x C) of each point. For a group with generalised strains: the reference strain of each
/// point, then the packed matrix of the weights of the generalised strains.
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

/// For each generalised strain those that its stress depends on in any element, with the position of their weight.
pub(crate) type Couplings = Vec<Vec<(usize, usize)>>;

impl Constants {
    /// The constants of an element with the reference coordinates `reference`.
    ///
    /// # Source
    ///
    /// Dufva and Shabana (2005), (12), (15)-(17), (25), (30)-(34), (37): strains relative to the element's own field,
    /// components covariant, integrals over the reference area.
    pub fn new<const N: usize>(tables: &Tables<N>, reference: &[[f64; 3]; N], section: Section) -> Self {
        let Section { material, thickness } = section;
        let membrane = thickness;
        let bending = thickness.powi(3) / 12.0;
        let projected = tables.groups.iter().any(|group| matches!(group, Group::Projected(..)));
        let share = if projected { sampled_share(tables, reference, thickness) } else { 1.0 };
        let vectors = &combine_all(reference);
        let mut values = Vec::new();
        for group in &tables.groups {
            match group {
                Group::Membrane(samples) => {
                    for point in points::<Metric<Scalar>, N, 2>(samples, (), vectors, material) {
                        point.append(share * membrane, &mut values);
                    }
                }
                Group::Projected(samples, projection) => {
                    let points: Vec<_> = points::<Metric<Scalar>, N, 2>(samples, (), vectors, material).collect();
                    values.extend(points.iter().flat_map(|point| point.strain));
                    for (l, second) in projection.modes.iter().enumerate() {
                        for first in &projection.modes[..=l] {
                            let entry = first.basis.iter().map(|&(g, phi)| {
                                let same_point = second.basis.iter().find(|(other, _)| *other == g);
                                let product = same_point.map_or(0.0, |(_, psi)| phi * psi) / samples.weights[g].powi(2);
                                product * points[g].weight[first.component][second.component]
                            });
                            values.push((1.0 - share) * membrane * entry.sum::<f64>());
                        }
                    }
                }
                Group::Bending(samples, law) => {
                    for point in points::<Curvature<Scalar>, N, 5>(samples, *law, vectors, material) {
                        point.append(bending, &mut values);
                    }
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

/// The share of the membrane energy that is not projected, `min(1, (h / l)^2)`, `l` the larger side: enough to control
/// every mode, and the whole energy where the element is as thick as it is long.
fn sampled_share<const N: usize>(tables: &Tables<N>, reference: &[[f64; 3]; N], thickness: f64) -> f64 {
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

/// A sample in the reference state.
struct Point {
    area: f64,
    strain: [f64; COMPONENTS],
    /// Stiffness per thickness (or its third power over 12), times quadrature weight and area stretch.
    weight: [[f64; COMPONENTS]; COMPONENTS],
}

impl Point {
    fn append(&self, factor: f64, values: &mut Vec<f64>) {
        values.push(self.area);
        values.extend(self.strain);
        values.extend(self.weight.iter().flatten().map(|c| factor * c));
    }
}

/// The points of a group of surface samples.
fn points<M: Measure<Scalar, D, COMPONENTS>, const N: usize, const D: usize>(
    samples: &Samples<N, D>,
    law: M::Law,
    reference: &[[f64; 3]; N],
    material: Material,
) -> impl Iterator<Item = Point> {
    samples.tables.iter().zip(&samples.weights).map(move |(table, weight)| {
        let gradients = table.map(|row| interpolate(&row, reference));
        let metric =
            [gradients[0].dot(&gradients[0]), gradients[1].dot(&gradients[1]), gradients[0].dot(&gradients[1])];
        let determinant = metric[0] * metric[1] - metric[2] * metric[2];
        let area = determinant.sqrt();
        let stiffness =
            material.plane_stress([metric[1] / determinant, metric[0] / determinant, -metric[2] / determinant]);

        let splat = |x: f64| Lanes::splat(Scalar::new(), x);
        let lanes: [Vector<Scalar>; D] = gradients.map(|g| [splat(g.x), splat(g.y), splat(g.z)]);
        let strain = M::new(law, lanes, splat(area)).strain().map(Lanes::value);
        Point { area, strain, weight: stiffness.map(|row| row.map(|c| area * weight * c)) }
    })
}

/// `sum_a table_a e_a`.
fn interpolate<const N: usize>(table: &[f64; N], coordinates: &[[f64; 3]; N]) -> Vector3<f64> {
    table.iter().zip(coordinates).map(|(&t, e)| Vector3::from(*e) * t).sum()
}

/// Numbers of classes in lanes: of one class for all lanes, or of one for each.
#[inline(always)]
pub(crate) fn to_lanes<S: Simd>(
    simd: S,
    classes: &[&Constants],
    numbers: impl Fn(&Constants) -> &[f64],
    lanes: &mut Vec<Lanes<S>>,
) {
    lanes.clear();
    let first = classes[0];
    if classes.iter().all(|class| std::ptr::eq(*class, first)) {
        for &value in numbers(first) {
            lanes.push(Lanes::splat(simd, value));
        }
    } else {
        for i in 0..numbers(first).len() {
            lanes.push(Lanes::from_fn(simd, |lane| numbers(classes[lane])[i]));
        }
    }
}
