//! Moments along an edge that turn with the surface.

use nalgebra::{Matrix3, Vector3};

use crate::element::{self, ElementBlock, tangent_place};
use crate::mesh::{Edge, Grid};
use crate::quadrature::Rule;

use super::{Follower, interpolate, on_edge, sense, spread};

/// A moment per length, N m/m, that turns one vector about the other, the tangent of an edge.
pub(in crate::assembly) struct Moment {
    per_length: f64,
    /// Whether each element of the block carries the load.
    loaded: Vec<bool>,
    points: Vec<Point>,
}

/// Shape functions at a quadrature point, of the vector that is turned and of the tangent of the edge.
struct Point {
    weight: f64,
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Moment {
    /// A moment about an edge of elements of the type `element`.
    pub fn new(element: element::Kind, elements: &dyn ElementBlock, grid: &Grid, edge: Edge, per_length: f64) -> Self {
        let (sides, along) = (grid.element_sides(), 1 - edge.across);
        let points = Rule::Gauss(4).points().into_iter().map(|(s, weight)| {
            let (at, orders) = on_edge(edge, s);
            let (x, y) = (element.edge_director(sides, edge.across, at), elements.derivative(orders, at));
            Point { weight: weight * sides[along], x, y }
        });
        let mut loaded = vec![false; elements.elements()];
        for element in grid.elements_at(edge) {
            loaded[element] = true;
        }
        // The axis that turns the outward direction towards the normal is outward x normal.
        Self { per_length: sense(edge) * per_length, loaded, points: points.collect() }
    }

    /// The elements that carry the load.
    fn elements(&self) -> impl Iterator<Item = usize> {
        (0..self.loaded.len()).filter(|element| self.loaded[*element])
    }

    /// What the load does work on at a point: vectors conjugate to the two vectors, and their derivatives.
    fn conjugates(
        &self,
        point: &Point,
        vectors: &[u32],
        reference: &[f64],
        q: &[f64],
        factor: f64,
    ) -> ([Vector3<f64>; 2], Stiffness) {
        let x = interpolate(&point.x, vectors, q);
        let y = interpolate(&point.y, vectors, q);
        // The part of x normal to the edge, x - c y, turns by m . (dx - c dy) / |x - c y| about the unit tangent
        // t = y / |y|, with the unit vector m along y x x; changes of c do no work. |x - c y| = |y x x| / |y|.
        let length = interpolate(&point.y, vectors, reference).norm();
        let moment = self.per_length * factor * point.weight * length;
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
        let stiffness = Stiffness {
            x: [moment * size * by_x, moment * (size * by_y + lever * tangent.transpose())],
            y: [
                -moment * (oblique * by_x + lever * tangent.transpose()),
                -moment * (oblique * by_y + lever * bent.transpose()),
            ],
        };
        ([moment * size * lever, -moment * oblique * lever], stiffness)
    }
}

impl Follower for Moment {
    fn add_force(&self, elements: &dyn ElementBlock, reference: &[f64], q: &[f64], factor: f64, force: &mut [f64]) {
        for vectors in self.elements().map(|element| elements.vectors(element)) {
            for point in &self.points {
                let [x, y] = self.conjugates(point, vectors, reference, q, factor).0;
                spread(&point.x, vectors, &x, force);
                spread(&point.y, vectors, &y, force);
            }
        }
    }

    fn subtract_stiffness(
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

    fn add_skew_times(
        &self,
        elements: &dyn ElementBlock,
        reference: &[f64],
        q: &[f64],
        factor: f64,
        x: &[f64],
        y: &mut [f64],
    ) {
        for vectors in self.elements().map(|element| elements.vectors(element)) {
            for point in &self.points {
                let Stiffness { x: on_x, y: on_y } = self.conjugates(point, vectors, reference, q, factor).1;
                let [by_x, by_y] = [&point.x, &point.y].map(|table| interpolate(table, vectors, x));
                let of_x = on_x[0] * by_x + on_x[1] * by_y - on_x[0].transpose() * by_x - on_y[0].transpose() * by_y;
                let of_y = on_y[0] * by_x + on_y[1] * by_y - on_x[1].transpose() * by_x - on_y[1].transpose() * by_y;
                spread(&point.x, vectors, &(0.5 * of_x), y);
                spread(&point.y, vectors, &(0.5 * of_y), y);
            }
        }
    }
}

/// Derivatives of the vectors conjugate to the two vectors with respect to these.
struct Stiffness {
    x: [Matrix3<f64>; 2],
    y: [Matrix3<f64>; 2],
}

impl Stiffness {
    /// The derivative of the force on nodal vector `a` with respect to nodal vector `b`.
    fn between(&self, point: &Point, a: usize, b: usize) -> Matrix3<f64> {
        let row = |pair: &[Matrix3<f64>; 2]| pair[0] * point.x[b] + pair[1] * point.y[b];
        row(&self.x) * point.x[a] + row(&self.y) * point.y[a]
    }
}
