//! Equilibria along a load path: Newton's method inside load steps of adaptive size.

use std::time::Instant;

use crate::assembly::System;
use crate::error::InputError;
use crate::nonlinear::{Failure, Newton, Options as NewtonOptions, Problem};
use crate::observe::{Observer, State};
use crate::report::{Counts, Outcome, Run, Seconds};

/// Settings of a static solve.
#[derive(Clone, Debug)]
pub struct Options {
    /// The load factors at which a solution is wanted, in the order of the path.
    pub load_factors: Vec<f64>,
    /// Newton's method.
    pub newton: NewtonOptions,
    /// First load step; none: up to the first load factor.
    pub first_step: Option<f64>,
    /// Smallest load step.
    pub min_step: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { load_factors: vec![1.0], newton: NewtonOptions::default(), first_step: None, min_step: 1e-5 }
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
        self.newton.validate()
    }
}

/// Largest change of a coordinate in one step, relative to the size of the model: about a quarter turn. A solution
/// further away may belong to another branch.
const MOST_CHANGE: f64 = 1.2;
/// A step that took no more iterations than this is followed by a larger one.
const EASY: usize = 7;

/// Follows the equilibrium path from the unloaded state through the load factors.
///
/// States are given to the observer: one at load factor 0 and one at each requested factor.
///
/// # Errors
///
/// Impossible options; a failed solve is not an error here but an [`Outcome`].
pub fn solve(system: &mut System, options: &Options, observer: &mut dyn Observer) -> Result<Run, InputError> {
    options.validate()?;
    let start = Instant::now();
    let newton = Newton::new(system, options.newton);
    let q = system.model().reference().to_vec();
    let work_force = vec![0.0; q.len()];
    let mut path = Path { system, newton, q, force: work_force, t: 0.0, work: 0.0, counts: Counts::default() };
    let end = path.follow(options, observer);
    path.counts.iterations = path.newton.iterations();
    let (outcome, reached, counts) = (Outcome::from_end(end), path.t, path.counts);
    Ok(Run { outcome, reached, counts: counts.of(system), seconds: Seconds::new(system, start.elapsed()) })
}

struct Path<'a> {
    system: &'a mut System,
    newton: Newton,
    q: Vec<f64>,
    /// Force of the loads at the last accepted state.
    force: Vec<f64>,
    t: f64,
    work: f64,
    counts: Counts,
}

impl Path<'_> {
    fn follow(&mut self, options: &Options, observer: &mut dyn Observer) -> Result<(), Failure> {
        let motions = self.system.model().rigid_motions(&self.q);
        if !motions.is_empty() {
            let motions = motions.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
            return Err(Failure::Unsupported { motions });
        }
        // Loads that do not vanish at load factor 0 act from the start.
        self.system.external_force(&self.q, 0.0, &mut self.force);
        let mut negative = None;
        if self.force.iter().any(|f| *f != 0.0) {
            negative = Some(self.advance(0.0, observer)?.1);
        }
        self.output(negative, observer);

        let mut step = options.first_step.unwrap_or(f64::INFINITY);
        for &target in &options.load_factors {
            let mut pivots = 0;
            while self.t != target {
                let left = (target - self.t).abs();
                let length = if step >= 0.999 * left { left } else { step };
                let t = if length == left { target } else { self.t + length.copysign(target - self.t) };
                match self.advance(t, observer) {
                    Ok((iterations, negative)) => {
                        self.counts.steps += 1;
                        pivots = negative;
                        step = if iterations <= EASY { 2.0 * length.max(step.min(left)) } else { length };
                        observer.reached(self.t);
                    }
                    Err(failure @ (Failure::Stopped | Failure::TooLarge | Failure::BelowRounding { .. })) => {
                        return Err(failure);
                    }
                    Err(failure) => {
                        self.counts.rejected += 1;
                        step = 0.5 * length;
                        if step < options.min_step {
                            return Err(failure);
                        }
                    }
                }
            }
            self.output(Some(pivots), observer);
        }
        Ok(())
    }

    /// Solves at load factor `t` and accepts the solution, or leaves everything as it was.
    fn advance(&mut self, t: f64, observer: &dyn Observer) -> Result<(usize, usize), Failure> {
        let zeros = vec![0.0; self.q.len()];
        let problem = Problem { t, mass: 0.0, stiffness: 1.0, origin: &zeros, constant: &zeros };
        let mut q = self.q.clone();
        let report = self.newton.solve(self.system, &problem, &mut q, None, observer)?;
        let increment = self.newton.distance(&self.q, &q);
        if increment > MOST_CHANGE {
            return Err(Failure::Disconnected { increment });
        }
        if report.negative_pivots > 0 {
            return Err(Failure::Unstable { negative: report.negative_pivots });
        }
        let mut force = vec![0.0; q.len()];
        self.system.external_force(&q, t, &mut force);
        for i in 0..q.len() {
            self.work += 0.5 * (self.force[i] + force[i]) * (q[i] - self.q[i]);
        }
        (self.q, self.force, self.t) = (q, force, t);
        Ok((report.iterations, report.negative_pivots))
    }

    fn output(&mut self, negative_pivots: Option<usize>, observer: &mut dyn Observer) {
        let zeros = vec![0.0; self.q.len()];
        let strain = self.system.internal_force(&self.q, &mut zeros.clone());
        observer.state(State {
            t: self.t,
            q: self.q.clone(),
            v: zeros.clone(),
            a: zeros,
            strain,
            kinetic: 0.0,
            work: self.work,
            momentum: [0.0; 3],
            angular_momentum: [0.0; 3],
            negative_pivots,
        });
        observer.reached(self.t);
    }
}
