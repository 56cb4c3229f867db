//! A pressure on a surface.
//!
//! Its virtual work is `p int du . (r_x x r_y)`. The derivative of the force on nodal vector `a` with respect to `b` is the
//! cross product with a vector, and so are its halves. That of the symmetric half is
//! `1/2 p int (N_b N_a,x - N_a N_b,x) r_y + (N_a N_b,y - N_b N_a,y) r_x`, a combination of the nodal vectors. Under the
//! integral of the skew half is a divergence, which leaves a line integral around the surface, of `1/2 p N_a N_b` times the
//! tangent of the edge: within a body, and where a closed surface meets itself, the parts of neighbours cancel.
//!
//! # Source
//!
//! Schweizerhof and Ramm, Displacement dependent pressure loads in nonlinear finite element analyses, Comput. Struct. 18
//! (1984): pressures have a potential but for terms on the boundary.

use crate::element::{ElementBlock, tangent_place};
use crate::mesh::{Edge, End, Grid};
use crate::quadrature::Rule;

use super::{Follower, interpolate, on_edge, sense, spread};

/// Quadrature points along a side: exact for products of three shape functions.
const ALONG: usize = 5;
const POINTS: usize = ALONG * ALONG;
/// Room for the nodal vectors of any element, so that loops over them have a fixed length.
const ROOM: usize = 16;

/// A pressure, Pa, on all elements of a block.
pub(in crate::assembly) struct Pressure {
    pressure: f64,
    /// Shape functions times weights, `[point][a]`.
    values: [[f64; ROOM]; POINTS],
    /// Derivatives of the shape functions with respect to x and y, `[a][point]`.
    slopes: [Vec<[f64; POINTS]>; 2],
    /// What the vectors of the symmetric half have of each nodal vector, `[c][pair]`; pairs are `a > b`, one column `b`
    /// after the other.
    stiffness: Vec<Vec<f64>>,
    sides: Vec<Side>,
}

/// An edge of the body.
struct Side {
    elements: Vec<usize>,
    points: Vec<SidePoint>,
}

/// Shape functions at a point of an edge.
struct SidePoint {
    /// With the sense of the edge.
    weight: f64,
    value: Vec<f64>,
    tangent: Vec<f64>,
}

impl Pressure {
    pub fn new(elements: &dyn ElementBlock, grid: &Grid, pressure: f64) -> Self {
        let n = elements.vectors_per_element();
        let [l, w] = grid.element_sides();
        let mut values = [[0.0; ROOM]; POINTS];
        let mut slopes = [(); 2].map(|()| vec![[0.0; POINTS]; n]);
        let mut stiffness = vec![vec![0.0; n * (n - 1) / 2]; n];
        for (k, (at, weight)) in Rule::Gauss(ALONG).square().into_iter().enumerate() {
            let [value, x, y] = [[0, 0], [1, 0], [0, 1]].map(|orders| elements.derivative(orders, at));
            for a in 0..n {
                values[k][a] = weight * l * w * value[a];
                (slopes[0][a][k], slopes[1][a][k]) = (x[a], y[a]);
            }
            for (c, row) in stiffness.iter_mut().enumerate() {
                for (sum, (a, b)) in row.iter_mut().zip(pairs(n)) {
                    let [by_x, by_y] = [&x, &y].map(|slope| value[b] * slope[a] - value[a] * slope[b]);
                    *sum += 0.5 * weight * l * w * (by_x * y[c] - by_y * x[c]);
                }
            }
        }
        let edges = [0, 1].into_iter().flat_map(|across| [End::Low, End::High].map(|end| Edge { across, end }));
        let sides = edges.map(|edge| Side {
            elements: grid.elements_at(edge),
            points: Rule::Gauss(ALONG)
                .points()
                .into_iter()
                .map(|(s, weight)| {
                    let (at, orders) = on_edge(edge, s);
                    let [value, tangent] = [[0, 0], orders].map(|orders| elements.derivative(orders, at));
                    SidePoint { weight: 0.5 * sense(edge) * weight * [l, w][1 - edge.across], value, tangent }
                })
                .collect(),
        });
        Self { pressure, values, slopes, stiffness, sides: sides.collect() }
    }
}

impl Follower for Pressure {
    fn add_force(&self, elements: &dyn ElementBlock, _: &[f64], q: &[f64], factor: f64, force: &mut [f64]) {
        let p = self.pressure * factor;
        for vectors in (0..elements.elements()).map(|element| elements.vectors(element)) {
            let [x, y] = [0, 1].map(|i| interpolate_all(&self.slopes[i], vectors, q));
            let mut sums = [[0.0; ROOM]; 3];
            for (k, values) in self.values.iter().enumerate() {
                for (i, sum) in sums.iter_mut().enumerate() {
                    let (j, l) = ((i + 1) % 3, (i + 2) % 3);
                    let normal = p * (x[j][k] * y[l][k] - x[l][k] * y[j][k]);
                    sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += normal * value);
                }
            }
            for (a, vector) in vectors.iter().enumerate() {
                for (i, sum) in sums.iter().enumerate() {
                    force[3 * *vector as usize + i] += sum[a];
                }
            }
        }
    }

    fn subtract_stiffness(
        &self,
        elements: &dyn ElementBlock,
        element: usize,
        _: &[f64],
        q: &[f64],
        factor: f64,
        tangent: &mut [f64],
    ) {
        let p = self.pressure * factor;
        let n = elements.vectors_per_element();
        let mut sums = [(); 3].map(|()| [0.0; ROOM * (ROOM - 1) / 2]);
        for (row, vector) in self.stiffness.iter().zip(elements.vectors(element)) {
            for (sum, e) in sums.iter_mut().zip(&q[3 * *vector as usize..][..3]) {
                sum.iter_mut().zip(row).for_each(|(sum, part)| *sum += p * e * part);
            }
        }
        for (pair, (a, b)) in pairs(n).enumerate() {
            for (i, sum) in sums.iter().enumerate() {
                let (j, l) = ((i + 1) % 3, (i + 2) % 3);
                tangent[tangent_place(n, [a, l], [b, j])] -= sum[pair];
                tangent[tangent_place(n, [a, j], [b, l])] += sum[pair];
            }
        }
    }

    fn add_skew_times(&self, elements: &dyn ElementBlock, _: &[f64], q: &[f64], factor: f64, x: &[f64], y: &mut [f64]) {
        let p = self.pressure * factor;
        for side in &self.sides {
            for vectors in side.elements.iter().map(|element| elements.vectors(*element)) {
                for point in &side.points {
                    let tangent = interpolate(&point.tangent, vectors, q);
                    let part = tangent.cross(&interpolate(&point.value, vectors, x));
                    spread(&point.value, vectors, &(p * point.weight * part), y);
                }
            }
        }
    }
}

/// Pairs of nodal vectors `a > b`, one `b` after the other.
fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |b| (b + 1..n).map(move |a| (a, b)))
}

/// A derivative of the position, `[component][point]`.
fn interpolate_all(table: &[[f64; POINTS]], vectors: &[u32], q: &[f64]) -> [[f64; POINTS]; 3] {
    let mut sums = [[0.0; POINTS]; 3];
    for (row, vector) in table.iter().zip(vectors) {
        for (sum, e) in sums.iter_mut().zip(&q[3 * *vector as usize..][..3]) {
            sum.iter_mut().zip(row).for_each(|(sum, shape)| *sum += e * shape);
        }
    }
    sums
}
