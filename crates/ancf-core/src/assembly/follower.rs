//! Loads that follow the surface: pressure and edge moments. The symmetric half of their stiffness enters the tangent, the
//! skew half acts on vectors.

use nalgebra::{Matrix3, Vector3};

use crate::element::{self, ElementBlock, tangent_place};
use crate::mesh::{Edge, End, Grid};
use crate::model::History;
use crate::quadrature::Rule;

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
    /// A pressure, Pa, on the surface of the vectors `r_x` and `r_y`.
    Pressure(f64),
    /// A moment per length, N m/m, that turns one vector about the other, the tangent of an edge.
    Moment(f64),
}

/// Shape functions at a quadrature point: of the position and of the two vectors that the load depends on.
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
        let points = Rule::Gauss(5).square().into_iter().map(|(at, weight)| {
            let [value, x, y] = [[0, 0], [1, 0], [0, 1]].map(|orders| elements.derivative(orders, at));
            Point { weight: weight * l * w, value, x, y }
        });
        let loaded = vec![true; elements.elements()];
        Self { block, history, kind: Kind::Pressure(pressure), loaded, points: points.collect() }
    }

    /// A moment about an edge of elements of the type `element`.
    pub fn moment(
        block: usize,
        element: element::Kind,
        elements: &dyn ElementBlock,
        grid: &Grid,
        edge: Edge,
        per_length: f64,
        history: History,
    ) -> Self {
        let (sides, along) = (grid.element_sides(), 1 - edge.across);
        let constant = f64::from(edge.end == End::High);
        // Outward x normal: the axis that turns the outward direction towards the normal.
        let axis = if (edge.across == 0) == (edge.end == End::Low) { 1.0 } else { -1.0 };
        let points = Rule::Gauss(4).points().into_iter().map(|(s, weight)| {
            let (at, orders) = if edge.across == 0 { ([constant, s], [0, 1]) } else { ([s, constant], [1, 0]) };
            let value = elements.derivative([0, 0], at);
            let (x, y) = (element.edge_director(sides, edge.across, at), elements.derivative(orders, at));
            Point { weight: weight * sides[along], value, x, y }
        });
        let mut loaded = vec![false; elements.elements()];
        for element in grid.elements_at(edge) {
            loaded[element] = true;
        }
        Self { block, history, kind: Kind::Moment(axis * per_length), loaded, points: points.collect() }
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

    /// Subtracts `factor` times the symmetric part of the load's derivative from the tangent of an element.
    pub fn subtract_stiffness(
        &self,
        elements: &dyn ElementBlock,
        element: usize,
        reference: &[f64],
        q: &[f64],
        factor: f64,
        tangent: &mut [f64],
    ) {
        if !self.loaded[element] {
            return;
        }
        let (vectors, n) = (elements.vectors(element), elements.vectors_per_element());
        for point in &self.points {
            let stiffness = self.conjugates(point, vectors, reference, q, factor).1;
            for b in 0..n {
                for a in b..n {
                    let block = 0.5 * (stiffness.between(point, a, b) + stiffness.between(point, b, a).transpose());
                    for i in 0..3 {
                        for j in 0..if a == b { i + 1 } else { 3 } {
                            tangent[tangent_place(n, [a, i], [b, j])] -= block[(i, j)];
                        }
                    }
                }
            }
        }
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
                // The skew half of [[0, r_x, r_y], [0, x_x, x_y], [0, y_x, y_y]], which couples r and the two vectors.
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

    /// What the load does work on at a point: vectors conjugate to r and the two vectors, and their derivatives.
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
        let zero = Vector3::zeros();
        match self.kind {
            Kind::Pressure(pressure) => {
                let p = pressure * factor * point.weight;
                // d(r_x x r_y) = r_x x dr_y - r_y x dr_x.
                let stiffness = Stiffness { r: [-p * y.cross_matrix(), p * x.cross_matrix()], ..Stiffness::default() };
                ([p * x.cross(&y), zero, zero], stiffness)
            }
            Kind::Moment(per_length) => {
                // The part of x normal to the edge, x - c y, turns by m . (dx - c dy) / |x - c y| about the unit tangent
                // t = y / |y|, with the unit vector m along y x x; changes of c do no work. |x - c y| = |y x x| / |y|.
                let length = interpolate(&point.y, vectors, reference).norm();
                let moment = per_length * factor * point.weight * length;
                let normal = y.cross(&x);
                let square = normal.norm_squared();
                let lever = normal / square;
                // Derivative of n / |n|^2 with respect to n, then with respect to x and y.
                let inverse = (Matrix3::identity() - 2.0 / square * normal * normal.transpose()) / square;
                let by_x = inverse * y.cross_matrix();
                let by_y = -inverse * x.cross_matrix();

                let size = y.norm();
                let tangent = y / size;
                let oblique = x.dot(&tangent);
                let bent = (Matrix3::identity() - tangent * tangent.transpose()) * x / size;
                let force_x = moment * size * lever;
                let force_y = -moment * oblique * lever;
                let stiffness = Stiffness {
                    x: [moment * size * by_x, moment * (size * by_y + lever * tangent.transpose())],
                    y: [
                        -moment * (oblique * by_x + lever * tangent.transpose()),
                        -moment * (oblique * by_y + lever * bent.transpose()),
                    ],
                    ..Stiffness::default()
                };
                ([zero, force_x, force_y], stiffness)
            }
        }
    }
}

/// Vectors conjugate to r and the two vectors.
type Conjugates = [Vector3<f64>; 3];

/// Derivatives of the vectors conjugate to r and the two vectors with respect to these.
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

/// `sum_a table_a e_a`.
fn interpolate(table: &[f64], vectors: &[u32], q: &[f64]) -> Vector3<f64> {
    table.iter().zip(vectors).map(|(t, v)| *t * Vector3::from_column_slice(&q[3 * *v as usize..][..3])).sum()
}
