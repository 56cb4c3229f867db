//! Why a solve could not go on, and what to try.

use crate::linear::LinearError;

/// Why the equations of a step could not be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// A force, a tangent or a correction is not finite.
    #[error("the state became infinite or not a number in iteration {iteration}")]
    NotFinite {
        /// Number of the Newton iteration, from 1.
        iteration: usize,
    },
    /// The tangent is singular.
    #[error("the tangent is singular at {place} (pivot {pivot:.1e} of {scale:.1e}) in iteration {iteration}")]
    Singular {
        /// Number of the Newton iteration, from 1.
        iteration: usize,
        /// The coordinate whose pivot vanished.
        place: String,
        /// The pivot.
        pivot: f64,
        /// Size of what it was computed from.
        scale: f64,
    },
    /// A correction is far larger than the model.
    #[error("iteration {iteration} moves the model by {correction:.1e} of its size")]
    Diverged {
        /// Number of the Newton iteration, from 1.
        iteration: usize,
        /// The correction, relative to the size of the model.
        correction: f64,
    },
    /// The corrections did not become small in time.
    #[error("no convergence in {iterations} iterations, last correction {correction:.1e} of the size of the model")]
    NotConverged {
        /// Number of iterations.
        iterations: usize,
        /// The last correction, relative to the size of the model.
        correction: f64,
    },
    /// A motion that looks for a stable equilibrium did not come to rest.
    #[error(
        "the structure does not come to rest in a stable equilibrium: {iterations} iterations, the last step of which \
         moved it by {moved:.1e} of its size"
    )]
    NotSettled {
        /// Number of iterations.
        iterations: usize,
        /// The length of the last step, relative to the size of the model.
        moved: f64,
    },
    /// The corrections stopped shrinking at the level of rounding, above the tolerance.
    #[error("corrections stay at {floor:.1e} of the size of the model, rounding, above the tolerance {tolerance:.1e}")]
    BelowRounding {
        /// The smallest correction that was reached, relative to the size of the model.
        floor: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// The supports leave rigid motions free.
    #[error("the model can move rigidly: {motions}")]
    Unsupported {
        /// The motions, in words.
        motions: String,
    },
    /// The solution found is not the next one on the path: it is too far away.
    #[error(
        "the solution found moves along the load {progress:.2} times as far as predicted, its energy is off by \
         {mismatch:.2} of the work: another branch"
    )]
    Disconnected {
        /// Displacement along the load's change, relative to the one that the tangent predicted.
        progress: f64,
        /// Gain of strain energy less the expected work, relative to the work of the load's change.
        mismatch: f64,
    },
    /// The equilibrium is not stable.
    #[error("the equilibrium is unstable: {negative} negative pivots")]
    Unstable {
        /// Number of negative pivots of the tangent.
        negative: usize,
    },
    /// Arc length has nothing to follow.
    #[error("the loads do not change with the load factor at {t:.6}: there is no path")]
    ConstantLoad {
        /// The load factor.
        t: f64,
    },
    /// A body has no mass.
    #[error("body \"{body}\" has no mass")]
    Massless {
        /// The body.
        body: String,
    },
    /// Not all modes that were wanted could be found.
    #[error("{found} of {count} modes were found")]
    ModesNotFound {
        /// Those that were found.
        found: usize,
        /// Those that exist or were wanted.
        count: usize,
    },
    /// A mode is nothing but rounding.
    #[error("rounding changes the squared frequency of mode {number} by up to {lost:.1e} of itself")]
    ModesLost {
        /// Which, from 1.
        number: usize,
        /// The rounding, relative to the squared frequency.
        lost: f64,
    },
    /// Loads that follow the body have no potential there.
    #[error(
        "loads that follow the body have no potential in this state: they couple the modes by {coupling:.1e} of their \
         squared frequencies"
    )]
    NoPotential {
        /// The largest coupling, relative to the squared frequencies.
        coupling: f64,
    },
    /// Forces or states of an explicit step are not finite.
    #[error("the state became infinite or not a number in the step to t = {t:.6e} s")]
    Overflow {
        /// End of the step, s.
        t: f64,
    },
    /// An element is turned inside out in a step.
    #[error("elements collapse at {place} in the step to {end}")]
    Collapsed {
        /// The middle of the element.
        place: String,
        /// End of the step, in words.
        end: String,
    },
    /// An explicit step, or the shortest that error control may take, is not stable.
    #[error("the step {step:.4e} s is above the limit {limit:.4e} s of the explicit method at t = {t:.4e} s")]
    StepAboveLimit {
        /// Time, s.
        t: f64,
        /// The step, s.
        step: f64,
        /// The longest stable step in this state, s.
        limit: f64,
    },
    /// Error control asks for a step that is too short.
    #[error("the tolerance needs steps below {step:.1e} s at t = {t:.6e} s{}", of_cause(.cause.as_deref()))]
    StepTooSmall {
        /// Time, s.
        t: f64,
        /// The step that was asked for, s.
        step: f64,
        /// Why the last longer step could not be made, unless its error was too large.
        cause: Option<Box<Failure>>,
    },
    /// The memory does not suffice.
    #[error("the equations do not fit in the memory")]
    TooLarge,
    /// The observer asked to stop.
    #[error("stopped on request")]
    Stopped,
}

fn of_cause(cause: Option<&Failure>) -> String {
    cause.map_or_else(String::new, |cause| format!(": {cause}"))
}

impl Failure {
    /// What a user can try.
    pub fn advice(&self) -> &'static str {
        match self {
            Self::NotFinite { .. } | Self::Diverged { .. } | Self::NotConverged { .. } => {
                "smaller steps (step in motion, more load_factors in statics), a finer mesh where it bends most, \
                 membrane = \"full\" in soft stretching motion; check units, thickness and loads"
            }
            Self::Singular { .. } => {
                "check the supports near that place and the units; a structure at its limit load needs displacement \
                 control or a dynamic run; what has moved well so far collapses there: spread a support or load at a \
                 point, membrane = \"full\" in soft stretching motion"
            }
            Self::BelowRounding { .. } => "a tolerance above the correction that was reached",
            Self::Unsupported { .. } => "supports that hold these motions, or kind = \"dynamic\" for a free body",
            Self::Disconnected { .. } => "more load_factors, or a smaller first step",
            Self::Unstable { .. } => {
                "the structure buckles or snaps here: a dynamic run with damping follows it; a small disturbing load shows the branch it takes"
            }
            Self::NotSettled { .. } => {
                "a finer mesh: a coarse one may be lost where a fine one rests; path = \"arc\", or a dynamic run with damping: \
                 what the structure goes to here is far, or nowhere (loads that follow the surface may make it flutter)"
            }
            Self::ConstantLoad { .. } => {
                "a load that acts on coordinates that are not fixed and grows with the load factor; path = \"load\""
            }
            Self::Massless { .. } => "a positive density, or kind = \"static\"",
            Self::ModesNotFound { .. } => {
                "fewer or more modes; a finer mesh, a thicker body: frequencies may be too far apart"
            }
            Self::ModesLost { .. } => "a wider or shorter body: its frequencies are too far apart",
            Self::NoPotential { .. } => "loads that keep their direction, or a dynamic run",
            Self::Overflow { .. } => "a smaller step, or an implicit method with error control (rtol)",
            Self::Collapsed { .. } => {
                "smaller steps (step or rtol in motion, more load_factors in statics); check loads, thickness and units: \
                 the material may not be able to carry the load"
            }
            Self::StepAboveLimit { .. } => {
                "a step below the limit, error control (rtol), or an implicit method; force = true to see what happens"
            }
            Self::StepTooSmall { cause: None, .. } => {
                "a larger rtol; if the motion is violent there, check loads, thickness and units"
            }
            Self::StepTooSmall { cause: Some(cause), .. } if matches!(**cause, Self::StepAboveLimit { .. }) => {
                "a smaller min_step, or an implicit method"
            }
            Self::StepTooSmall { .. } => {
                "an element may have collapsed or a load may be too large to be carried: check loads, thickness and \
                 units, spread a support or load at a point, refine the mesh where it bends most, add damping, \
                 membrane = \"full\" in soft stretching motion"
            }
            Self::TooLarge => "a coarser mesh",
            Self::Stopped => "run it again; a motion with a checkpoint goes on from there",
        }
    }

    /// The failure that a linear algebra error means in an iteration; `place` says which coordinate an equation is for.
    pub(crate) fn from_linear(error: LinearError, iteration: usize, place: impl Fn(usize) -> String) -> Self {
        match error {
            LinearError::Singular { column, pivot, scale } => {
                Self::Singular { iteration, place: place(column), pivot, scale }
            }
            LinearError::NotFinite { .. } => Self::NotFinite { iteration },
            LinearError::TooLarge { .. } | LinearError::InvalidPattern { .. } | LinearError::IndexOutOfRange { .. } => {
                Self::TooLarge
            }
        }
    }
}
