//! Equilibria along a load path: Newton's method inside load steps of adaptive size.

mod arc;
mod jump;
mod load;
mod metric;
mod motion;
mod path;

use std::time::Instant;

use crate::assembly::System;
use crate::error::InputError;
use crate::nonlinear::Options as NewtonOptions;
use crate::observe::Observer;
use crate::report::{Outcome, Run, Seconds};

use path::Path;

/// What is prescribed along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Control {
    /// The load factor: only stable equilibria.
    #[default]
    Load,
    /// The arc length: the load factor is found and may decrease, equilibria may be unstable.
    Arc,
}

/// Settings of a static solve.
#[derive(Clone, Debug)]
pub struct Options {
    /// What is prescribed.
    pub control: Control,
    /// Load control: the load factors at which a solution is wanted, in the order of the path. Arc length: the first
    /// gives the direction, the path ends at the last; every step is a solution.
    pub load_factors: Vec<f64>,
    /// Newton's method.
    pub newton: NewtonOptions,
    /// First load step; none: up to the first load factor.
    pub first_step: Option<f64>,
    /// Smallest load step.
    pub min_step: f64,
    /// Arc length: number of steps after which the path ends before its last load factor.
    pub max_steps: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            control: Control::default(),
            load_factors: vec![1.0],
            newton: NewtonOptions::default(),
            first_step: None,
            min_step: 1e-5,
            max_steps: 1000,
        }
    }
}

impl Options {
    /// Checks the numbers.
    ///
    /// # Errors
    ///
    /// Load factors must be finite and differ from the one before, steps must be positive.
    pub fn validate(&self) -> Result<(), InputError> {
        let factors = &self.load_factors;
        let start = [0.0];
        let moving = start.iter().chain(factors).zip(factors).all(|(from, to)| from != to && to.is_finite());
        let allowed = "at least one finite number, the first not 0 and none equal to the one before";
        InputError::check("load_factors", format!("{factors:?}"), !factors.is_empty() && moving, allowed)?;
        let valid = |step: f64| step > 0.0 && step.is_finite();
        if let Some(step) = self.first_step {
            InputError::check("first_step", step, valid(step), "a positive number")?;
        }
        InputError::check("min_step", self.min_step, valid(self.min_step), "a positive number")?;
        InputError::check("max_steps", self.max_steps, self.max_steps > 0, "a whole number from 1")?;
        self.newton.validate()
    }
}

/// Follows the equilibrium path from the unloaded state through the load factors.
///
/// States are given to the observer: one at load factor 0, then one at each requested factor, or with arc length at
/// each step, those at limit points included.
///
/// # Errors
///
/// Impossible options; a failed solve is not an error here but an [`Outcome`].
pub fn solve(system: &mut System, options: &Options, observer: &mut dyn Observer) -> Result<Run, InputError> {
    options.validate()?;
    let start = Instant::now();
    let mut path = Path::new(system, options.newton);
    let end = path.follow(options, observer).inspect_err(|_| path.output_last(observer));
    let (outcome, reached, counts) = (Outcome::from_end(end), path.at.load.t, path.counts());
    let jumps = path.jumps;
    let seconds = Seconds::new(system, start.elapsed());
    Ok(Run { outcome, reached, jumps, counts: counts.of(system), seconds })
}
