//! The length of steps: fixed, or chosen so that the error of each stays within a tolerance.

use crate::error::InputError;

/// How long steps are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Steps {
    /// All equal, except that the last one may be shorter.
    Fixed {
        /// Length, s.
        step: f64,
        /// Whether an explicit method may exceed the limit of its stability.
        force: bool,
    },
    /// As long as the error estimate allows.
    Controlled(Tolerances),
}

impl Steps {
    /// Fixed steps.
    pub fn fixed(step: f64) -> Self {
        Self::Fixed { step, force: false }
    }

    /// Steps whose error is controlled.
    pub fn controlled(rtol: f64) -> Self {
        Self::Controlled(Tolerances { rtol, ..Tolerances::default() })
    }
}

/// What error control aims at: the sum of what all steps of a run add to the error of a position.
///
/// Each step may add its share by length. How the motion carries these errors on is its own matter: in a sensitive one
/// they grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Error of positions that is allowed, relative to the size of the body.
    pub rtol: f64,
    /// Error of positions that is allowed in addition, m.
    pub atol: f64,
    /// Length of the first step, s; none: from the accelerations at the start.
    pub first_step: Option<f64>,
    /// Longest step, s.
    pub max_step: f64,
    /// Shortest step, s: where it would have to be shorter, the run fails.
    pub min_step: f64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self { rtol: 1e-4, atol: 0.0, first_step: None, max_step: f64::INFINITY, min_step: 0.0 }
    }
}

impl Steps {
    /// Checks the numbers.
    ///
    /// # Errors
    ///
    /// Steps must be positive, `rtol` from 1e-12 to below 1, `atol` zero or positive.
    pub fn validate(&self) -> Result<(), InputError> {
        let step = |name: &str, x: f64| InputError::check(name, x, x > 0.0 && x.is_finite(), "a positive number, s");
        match *self {
            Self::Fixed { step: length, .. } => step("step", length),
            Self::Controlled(Tolerances { rtol, atol, first_step, max_step, min_step }) => {
                InputError::check("rtol", rtol, (1e-12..1.0).contains(&rtol), "from 1e-12 to below 1")?;
                InputError::check("atol", atol, atol >= 0.0 && atol.is_finite(), "zero or a positive number, m")?;
                if let Some(first) = first_step {
                    step("first_step", first)?;
                }
                InputError::check("max_step", max_step, max_step > 0.0, "a positive number, s")?;
                let valid = min_step >= 0.0 && min_step <= max_step;
                InputError::check("min_step", min_step, valid, "from 0 to max_step, s")
            }
        }
    }
}

/// Chooses step lengths from errors, by a proportional-integral controller.
///
/// # Source
///
/// Gustafsson (1991); Hairer and Wanner, Solving Ordinary Differential Equations II (1996), IV.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Controller {
    /// Length of the next step, s.
    pub step: f64,
    /// Error of the last accepted step, relative to what was allowed.
    pub last_error: f64,
    /// Whether the last step was rejected.
    pub rejected: bool,
    /// Longest step that is stable, s; infinite for implicit methods. It lies beside the others since a run that is
    /// resumed has to go on with it.
    pub limit: f64,
}

/// Share of the length at which the error would just be allowed.
const SAFETY: f64 = 0.9;
/// Most that a step may grow or shrink at once.
const FACTORS: (f64, f64) = (0.2, 4.0);
/// Steps that would change by less stay, so that factorisations can be kept.
const STEADY: (f64, f64) = (1.0, 1.2);
/// What a step whose equations could not be solved is multiplied with.
const CUT: f64 = 0.25;

impl Controller {
    pub fn new(step: f64) -> Self {
        Self { step, last_error: 1.0, rejected: false, limit: f64::INFINITY }
    }

    /// After a step of length `h` with an error of at most 1, relative to its share; it shrinks with `h` to the `power`.
    pub fn accept(&mut self, h: f64, error: f64, power: f64) {
        let error = error.max(1e-10);
        let factor = SAFETY * error.powf(-0.7 / power) * self.last_error.powf(0.4 / power);
        let steady = (STEADY.0..STEADY.1).contains(&(SAFETY * error.powf(-1.0 / power)));
        let most = if self.rejected { 1.0 } else { FACTORS.1 };
        let factor = if steady { 1.0 } else { factor.clamp(FACTORS.0, most) };
        // A step that was shortened to end at an output says nothing about longer ones.
        self.step = if h < self.step && factor >= 1.0 { self.step.max(factor * h) } else { factor * h };
        (self.last_error, self.rejected) = (error, false);
    }

    /// After a step of length `h` with a larger error.
    pub fn reject(&mut self, h: f64, error: f64, power: f64) {
        self.step = h * (SAFETY * error.powf(-1.0 / power)).max(FACTORS.0);
        self.rejected = true;
    }

    /// After a step of length `h` that could not be made.
    pub fn cut(&mut self, h: f64) {
        self.step = CUT * h;
        self.rejected = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error of a model problem, `h^3` times a factor that changes, stays near what is allowed.
    #[test]
    fn errors_settle_below_the_tolerance() {
        let mut controller = Controller::new(1e-3);
        let mut rejected = 0;
        for k in 0..200 {
            let difficulty = if k < 100 { 1e6 } else { 1e9 };
            loop {
                let error = difficulty * controller.step.powi(3);
                if error <= 1.0 {
                    controller.accept(controller.step, error, 3.0);
                    assert!(k % 100 < 20 || error > 0.3, "{k} {error}");
                    break;
                }
                rejected += 1;
                controller.reject(controller.step, error, 3.0);
            }
        }
        assert!(rejected < 6, "{rejected}");
    }

    #[test]
    fn impossible_numbers_are_refused() {
        let name = |steps: Steps| steps.validate().unwrap_err().argument;
        assert_eq!(name(Steps::fixed(0.0)), "step");
        assert_eq!(name(Steps::controlled(1e-16)), "rtol");
        let tolerances = Tolerances { min_step: 2.0, max_step: 1.0, ..Tolerances::default() };
        assert_eq!(name(Steps::Controlled(tolerances)), "min_step");
    }
}
