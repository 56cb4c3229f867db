//! Eigenvalues to compare with: of slow bending, and of nothing but rounding.

use crate::assembly::System;
use crate::linear::SymmetricMatrix;
use crate::model::Body;

/// Squared circular frequency of slow bending: about that of the first mode of a free square plate, of the body with the
/// lowest. The diagonal of the box around a body stands for its side.
pub(super) fn bending(system: &System) -> f64 {
    let model = system.model();
    let of_body = |body: &Body| {
        let positions = (0..body.grid().nodes()).map(|node| &model.reference()[3 * body.vector(node, 0)..][..3]);
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for position in positions {
            for c in 0..3 {
                (low[c], high[c]) = (low[c].min(position[c]), high[c].max(position[c]));
            }
        }
        let square: f64 = (0..3).map(|c| (high[c] - low[c]).powi(2)).sum();
        let (material, h) = (&body.plate().material, body.plate().thickness);
        let rigidity = material.plane_stress([1.0, 1.0, 0.0])[0][0] * h * h / 12.0;
        100.0 * rigidity / (material.density() * square * square)
    };
    model.bodies().iter().map(of_body).fold(f64::INFINITY, f64::min)
}

/// The unit in which rounding of the stiffness changes the eigenvalue of a mode of this shape, `eps |x| . |K| |x|`.
///
/// Rounded strains are membrane forces, which hold a surface across it as well, where a flat body at rest has but the
/// small stiffness of bending. So the length of a nodal vector stands for each of its components.
pub(super) fn rounding(system: &System, stiffness: &SymmetricMatrix, shape: &[f64]) -> f64 {
    let length = |vector: usize| shape[3 * vector..][..3].iter().map(|x| x * x).sum::<f64>().sqrt();
    rounding_of(stiffness, system.free().iter().map(|coordinate| length(coordinate / 3)).collect())
}

/// The same of a matrix whose numbers are exact but for their last digits: no rounding leads from one component to another.
pub(super) fn least_rounding(system: &System, stiffness: &SymmetricMatrix, shape: &[f64]) -> f64 {
    rounding_of(stiffness, system.free().iter().map(|&coordinate| shape[coordinate].abs()).collect())
}

/// `eps x . |K| x` over the free coordinates.
fn rounding_of(stiffness: &SymmetricMatrix, free: Vec<f64>) -> f64 {
    let (pattern, values) = (stiffness.pattern(), stiffness.values());
    let mut sum = 0.0;
    for column in 0..pattern.n() {
        let start = pattern.col_ptr()[column];
        for (k, &row) in pattern.rows(column).iter().enumerate() {
            let twice = if row == column { 1.0 } else { 2.0 };
            sum += twice * values[start + k].abs() * free[row] * free[column];
        }
    }
    f64::EPSILON * sum
}
