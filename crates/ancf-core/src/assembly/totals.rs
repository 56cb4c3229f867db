//! What is summed over a whole system.

use std::time::Duration;

/// Time spent in the parts of a solve.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timers {
    /// Making the system: numbering, patterns, tables.
    pub setup: Duration,
    /// Forces and tangents.
    pub assembly: Duration,
    /// Of those with tangents, the sums over the elements at each node.
    pub scatter: Duration,
    /// Numeric factorisations.
    pub factorization: Duration,
    /// Solutions with a factorisation.
    pub solve: Duration,
}

/// Strain energy, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrainEnergy {
    /// From membrane strain; of solid elements all that is not bending.
    pub membrane: f64,
    /// From curvature; of solid elements from the part of the strain that is odd across the thickness.
    pub bending: f64,
}

impl StrainEnergy {
    /// Both parts together.
    pub fn total(&self) -> f64 {
        self.membrane + self.bending
    }
}

/// Strain rates, summed over all samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrainRates {
    /// Power that the viscosity of the materials takes, W.
    pub power: f64,
    /// Power of a viscosity of one, W/s.
    pub square: f64,
    /// Strain energy gained over a step that the mean elastic force misses, J.
    pub missed: f64,
}
