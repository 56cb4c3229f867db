//! What all elements with congruent reference shapes share: `eps_0`, `W` and the mass matrix.

use nalgebra::{DMatrix, Matrix3, Vector3};
use pulp::{Scalar, Simd};

use crate::lanes::{Lanes, Transpose, Vector};
use crate::material::Material;
use crate::strain::{Curvature, GreenLagrange, Measure, Metric, packed};

use super::corners::combine_all;
use super::projection::{MODES, Projection};
use super::tables::{Group, Samples, Tables};

/// The numbers of one class of congruent elements, in the order in which the kernel reads them.
///
/// For each group of samples: the reference area (or volume) stretch, the reference strain (C) and the weight (C x C) of
/// each point, then, if it has generalised strains, the packed matrix of their weights.
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
        let mut combined = *reference;
        combine_all(&mut combined);
        let vectors = &combined;
        let surface = |gradients: &[Vector3<f64>]| plane_stress(material, &gradients[0], &gradients[1]);
        let mut values = Vec::new();
        for group in &tables.groups {
            match group {
                Group::Membrane(samples) => {
                    for point in points::<Metric<Scalar>, N, 2, 3>(samples, (), vectors, |g| surface(g)) {
                        point.append(membrane, &mut values);
                    }
                }
                Group::Projected(samples, projection) => {
                    let sides = mean_sides(tables, reference);
                    let longer = sides[0].max(sides[1]);
                    // Enough to control every mode, and the whole energy where the element is as thick as it is long.
                    let share = (thickness / longer).powi(2).min(1.0);
                    let followed = sides.map(|side| side / projection.followed);
                    let rough = RoughShares::new(shape_points(tables, vectors), thickness, followed);
                    let curvature = geodesic_curvatures(shape_points(tables, vectors));
                    let across = [0, 1].map(|a| rough.normal * (curvature[1 - a] * sides[a]).powi(2));
                    let mut points: Vec<_> =
                        points::<Metric<Scalar>, N, 2, 3>(samples, (), vectors, |g| surface(g)).collect();
                    for point in &mut points {
                        point.split(share, across).append(membrane, &mut values);
                    }
                    let mut weight = DMatrix::from_fn(MODES, MODES, |k, l| {
                        let [first, second] = [&projection.modes[k], &projection.modes[l]];
                        let entry = first.basis.iter().map(|&(g, phi)| {
                            let same_point = second.basis.iter().find(|(other, _)| *other == g);
                            let product = same_point.map_or(0.0, |(_, psi)| phi * psi) / samples.weights[g].powi(2);
                            product * points[g].weight[first.component][second.component]
                        });
                        membrane * entry.sum::<f64>()
                    });
                    if rough.normal.min(rough.shear[0]).min(rough.shear[1]) < 1.0 {
                        let reduced = Projection::<N>::reduction(rough.normal.sqrt(), rough.shear.map(f64::sqrt));
                        weight = &reduced * weight * &reduced;
                    }
                    for l in 0..MODES {
                        values.extend((0..=l).map(|k| weight[(k, l)]));
                    }
                }
                Group::Bending(samples, law) => {
                    for point in points::<Curvature<Scalar>, N, 5, 3>(samples, *law, vectors, |g| surface(g)) {
                        point.append(bending, &mut values);
                    }
                }
                Group::Solid(samples) => {
                    let solid = |gradients: &[Vector3<f64>; 3]| hooke(material, gradients);
                    for point in points::<GreenLagrange<Scalar>, N, 3, 6>(samples, (), vectors, solid) {
                        point.append(thickness, &mut values);
                    }
                }
            }
        }

        let mut mass = vec![0.0; N * (N + 1) / 2];
        let mut weight = vec![0.0; N];
        for (shape, quadrature) in &tables.mass {
            let normal = interpolate(&shape.x, reference).cross(&interpolate(&shape.y, reference));
            let stretch = shape.z.map_or(normal.norm(), |z| normal.dot(&interpolate(&z, reference)));
            let factor = material.density() * thickness * stretch * quadrature;
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

/// The mean lengths of an element along x and along y.
fn mean_sides<const N: usize>(tables: &Tables<N>, reference: &[[f64; 3]; N]) -> [f64; 2] {
    let mut sides = [0.0; 2];
    let mut total = 0.0;
    for (shape, weight) in &tables.mass {
        sides[0] += weight * interpolate(&shape.x, reference).norm();
        sides[1] += weight * interpolate(&shape.y, reference).norm();
        total += weight;
    }
    [0, 1].map(|a| sides[a] * tables.sides[a] / total)
}

/// The shares of the energy of membrane strains that are not bilinear: `min(1, h^2 / (12 C length^4))`.
///
/// A curved surface bends without stretching in fields that the element cannot follow in these parts. What it cannot
/// follow, a wave of the wave number `1 / length` and more, would stretch it: with an energy that is that of bending
/// over this share, and must not be more than that of bending.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoughShares {
    /// Of `E_xx`, `E_yy`: `C` is the mean Gaussian curvature `|K|`, `length` the longer one.
    pub normal: f64,
    /// Of the squares of x and of y in `E_xy`: `C` is `|K|` or the square of the mean curvature along x (or y), whichever is
    /// larger, and `length` the one in that direction. A cylinder twists in waves along its curved side.
    pub shear: [f64; 2],
}

impl RoughShares {
    /// From weights and derivatives along x, y, xx, yy and xy of the reference position at points of the element.
    pub fn new(points: impl Iterator<Item = (f64, [Vector3<f64>; 5])>, thickness: f64, length: [f64; 2]) -> Self {
        let (mut gaussian, mut along, mut total) = (0.0, [0.0; 2], 0.0);
        for (weight, [x, y, xx, yy, xy]) in points {
            let n = x.cross(&y);
            let [b_xx, b_yy, b_xy] = [xx, yy, xy].map(|second| second.dot(&n) / n.norm());
            gaussian += weight * (b_xx * b_yy - b_xy.powi(2)) / n.norm_squared();
            along[0] += weight * b_xx / x.norm_squared();
            along[1] += weight * b_yy / y.norm_squared();
            total += weight;
        }
        let gaussian = gaussian.abs() / total;
        let share = |curvature: f64, length: f64| (thickness.powi(2) / (12.0 * curvature * length.powi(4))).min(1.0);
        Self {
            normal: share(gaussian, length[0].max(length[1])),
            shear: [0, 1].map(|a| share(gaussian.max((along[a] / total).powi(2)), length[a])),
        }
    }
}

/// The mean geodesic curvatures of the lines along x and along y, 1/m: how they bend within the surface.
fn geodesic_curvatures(points: impl Iterator<Item = (f64, [Vector3<f64>; 5])>) -> [f64; 2] {
    let (mut sums, mut total) = ([0.0; 2], 0.0);
    for (weight, [x, y, xx, yy, _]) in points {
        let n = x.cross(&y).normalize();
        for (sum, (along, second)) in sums.iter_mut().zip([(x, xx), (y, yy)]) {
            *sum += weight * second.dot(&n.cross(&along)) / along.norm().powi(3);
        }
        total += weight;
    }
    sums.map(|sum| sum / total)
}

/// Weights and derivatives of the reference position at the points at which curvature is sampled.
fn shape_points<'a, const N: usize>(
    tables: &'a Tables<N>,
    reference: &'a [[f64; 3]; N],
) -> impl Iterator<Item = (f64, [Vector3<f64>; 5])> + 'a {
    let bending = tables.groups.iter().filter_map(|group| match group {
        Group::Bending(samples, _) => Some(samples),
        _ => None,
    });
    bending.flat_map(move |samples| {
        let derivatives = samples.tables.iter().map(move |table| table.map(|row| interpolate(&row, reference)));
        samples.weights.iter().copied().zip(derivatives)
    })
}

/// A sample in the reference state.
struct Point<const C: usize> {
    /// Area (or volume) for a unit of the parameters.
    stretch: f64,
    strain: [f64; C],
    /// Stiffness per thickness (or its third power over 12), times quadrature weight and stretch.
    weight: [[f64; C]; C],
}

impl Point<COMPONENTS> {
    /// Takes from the weight a part for the strain as it is, and returns it; what is left is for the projected strain.
    ///
    /// It has `share` of all, and `across` of the stiffness that `E_xx` and `E_yy` have where no stress holds the other
    /// components: that leaves no negative energy.
    fn split(&mut self, share: f64, across: [f64; 2]) -> Self {
        let whole = Matrix3::from(self.weight);
        // As a share of its size, so that its determinant does not vanish in soft, thin, small elements.
        let size = whole.norm();
        let compliance = (whole / size).try_inverse().expect("a stiffness") / size;
        let mut part = share * whole;
        for a in 0..2 {
            part[(a, a)] += across[a].min(1.0 - share) / compliance[(a, a)];
        }
        self.weight = (whole - part).into();
        Self { stretch: self.stretch, strain: self.strain, weight: part.into() }
    }
}

impl<const C: usize> Point<C> {
    fn append(&self, factor: f64, values: &mut Vec<f64>) {
        values.push(self.stretch);
        values.extend(self.strain);
        values.extend(self.weight.iter().flatten().map(|c| factor * c));
    }
}

/// The points of a group of samples; `stiffness` gives stretch and material stiffness for the reference gradients.
fn points<M: Measure<Scalar, D, C>, const N: usize, const D: usize, const C: usize>(
    samples: &Samples<N, D>,
    law: M::Law,
    reference: &[[f64; 3]; N],
    stiffness: impl Fn(&[Vector3<f64>; D]) -> (f64, [[f64; C]; C]),
) -> impl Iterator<Item = Point<C>> {
    samples.tables.iter().zip(&samples.weights).map(move |(table, weight)| {
        let gradients = table.map(|row| interpolate(&row, reference));
        let (stretch, stiffness) = stiffness(&gradients);
        let splat = |x: f64| Lanes::splat(Scalar::new(), x);
        let lanes: [Vector<Scalar>; D] = gradients.map(|g| [splat(g.x), splat(g.y), splat(g.z)]);
        let strain = M::new(law, lanes, splat(stretch)).strain().map(Lanes::value);
        Point { stretch, strain, weight: stiffness.map(|row| row.map(|c| stretch * weight * c)) }
    })
}

/// Area stretch and plane-stress stiffness for the reference gradients of a surface.
fn plane_stress(material: Material, x: &Vector3<f64>, y: &Vector3<f64>) -> (f64, [[f64; 3]; 3]) {
    let metric = [x.dot(x), y.dot(y), x.dot(y)];
    let determinant = metric[0] * metric[1] - metric[2] * metric[2];
    let inverse = [metric[1] / determinant, metric[0] / determinant, -metric[2] / determinant];
    (determinant.sqrt(), material.plane_stress(inverse))
}

/// Volume stretch and Hooke's stiffness for the reference gradients of a solid.
fn hooke(material: Material, gradients: &[Vector3<f64>; 3]) -> (f64, [[f64; 6]; 6]) {
    let jacobian = Matrix3::from_columns(gradients);
    let inverse = jacobian.try_inverse().expect("r_x and r_y span a plane, r_z points along its normal");
    let metric = inverse * inverse.transpose();
    (jacobian.determinant(), material.hooke([0, 1, 2].map(|i| [0, 1, 2].map(|j| metric[(i, j)]))))
}

/// `sum_a table_a e_a`.
fn interpolate<const N: usize>(table: &[f64; N], coordinates: &[[f64; 3]; N]) -> Vector3<f64> {
    table.iter().zip(coordinates).map(|(&t, e)| Vector3::from(*e) * t).sum()
}

/// Numbers of classes in lanes: of one class for all lanes, or of one for each.
#[inline(always)]
pub(crate) fn to_lanes<S: Simd>(
    simd: S,
    order: Transpose<S>,
    classes: &[&Constants],
    numbers: impl Fn(&Constants) -> &[f64],
    lanes: &mut Vec<Lanes<S>>,
) {
    let first = classes[0];
    lanes.resize(numbers(first).len(), Lanes::splat(simd, 0.0));
    if classes.iter().all(|class| std::ptr::eq(*class, first)) {
        for (lanes, &value) in lanes.iter_mut().zip(numbers(first)) {
            *lanes = Lanes::splat(simd, value);
        }
    } else {
        order.load(|element| numbers(classes[element]), lanes);
    }
}
