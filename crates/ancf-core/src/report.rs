//! How a solve ended and what it took.

use std::time::Duration;

use crate::assembly::System;
use crate::nonlinear::Failure;

/// How a solve ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It reached its end.
    Ok,
    /// It could not go on.
    Failed(Failure),
    /// It was stopped by the observer.
    Interrupted,
}

impl Outcome {
    pub(crate) fn from_end(end: Result<(), Failure>) -> Self {
        match end {
            Ok(()) => Self::Ok,
            Err(Failure::Stopped) => Self::Interrupted,
            Err(failure) => Self::Failed(failure),
        }
    }
}

/// What a solve took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Elements of the model.
    pub elements: usize,
    /// Coordinates that are not fixed.
    pub dofs: usize,
    /// Accepted steps.
    pub steps: usize,
    /// Steps that were tried and not accepted.
    pub rejected: Rejections,
    /// Newton iterations.
    pub iterations: usize,
    /// Evaluations of the elastic forces of all elements, with or without their tangent.
    pub forces: usize,
    /// Numeric factorisations.
    pub factorizations: usize,
}

/// Steps that were tried and not accepted, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rejections {
    /// The error was too large; in statics: the solution was not the next one on the path.
    pub inaccurate: usize,
    /// Newton's method did not converge.
    pub unsolved: usize,
    /// The tangent was singular.
    pub singular: usize,
    /// A force or a state became infinite or not a number, as where an element collapses.
    pub not_finite: usize,
}

impl Rejections {
    /// All of them.
    pub fn total(&self) -> usize {
        self.inaccurate + self.unsolved + self.singular + self.not_finite
    }

    /// Counts a step that failed.
    pub(crate) fn count(&mut self, failure: &Failure) {
        *match failure {
            Failure::Disconnected { .. } => &mut self.inaccurate,
            Failure::Singular { .. } => &mut self.singular,
            Failure::NotFinite { .. } | Failure::Overflow { .. } => &mut self.not_finite,
            _ => &mut self.unsolved,
        } += 1;
    }
}

impl Counts {
    /// The same with what the system knows.
    pub(crate) fn of(self, system: &System) -> Self {
        let (elements, dofs) = (system.elements(), system.free().len());
        let forces = self.forces + system.forces();
        Self { elements, dofs, forces, factorizations: self.factorizations + system.factorizations(), ..self }
    }
}

/// Seconds by part.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seconds {
    /// All of it, the setup included.
    pub total: f64,
    /// Numbering, patterns, tables.
    pub setup: f64,
    /// Forces and tangents.
    pub assembly: f64,
    /// Numeric factorisations.
    pub factorization: f64,
    /// Solutions with a factorisation.
    pub solve: f64,
}

impl Seconds {
    pub(crate) fn new(system: &System, elapsed: Duration) -> Self {
        let timers = system.timers();
        Self {
            total: (timers.setup + elapsed).as_secs_f64(),
            setup: timers.setup.as_secs_f64(),
            assembly: timers.assembly.as_secs_f64(),
            factorization: timers.factorization.as_secs_f64(),
            solve: timers.solve.as_secs_f64(),
        }
    }
}

/// The end of a solve; its states have gone to the observer.
#[derive(Clone, Debug)]
pub struct Run {
    /// How it ended.
    pub outcome: Outcome,
    /// Time, or load factor, of the last accepted step.
    pub reached: f64,
    /// Load factors at which a structure in statics lost its equilibrium and jumped to another one.
    pub jumps: Vec<f64>,
    /// What it took.
    pub counts: Counts,
    /// Where the time went.
    pub seconds: Seconds,
}
