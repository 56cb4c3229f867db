//! The global system of a model: mass, forces and tangent, and the linear equations for its free coordinates.
//!
//! `numbering` gives the free coordinates their numbers, `columns` the entries of the tangent their places; `parts` cuts
//! the model into tasks, `scatter` sums what their elements give, `tangent` their tangents. `loads` holds what acts on the model (`follower` what turns with it), `mass` its inertia, `reactions` what supports give. `forces` evaluates elements
//! and sums them, `solve` factorises the tangent and solves with it, `stability` counts the ways that lead away from
//! a state.

mod columns;
mod follower;
mod forces;
mod loads;
mod mass;
mod numbering;
mod parts;
mod reactions;
mod scatter;
mod solve;
mod stability;
mod tangent;
mod totals;

use std::sync::Arc;
use std::time::Instant;

use crate::element::ElementBlock;
use crate::linear::{Factorization, LinearError, SymmetricMatrix};
use crate::model::Model;

use loads::Loads;
use mass::{mass_damping, mass_matrix};
use numbering::Numbering;
use scatter::{Scatter, Subtotal};

pub(crate) use reactions::Bodies;
pub use reactions::Reaction;
pub use totals::{StrainEnergy, StrainRates, Timers};

/// The equations of a model, with everything that stays while the state changes made once.
///
/// Vectors over all nodal coordinates have the length of [`Model::reference`]; linear equations are solved for the
/// free ones, fixed coordinates leave before anything is factorised.
pub struct System {
    model: Arc<Model>,
    numbering: Numbering,
    blocks: Vec<Box<dyn ElementBlock>>,
    scatter: Scatter,
    mass: SymmetricMatrix,
    weight: Vec<f64>,
    /// Of each nodal vector; empty if no material has it.
    mass_damping: Vec<f64>,
    loads: Loads,
    /// The state of the last tangent, for the skew part of the followers: coordinates, and the factor of each load.
    tangent_at: (Vec<f64>, Vec<f64>),
    /// What each part of the model gave when it was evaluated last, and room for the forces in the order of elimination.
    subtotals: Vec<Subtotal>,
    ordered: Vec<f64>,
    values: Vec<f64>,
    factorization: Factorization,
    free: Vec<f64>,
    forces: usize,
    factorizations: usize,
    timers: Timers,
}

impl System {
    /// Makes the system of a model.
    ///
    /// # Errors
    ///
    /// Only if the memory does not suffice.
    pub fn new(model: Arc<Model>) -> Result<Self, LinearError> {
        let start = Instant::now();
        let numbering = Numbering::new(&model)?;
        let blocks: Vec<_> = model.bodies().iter().map(|body| body.elements(model.reference())).collect();
        let scatter = Scatter::new(&numbering)?;
        let (mass, weight) = mass_matrix(&model, &blocks)?;
        let mass_damping = mass_damping(&model, &blocks);
        let factorization = Factorization::new(Arc::clone(scatter.pattern()))?;
        let loads = Loads::new(&model, &blocks, &weight);
        let timers = Timers { setup: start.elapsed(), ..Timers::default() };
        Ok(Self {
            values: vec![0.0; scatter.pattern().nnz()],
            free: vec![0.0; numbering.coordinate.len()],
            subtotals: Vec::new(),
            ordered: vec![0.0; model.reference().len()],
            loads,
            tangent_at: (Vec::new(), Vec::new()),
            forces: 0,
            factorizations: 0,
            timers,
            model,
            numbering,
            blocks,
            scatter,
            mass_damping,
            mass,
            weight,
            factorization,
        })
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Number of nodal coordinates.
    pub fn coordinates(&self) -> usize {
        self.model.reference().len()
    }

    /// The coordinates that are not fixed, in the order of the equations.
    pub fn free(&self) -> &[usize] {
        &self.numbering.coordinate
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.blocks.iter().map(|block| block.elements()).sum()
    }

    /// Number of different reference shapes among the elements: what is stored once each.
    pub fn classes(&self) -> usize {
        self.blocks.iter().map(|block| block.classes()).sum()
    }

    /// Memory of all elements, bytes: see [`ElementBlock::bytes`].
    pub fn element_bytes(&self) -> usize {
        self.blocks.iter().map(|block| block.bytes()).sum()
    }

    /// Number of evaluations of the elastic forces so far, with or without their tangent.
    pub fn forces(&self) -> usize {
        self.forces
    }

    /// Number of numeric factorisations so far.
    pub fn factorizations(&self) -> usize {
        self.factorizations
    }

    /// Time spent in each part so far.
    pub fn timers(&self) -> Timers {
        self.timers
    }

    /// Adds the time that another system has spent on the same solve since it was made.
    pub(crate) fn add_timers(&mut self, Timers { setup: _, assembly, scatter, factorization, solve }: Timers) {
        self.timers.assembly += assembly;
        self.timers.scatter += scatter;
        self.timers.factorization += factorization;
        self.timers.solve += solve;
    }

    /// Says which coordinate an equation is for.
    pub fn describe(&self, equation: usize) -> String {
        self.model.describe(self.numbering.coordinate[equation])
    }
}
