//! Loads that follow the surface: pressure and edge moments. The symmetric half of their stiffness enters the tangent, the
//! skew half acts on vectors.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::element::{ElementBlock, Outcome};
use crate::mesh::{Edge, End, Grid};
use crate::model::History;
use crate::quadrature::Rule;
use crate::strain::packed;

/// A load on some elements of a block that depends on the state.
pub(super) struct Follower {
    pub block: usize,
    pub history: History,
    kind: Kind,
    /// Whether each element of the block carries the load.
    loaded: Vec<bool>,
    points: Vec<Point>,
}

enum Kind {
    /// A pressure, Pa.
    Pressure(f64),
    /// A moment per length about an edge, N m/m.
    Moment(f64, Edge),
}

/// Shape functions at a quadrature point.
struct Point {
    weight: f64,
    value: Vec<f64>,
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Follower {
    /// A pressure on all elements.
    pub fn pressure(block: usize, elements: &dyn ElementBlock, grid: &Grid, pressure: f64, history: History) -> Self {
        let [l, w] = grid.element_sides();
        let points = Rule::Gauss(5).square().into_iter().map(|(at, weight)| Point::new(elements, at, weight * l * w));
        let loaded = vec![true; elements.elements()];
        Self { block, history, kind: Kind::Pressure(pressure), loaded, points: points.collect() }
    }

    /// A moment about an edge; its reference length is measured with `reference`, the nodal coordinates at rest.
    pub fn moment(
        block: usize,
        elements: &dyn ElementBlock,
        grid: &Grid,
        edge: Edge,
        per_length: f64,
        history: History,
    ) -> Self {
        let along = 1 - edge.across;
        let constant = f64::from(edge.end == End::High);
        let points = Rule::Gauss(4).points().into_iter().map(|(s, weight)| {
            let at = if edge.across == 0 { [constant, s] } else { [s, constant] };
            Point::new(elements, at, weight * grid.element_sides()[along])
        });
        let mut loaded = vec![false; elements.elements()];
        for element in grid.elements_at(edge) {
            loaded[element] = true;
        }
        Self { block, history, kind: Kind::Moment(per_length, edge), loaded, points: points.collect() }
    }

    /// Adds the load, `factor` times, to `force` over all coordinates.
    pub fn add_force(&self, elements: &dyn ElementBlock, reference: &[f64], q: &[f64], factor: f64, force: &mut [f64]) {
        for element in (0..self.loaded.len()).filter(|e| self.loaded[*e]) {
            let vectors = elements.vectors(element);
            for point in &self.points {
                let [value, x, y] = self.conjugates(point, vectors, reference, q, factor).0;
                for (a, vector) in vectors.iter().enumerate() {
                    let part = value * point.value[a] + x * point.x[a] + y * point.y[a];
                    for (sum, number) in force[3 * *vector as usize..][..3].iter_mut().zip(&part) {
                        *sum += number;
                    }
                }
            }
        }
    }

    /// Subtracts `factor` times the symmetric part of the load's derivative from the element tangents.
    pub fn subtract_stiffness(
        &self,
        elements: &dyn ElementBlock,
        reference: &[f64],
        q: &[f64],
        factor: f64,
        outcome: &mut Outcome,
    ) {
        let n = elements.vectors_per_element();
        let size = 9 * n * (n + 1) / 2;
        let parts = outcome.tangent.par_chunks_mut(size).enumerate().filter(|(element, _)| self.loaded[*element]);
        parts.for_each(|(element, tangent)| {
            let vectors = elements.vectors(element);
            for point in &self.points {
                let stiffness = self.conjugates(point, vectors, reference, q, factor).1;
                for b in 0..n {
                    for a in 0..=b {
                        let block = 0.5 * (stiffness.between(point, a, b) + stiffness.between(point, b, a).transpose());
                        for i in 0..3 {
                            for j in 0..3 {
                                tangent[9 * packed(a, b) + 3 * i + j] -= block[(i, j)];
                            }
                        }
                    }
                }
            }
        });
    }

    /// Adds `factor` times the skew part of the load's derivative, times `x`, to `y`.
    pub fn add_skew_times(
        &self,
        elements: &dyn ElementBlock,
        reference: &[f64],
        q: &[f64],
        factor: f64,
        x: &[f64],
        y: &mut [f64],
    ) {
        for element in (0..self.loaded.len()).filter(|e| self.loaded[*e]) {
            let vectors = elements.vectors(element);
            for point in &self.points {
                let Stiffness { r, x: on_x, y: on_y } = self.conjugates(point, vectors, reference, q, factor).1;
                let tables = [&point.value, &point.x, &point.y];
                let [value, by_x, by_y] = tables.map(|table| interpolate(table, vectors, x));
                // The skew half of [[0, r_x, r_y], [0, x_x, x_y], [0, y_x, y_y]], which couples r, r_x and r_y.
                let parts = [
                    r[0] * by_x + r[1] * by_y,
                    on_x[0] * by_x + on_x[1] * by_y
                        - r[0].transpose() * value
                        - on_x[0].transpose() * by_x
                        - on_y[0].transpose() * by_y,
                    on_y[0] * by_x + on_y[1] * by_y
                        - r[1].transpose() * value
                        - on_x[1].transpose() * by_x
                        - on_y[1].transpose() * by_y,
                ];
                for (a, vector) in vectors.iter().enumerate() {
                    let part = 0.5 * (parts[0] * point.value[a] + parts[1] * point.x[a] + parts[2] * point.y[a]);
                    for (sum, number) in y[3 * *vector as usize..][..3].iter_mut().zip(&part) {
                        *sum += number;
                    }
                }
            }
        }
    }

    /// What the load does work on at a point: vectors conjugate to r, r_x and r_y, and their derivatives.
    fn conjugates(
        &self,
        point: &Point,
        vectors: &[u32],
        reference: &[f64],
        q: &[f64],
        factor: f64,
    ) -> (Conjugates, Stiffness) {
        let x = interpolate(&point.x, vectors, q);
        let y = interpolate(&point.y, vectors, q);
        let normal = x.cross(&y);
        let zero = Vector3::zeros();
        match self.kind {
            Kind::Pressure(pressure) => {
                let p = pressure * factor * point.weight;
                // d(r_x x r_y) = r_x x dr_y - r_y x dr_x.
                let stiffness = Stiffness { r: [-p * y.cross_matrix(), p * x.cross_matrix()], ..Stiffness::default() };
                ([p * normal, zero, zero], stiffness)
            }
            Kind::Moment(per_length, edge) => {
                // With n the unit normal and the unit outward conormal nu = c^o outward + c^s along, the edge turns by
                // n . (c^o d(outward) + c^s d(along)): c^o = |along| / |r_x x r_y|, c^s makes nu normal to the edge.
                let (outward, along) = if edge.across == 0 { (x, y) } else { (y, x) };
                let table = if edge.across == 0 { &point.y } else { &point.x };
                let length = interpolate(table, vectors, reference).norm();
                let sign = if edge.end == End::High { 1.0 } else { -1.0 };
                let moment = sign * per_length * factor * point.weight * length;

                let square = normal.norm_squared();
                let lever = normal / square;
                // Derivative of n / |n|^2 with respect to n, then with respect to r_x and r_y.
                let inverse = (Matrix3::identity() - 2.0 / square * normal * normal.transpose()) / square;
                let by_x = -inverse * y.cross_matrix();
                let by_y = inverse * x.cross_matrix();
                let (by_outward, by_along) = if edge.across == 0 { (by_x, by_y) } else { (by_y, by_x) };

                let size = along.norm();
                let tangent = along / size;
                let oblique = outward.dot(&tangent);
                let force_outward = moment * size * lever;
                let force_along = -moment * oblique * lever;
                let bent = (Matrix3::identity() - tangent * tangent.transpose()) * outward / size;
                let oo = moment * size * by_outward;
                let os = moment * (size * by_along + lever * tangent.transpose());
                let so = -moment * (oblique * by_outward + lever * tangent.transpose());
                let ss = -moment * (oblique * by_along + lever * bent.transpose());
                if edge.across == 0 {
                    ([zero, force_outward, force_along], Stiffness { x: [oo, os], y: [so, ss], ..Stiffness::default() })
                } else {
                    ([zero, force_along, force_outward], Stiffness { x: [ss, so], y: [os, oo], ..Stiffness::default() })
                }
            }
        }
    }
}

/// Vectors conjugate to r, r_x and r_y.
type Conjugates = [Vector3<f64>; 3];

/// Derivatives of the vectors conjugate to r, r_x, r_y with respect to r_x and r_y.
#[derive(Default)]
struct Stiffness {
    r: [Matrix3<f64>; 2],
    x: [Matrix3<f64>; 2],
    y: [Matrix3<f64>; 2],
}

impl Stiffness {
    /// The derivative of the force on nodal vector `a` with respect to nodal vector `b`.
    fn between(&self, point: &Point, a: usize, b: usize) -> Matrix3<f64> {
        let row = |pair: &[Matrix3<f64>; 2]| pair[0] * point.x[b] + pair[1] * point.y[b];
        row(&self.r) * point.value[a] + row(&self.x) * point.x[a] + row(&self.y) * point.y[a]
    }
}

impl Point {
    fn new(elements: &dyn ElementBlock, at: [f64; 2], weight: f64) -> Self {
        let [value, x, y] = [[0, 0], [1, 0], [0, 1]].map(|orders| elements.derivative(orders, at));
        Self { weight, value, x, y }
    }
}

/// `sum_a table_a e_a`.
fn interpolate(table: &[f64], vectors: &[u32], q: &[f64]) -> Vector3<f64> {
    table.iter().zip(vectors).map(|(t, v)| *t * Vector3::from_column_slice(&q[3 * *v as usize..][..3])).sum()
}
