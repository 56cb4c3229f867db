//! Congruent elements: those whose constants agree to rounding share one copy.

use std::collections::HashMap;

use crate::strain::{SOLID_PAIRS, packed};

use super::constants::{COMPONENTS, Constants};
use super::kernel::point_constants;
use super::tables::{Group, Tables};

/// Numbers of congruent elements differ by less than this, relative to what they are compared with: well above the
/// rounding of a fine mesh, and a strain that no load could show.
const ROUNDING: f64 = 1.0 / (1_u64 << 40) as f64;

/// Sorts constants into classes.
pub(super) struct Classes<'a, const N: usize> {
    tables: &'a Tables<N>,
    thickness: f64,
    classes: Vec<Class>,
    /// The classes by the size of their first number, so that only few are compared number by number.
    nearby: HashMap<i64, Vec<u32>>,
}

struct Class {
    constants: Constants,
    /// What each number may differ by.
    tolerance: Vec<f64>,
}

impl<'a, const N: usize> Classes<'a, N> {
    pub fn new(tables: &'a Tables<N>, thickness: f64) -> Self {
        Self { tables, thickness, classes: Vec::new(), nearby: HashMap::new() }
    }

    /// The number of the class of `constants`: a known one, or a new one made of them.
    pub fn find(&mut self, constants: Constants) -> u32 {
        // Cells are so much wider than rounding that equal numbers are in the same or in neighbouring ones.
        let cell = (constants.values[0].ln() / (ROUNDING * 1024.0)) as i64;
        let near = (cell - 1..=cell + 1).filter_map(|cell| self.nearby.get(&cell)).flatten().copied();
        if let Some(known) = near.into_iter().find(|known| self.classes[*known as usize].contains(&constants)) {
            return known;
        }
        let new = self.classes.len() as u32;
        let tolerance = tolerance(self.tables, &constants, self.thickness);
        self.classes.push(Class { constants, tolerance });
        self.nearby.entry(cell).or_default().push(new);
        new
    }

    /// The constants of each class.
    pub fn finish(self) -> Vec<Constants> {
        self.classes.into_iter().map(|class| class.constants).collect()
    }
}

impl Class {
    fn contains(&self, other: &Constants) -> bool {
        let Constants { values, mass, weight: _ } = &self.constants;
        let pairs = values.iter().zip(&other.values).chain(mass.iter().zip(&other.mass));
        pairs.zip(&self.tolerance).all(|((a, b), tolerance)| (a - b).abs() <= *tolerance)
    }
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
