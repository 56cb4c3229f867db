//! The size that corrections are compared with.

use crate::assembly::System;
use crate::model::Body;

/// The size that a correction of each coordinate is compared with: the extent of the body for positions, and what
/// moves a position by as much for gradients.
pub(super) fn scales(system: &System) -> Vec<f64> {
    let model = system.model();
    let mut scale = vec![1.0; system.coordinates()];
    for body in model.bodies() {
        let extent = extent(body, model.reference());
        let ranges = body.grid().domain().map(|[from, to]| to - from);
        for node in 0..body.grid().nodes() {
            for (index, vector) in body.nodal_vectors().iter().enumerate() {
                // A vector through the thickness only turns with the body.
                let size = vector.orders().map_or(1.0, |(dx, dy)| extent / (ranges[0].powi(dx) * ranges[1].powi(dy)));
                let v = body.vector(node, index);
                scale[3 * v..3 * v + 3].fill(size);
            }
        }
    }
    scale
}

/// Diagonal of the box around a body at rest.
fn extent(body: &Body, reference: &[f64]) -> f64 {
    let positions = (0..body.grid().nodes()).map(|node| &reference[3 * body.vector(node, 0)..][..3]);
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for r in positions {
        for c in 0..3 {
            low[c] = low[c].min(r[c]);
            high[c] = high[c].max(r[c]);
        }
    }
    (0..3).map(|c| (high[c] - low[c]).powi(2)).sum::<f64>().sqrt()
}
