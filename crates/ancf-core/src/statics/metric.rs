//! Lengths of changes of the coordinates.

use super::path::Path;

/// A mean of squared displacements relative to the size of the model; the load factor has no part in it.
///
/// Each coordinate counts by how far it moves the surface within an element: gradients less the finer the mesh is, so that
/// lengths are those of the displacement field, whichever nodal coordinates an element has.
pub(super) struct Metric {
    weights: Vec<f64>,
}

impl Metric {
    pub fn new(path: &Path<'_>) -> Self {
        let (model, scale) = (path.system.model(), path.newton.scale());
        let free = path.system.free().len() as f64;
        let mut weights = vec![0.0; scale.len()];
        for body in model.bodies() {
            let [l, w] = body.grid().element_sides();
            for node in 0..body.grid().nodes() {
                // Positions are compared with the size of the body.
                let size = scale[3 * body.vector(node, 0)];
                for (index, vector) in body.nodal_vectors().iter().enumerate() {
                    let reach = vector.orders().map_or(body.plate().thickness, |(dx, dy)| l.powi(dx) * w.powi(dy));
                    let v = body.vector(node, index);
                    weights[3 * v..3 * v + 3].fill((reach / size).powi(2) / free);
                }
            }
        }
        Self { weights }
    }

    pub fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.weights).map(|((a, b), w)| w * a * b).sum()
    }

    pub fn length(&self, a: &[f64]) -> f64 {
        self.product(a, a).sqrt()
    }

    /// The vector whose product with another one is theirs in this metric.
    pub fn weighted(&self, a: &[f64]) -> Vec<f64> {
        a.iter().zip(&self.weights).map(|(a, w)| w * a).collect()
    }
}
