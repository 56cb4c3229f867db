//! Settings of Newton's method.

use crate::error::InputError;

/// Which tangent Newton's method uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Variant {
    /// The geometric stiffness is that of the stress extrapolated from the last iterate: far fewer iterations in thin
    /// structures, the same solution.
    ///
    /// # Source
    ///
    /// Magisano, Leonetti and Garcea (2017), mixed integration points.
    #[default]
    MixedIntegrationPoint,
    /// The consistent tangent.
    Plain,
}

/// Settings of Newton's method.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Which tangent.
    pub variant: Variant,
    /// Largest correction of a converged iteration, relative to the size of the model.
    pub tolerance: f64,
    /// Iterations after which a step has failed.
    pub max_iterations: usize,
    /// Whether a factorisation is kept, over iterations and time steps, while it converges fast (modified Newton).
    pub reuse: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { variant: Variant::default(), tolerance: 1e-8, max_iterations: 30, reuse: false }
    }
}

impl Options {
    /// Checks the numbers.
    ///
    /// # Errors
    ///
    /// The tolerance must lie between the rounding of numbers and one, the iterations must be at least one.
    pub fn validate(&self) -> Result<(), InputError> {
        let tolerance = self.tolerance;
        InputError::check("tolerance", tolerance, (1e-15..1.0).contains(&tolerance), "from 1e-15 to below 1")?;
        InputError::check("max_iterations", self.max_iterations, self.max_iterations > 0, "a whole number from 1")
    }
}
