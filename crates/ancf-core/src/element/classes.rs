//! Congruent elements: those whose constants agree to rounding share one copy.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::strain::{SOLID_PAIRS, packed};

use super::block::coordinates;
use super::constants::{COMPONENTS, Constants, Section};
use super::kernel::point_constants;
use super::tables::{Group, Tables};

/// Numbers of congruent elements differ by less than this, relative to what they are compared with: well above the
/// rounding of a fine mesh, and a strain that no load could show.
const ROUNDING: f64 = 1.0 / (1_u64 << 40) as f64;

/// Elements whose constants are made at once.
const TASK: usize = 1024;

/// The constants of each class, and the class of each element; `vectors` are the nodal vectors of the elements, of which the
/// first of each corner is its position, and `reference` the nodal coordinates at rest.
pub(super) fn classes<const N: usize>(
    tables: &Tables<N>,
    vectors: &[[u32; N]],
    reference: &[f64],
    section: Section,
) -> (Vec<Constants>, Vec<u32>) {
    let mut classes = Classes { tables, thickness: section.thickness, classes: Vec::new(), nearby: HashMap::new() };
    let mut class_of = Vec::with_capacity(vectors.len());
    // Most elements of a grid are shifted copies of one before.
    let mut last = None;
    for vectors in vectors.chunks(TASK) {
        let shapes: Vec<_> = vectors
            .iter()
            .map(|vectors| {
                let shape = coordinates(vectors, reference);
                let copied = last.as_ref().is_some_and(|last| is_shifted(last, &shape));
                if !copied {
                    last = Some(shape);
                }
                (!copied).then_some(shape)
            })
            .collect();
        let constants: Vec<_> =
            shapes.par_iter().map(|shape| shape.as_ref().map(|shape| Constants::new(tables, shape, section))).collect();
        for constants in constants {
            let copied = class_of.last().copied();
            class_of.push(constants.map_or_else(|| copied.expect("what it is a copy of"), |own| classes.find(own)));
        }
    }
    (classes.classes, class_of)
}

/// Whether an element is another one, shifted, to rounding.
fn is_shifted<const N: usize>(one: &[[f64; 3]; N], other: &[[f64; 3]; N]) -> bool {
    let kinds = N / 4;
    let from_first = |element: &[[f64; 3]; N], a: usize| {
        let mut vector = element[a];
        if a.is_multiple_of(kinds) {
            (0..3).for_each(|c| vector[c] -= element[0][c]);
        }
        vector
    };
    // Each kind of vector is compared with the longest of it.
    let mut largest = [0.0_f64; N];
    let mut difference = [0.0_f64; N];
    for a in 0..N {
        let (u, v) = (from_first(one, a), from_first(other, a));
        for c in 0..3 {
            largest[a % kinds] = largest[a % kinds].max(u[c].abs());
            difference[a % kinds] = difference[a % kinds].max((u[c] - v[c]).abs());
        }
    }
    (0..kinds).all(|kind| difference[kind] <= ROUNDING * largest[kind])
}

/// Sorts constants into classes.
struct Classes<'a, const N: usize> {
    tables: &'a Tables<N>,
    thickness: f64,
    classes: Vec<Constants>,
    /// The classes by the size of their first number, so that only few are compared number by number.
    nearby: HashMap<i64, Vec<u32>>,
}

impl<const N: usize> Classes<'_, N> {
    /// The number of the class of `constants`: a known one, or a new one made of them.
    fn find(&mut self, constants: Constants) -> u32 {
        // Cells are so much wider than rounding that equal numbers are in the same or in neighbouring ones.
        let cell = (constants.values[0].ln() / (ROUNDING * 1024.0)) as i64;
        let near = (cell - 1..=cell + 1).filter_map(|cell| self.nearby.get(&cell)).flatten().copied();
        let agrees = |known: &u32| contains(&self.classes[*known as usize], &constants, self.tables, self.thickness);
        if let Some(known) = near.into_iter().find(agrees) {
            return known;
        }
        let new = self.classes.len() as u32;
        self.classes.push(constants);
        self.nearby.entry(cell).or_default().push(new);
        new
    }
}

/// Whether constants are those of a class.
fn contains<const N: usize>(class: &Constants, other: &Constants, tables: &Tables<N>, thickness: f64) -> bool {
    let pairs = class.values.iter().zip(&other.values).chain(class.mass.iter().zip(&other.mass));
    pairs.zip(tolerance(tables, class, thickness)).all(|((a, b), tolerance)| (a - b).abs() <= tolerance)
}

/// What each of the values and of the entries of the mass matrix may differ by: a share of the number itself on
/// diagonals and of the geometric mean of two diagonals beside them, so that the units of the parameters do not count.
fn tolerance<const N: usize>(tables: &Tables<N>, constants: &Constants, thickness: f64) -> Vec<f64> {
    let mut tolerance = Vec::with_capacity(constants.values.len() + constants.mass.len());
    let metric = metric(tables, constants);
    let mut rest = constants.values.as_slice();
    for group in &tables.groups {
        let (values, others) = rest.split_at(group.constants());
        rest = others;
        match group {
            Group::Projected(samples, projection) => {
                let (points, matrix) = values.split_at(samples.tables.len() * point_constants(COMPONENTS));
                extend_points(&mut tolerance, points, COMPONENTS, |strain| stretched(strain).to_vec());
                extend_packed(&mut tolerance, matrix, projection.modes.len());
            }
            Group::Membrane(_) => {
                extend_points(&mut tolerance, values, COMPONENTS, |strain| stretched(strain).to_vec());
            }
            Group::Bending(..) => {
                // Compared with curvatures that strain the faces by one: a flat surface has only rounding here.
                let scale = metric.map(|strain| strain / thickness);
                extend_points(&mut tolerance, values, COMPONENTS, |_| scale.to_vec());
            }
            Group::Solid(_) => extend_points(&mut tolerance, values, SOLID_PAIRS.len(), |strain| {
                SOLID_PAIRS.map(|(i, j)| 2.0 * (strain[i] * strain[j]).sqrt()).to_vec()
            }),
        }
    }
    extend_packed(&mut tolerance, &constants.mass, N);
    tolerance.iter().map(|scale| ROUNDING * scale).collect()
}

/// What membrane strains of the element are compared with at one of its points.
fn metric<const N: usize>(tables: &Tables<N>, constants: &Constants) -> [f64; COMPONENTS] {
    let mut start = 0;
    for group in &tables.groups {
        match group {
            Group::Projected(..) | Group::Membrane(_) => return stretched(&constants.values[start + 1..]),
            Group::Bending(..) | Group::Solid(_) => start += group.constants(),
        }
    }
    [1.0; COMPONENTS]
}

/// The metric that strains are compared with, from half of it as the samples measure it at the first point.
fn stretched(strain: &[f64]) -> [f64; COMPONENTS] {
    [strain[0], strain[1], 2.0 * (strain[0] * strain[1]).sqrt()]
}

/// Appends what the constants of points are compared with; `strain` gives it for their reference strain.
fn extend_points(scales: &mut Vec<f64>, values: &[f64], components: usize, strain: impl Fn(&[f64]) -> Vec<f64>) {
    for point in values.chunks(point_constants(components)) {
        let (reference, weights) = point[1..].split_at(components);
        let diagonal = |i: usize| weights[i * components + i];
        scales.push(point[0]);
        scales.extend(strain(reference));
        for i in 0..components {
            scales.extend((0..components).map(|j| (diagonal(i) * diagonal(j)).sqrt()));
        }
    }
}

/// Appends the geometric means of the diagonal entries of a packed matrix.
fn extend_packed(scales: &mut Vec<f64>, matrix: &[f64], size: usize) {
    let diagonal = |i: usize| matrix[packed(i, i)];
    for j in 0..size {
        scales.extend((0..=j).map(|i| (diagonal(i) * diagonal(j)).sqrt()));
    }
}
