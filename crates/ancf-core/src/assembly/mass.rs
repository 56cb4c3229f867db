//! Mass: the scalar mass matrix, its damping, and the motion it carries.

use std::mem::replace;
use std::sync::Arc;

use nalgebra::Vector3;

use crate::element::{ElementBlock, NodalVector};
use crate::linear::{LinearError, Pattern, SymmetricMatrix};
use crate::model::Model;
use crate::strain::packed;

use super::System;
use super::loads::Loads;

impl System {
    /// Scalar mass matrix over all nodal vectors.
    pub fn mass(&self) -> &SymmetricMatrix {
        &self.mass
    }

    /// The mass that each nodal vector stands for in a uniform field, kg or kg m.
    pub fn weight(&self) -> &[f64] {
        &self.weight
    }

    /// Mass-proportional damping of each nodal vector, 1/s; none where no material has it.
    pub fn mass_damping(&self) -> Option<&[f64]> {
        (!self.mass_damping.is_empty()).then_some(&self.mass_damping)
    }

    /// Adds `M x` to `y`.
    pub fn add_mass_times(&self, x: &[f64], y: &mut [f64]) {
        self.mass.multiply_add::<3>(x, y);
    }

    /// The nodal vectors that are positions.
    pub fn positions(&self) -> impl Iterator<Item = usize> {
        self.model.bodies().iter().flat_map(|body| {
            let index = body.nodal_vectors().iter().position(|v| *v == NodalVector::R);
            let index = index.expect("every node has a position");
            (0..body.grid().nodes()).map(move |node| body.vector(node, index))
        })
    }

    /// Does `work` with the lumped mass matrix, and with gravity that acts on it, so that a free body falls without
    /// being bent: on the positions alone.
    pub(crate) fn with_lumped_mass<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let (mass, weight) = self.lumped_mass();
        let loads = Loads::new(&self.model, &self.blocks, &weight);
        let consistent =
            (replace(&mut self.mass, mass), replace(&mut self.weight, weight), replace(&mut self.loads, loads));
        let result = work(self);
        (self.mass, self.weight, self.loads) = consistent;
        result
    }

    /// The diagonal of the mass matrix, scaled so that each body keeps its mass, and what it weighs in a uniform field.
    ///
    /// # Source
    ///
    /// Hinton, Rock and Zienkiewicz (1976).
    fn lumped_mass(&self) -> (SymmetricMatrix, Vec<f64>) {
        let pattern = self.mass.pattern();
        let mut values: Vec<f64> = (0..pattern.n()).map(|a| self.mass.values()[pattern.col_ptr()[a]]).collect();
        let mut weight = vec![0.0; pattern.n()];
        let positions: Vec<usize> = self.positions().collect();
        for body in self.model.bodies() {
            let vectors = body.vector(0, 0)..body.vector(body.grid().nodes(), 0);
            let own = || positions.iter().filter(|a| vectors.contains(a));
            let scale = own().map(|a| self.weight[*a]).sum::<f64>() / own().map(|a| values[*a]).sum::<f64>();
            values[vectors.clone()].iter_mut().for_each(|value| *value *= scale);
            own().for_each(|a| weight[*a] = values[*a]);
        }
        let pattern = Pattern::from_groups::<[usize; 0]>(pattern.n(), &[]).expect("a diagonal");
        (SymmetricMatrix::new(Arc::new(pattern), values), weight)
    }

    /// Kinetic energy (J), momentum (kg m/s) and angular momentum about the origin (kg m2/s), with a mass matrix over
    /// nodal vectors.
    pub fn motion(&self, mass: &SymmetricMatrix, q: &[f64], v: &[f64]) -> (f64, [f64; 3], [f64; 3]) {
        let mut momenta = vec![0.0; v.len()];
        mass.multiply_add::<3>(v, &mut momenta);
        let kinetic = 0.5 * v.iter().zip(&momenta).map(|(v, p)| v * p).sum::<f64>();
        let at = |x: &[f64], a: usize| Vector3::from_column_slice(&x[3 * a..3 * a + 3]);
        // Gradients do not change in a translation.
        let momentum: Vector3<f64> = self.positions().map(|a| at(&momenta, a)).sum();
        let angular: Vector3<f64> = (0..q.len() / 3).map(|a| at(q, a).cross(&at(&momenta, a))).sum();
        (kinetic, momentum.into(), angular.into())
    }
}

/// The mass-proportional damping of each nodal vector; empty if there is none.
pub(super) fn mass_damping(model: &Model, blocks: &[Box<dyn ElementBlock>]) -> Vec<f64> {
    if blocks.iter().all(|block| block.damping().mass == 0.0) {
        return Vec::new();
    }
    let mut damping = vec![0.0; model.reference().len() / 3];
    for block in blocks {
        for vector in (0..block.elements()).flat_map(|element| block.vectors(element)) {
            damping[*vector as usize] = block.damping().mass;
        }
    }
    damping
}

/// The scalar mass matrix over all nodal vectors and its row sums in a uniform field.
///
/// # Source
///
/// Dufva and Shabana (2005), (37), (38).
pub(super) fn mass_matrix(
    model: &Model,
    blocks: &[Box<dyn ElementBlock>],
) -> Result<(SymmetricMatrix, Vec<f64>), LinearError> {
    let vectors = model.reference().len() / 3;
    let all = || blocks.iter().flat_map(|block| (0..block.elements()).map(move |element| (block, element)));
    let groups: Vec<Vec<usize>> =
        all().map(|(block, element)| block.vectors(element).iter().map(|v| *v as usize).collect()).collect();
    let pattern = Arc::new(Pattern::from_groups(vectors, &groups)?);
    let mut values = vec![0.0; pattern.nnz()];
    let mut weight = vec![0.0; vectors];
    for ((block, element), group) in all().zip(&groups) {
        let mass = block.mass(element);
        for (b, &j) in group.iter().enumerate() {
            weight[j] += block.weight(element)[b];
            for (a, &i) in group[..=b].iter().enumerate() {
                values[pattern.slot(i, j).expect("an entry of the pattern")] += mass[packed(a, b)];
            }
        }
    }
    Ok((SymmetricMatrix::new(pattern, values), weight))
}
