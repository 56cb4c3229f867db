//! Loads that follow the surface. The symmetric half of their stiffness enters the tangent, the skew half acts on vectors.

mod moment;
mod pressure;

use nalgebra::Vector3;

use crate::element::ElementBlock;
use crate::mesh::{Edge, End};

pub(super) use moment::Moment;
pub(super) use pressure::Pressure;

/// A load on the elements of a block that depends on the state. Its history gives `factor`.
pub(super) trait Follower: Send + Sync {
    /// Adds the load to `force` over all coordinates.
    fn add_force(&self, elements: &dyn ElementBlock, reference: &[f64], q: &[f64], factor: f64, force: &mut [f64]);

    /// Subtracts the symmetric half of the load's derivative from the tangent of an element.
    fn subtract_stiffness(
        &self,
        elements: &dyn ElementBlock,
        element: usize,
        reference: &[f64],
        q: &[f64],
        factor: f64,
        tangent: &mut [f64],
    );

    /// Adds the skew half of the load's derivative, times `x`, to `y`.
    fn add_skew_times(
        &self,
        elements: &dyn ElementBlock,
        reference: &[f64],
        q: &[f64],
        factor: f64,
        x: &[f64],
        y: &mut [f64],
    );
}

/// How the parameter along an edge runs: 1 with the outward direction to its left, seen against the normal, else -1.
fn sense(edge: Edge) -> f64 {
    if (edge.across == 0) == (edge.end == End::Low) { 1.0 } else { -1.0 }
}

/// Where on an edge of an element the parameter along it is `s`, and the orders of the derivative along it.
fn on_edge(edge: Edge, s: f64) -> ([f64; 2], [usize; 2]) {
    let constant = f64::from(edge.end == End::High);
    if edge.across == 0 { ([constant, s], [0, 1]) } else { ([s, constant], [1, 0]) }
}

/// `sum_a table_a e_a`.
fn interpolate(table: &[f64], vectors: &[u32], q: &[f64]) -> Vector3<f64> {
    table.iter().zip(vectors).map(|(t, v)| *t * Vector3::from_column_slice(&q[3 * *v as usize..][..3])).sum()
}

/// Adds `table_a part` to each vector of `sum`.
fn spread(table: &[f64], vectors: &[u32], part: &Vector3<f64>, sum: &mut [f64]) {
    for (t, v) in table.iter().zip(vectors) {
        for (sum, number) in sum[3 * *v as usize..][..3].iter_mut().zip(part) {
            *sum += t * number;
        }
    }
}
