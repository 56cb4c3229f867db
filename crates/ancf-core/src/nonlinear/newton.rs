//! Newton's method: plain, with mixed integration points, and modified.

use crate::assembly::System;
use crate::linear::{Inertia, dot, gmres};
use crate::observe::Observer;

use super::convergence::Convergence;
use super::forces::{Forces, Tangent};
use super::reuse::{Kept, Reuse};
use super::scale::scales;
use super::{Failure, Options, Problem, Variant};

/// Accuracy of corrections with the part of a tangent that is not assembled, the most products for it, and the length of
/// the differences that make them, relative to the size of the model.
const TURNING_TOLERANCE: f64 = 1e-2;
const TURNING_PRODUCTS: usize = 8;
const DIFFERENCE: f64 = 1e-7;

/// A correction, relative to the size of the model, after which the factorisation serves the rest of a static solution.
/// Newton's method then needs one or two more iterations, in which the tangent hardly changes.
const NEAR: f64 = 1e-5;
/// Shares of the actual stress that are tried, one after the other, in the tangent of a stable structure that has negative
/// pivots with the extrapolated one, and the iterations in which they are.
const ACTUAL: [f64; 3] = [0.1, 0.3, 1.0];
const FIRST_ITERATIONS: usize = 5;

/// How a solution was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Time, or load factor, of the solution.
    pub t: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// Largest ratio of a correction, if it is above rounding, to the one before: Newton's method that starts near the
    /// solution has less than one.
    pub growth: f64,
    /// Negative pivots of the last tangent, those that count.
    pub negative_pivots: usize,
    /// Strain energy of the solution, J.
    pub energy: f64,
}

/// A Newton solver: settings and working memory.
pub struct Newton {
    options: Options,
    scale: Vec<f64>,
    forces: Forces,
    correction: Vec<f64>,
    /// Coordinates from which the stress is extrapolated.
    previous: Vec<f64>,
    /// Coordinates at the start.
    begin: Vec<f64>,
    reuse: Reuse,
    iterations: usize,
}

impl Newton {
    /// A solver for the equations of `system`.
    pub fn new(system: &System, options: Options) -> Self {
        let n = system.coordinates();
        Self {
            options,
            scale: scales(system),
            forces: Forces::new(n),
            correction: vec![0.0; n],
            previous: vec![0.0; n],
            begin: vec![0.0; n],
            reuse: Reuse::default(),
            iterations: 0,
        }
    }

    /// Iterations of all solutions so far.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// The factorisation that the next solution may use, and what is known about reuse.
    pub(crate) fn reuse(&self) -> Reuse {
        self.reuse
    }

    /// `q - q*` of the last solution, without what rounding of the coordinates `q` takes of it. With it inertia balances
    /// the forces to rounding however far the body has moved.
    pub(crate) fn distance_from_origin(&self) -> &[f64] {
        &self.forces.from_origin
    }

    /// Makes the next solution go on from there, with the factorisation that the system holds.
    pub(crate) fn resume(&mut self, reuse: Reuse) {
        self.reuse = reuse;
    }

    /// Largest change between two states, relative to the size of the model.
    pub fn distance(&self, from: &[f64], to: &[f64]) -> f64 {
        from.iter().zip(to).zip(&self.scale).map(|((a, b), s)| (b - a).abs() / s).fold(0.0, f64::max)
    }

    /// Largest changes that count as one, of each coordinate.
    pub fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// Solves a problem, starting from `q`. If `last` is given, the geometric stiffness of the first iteration uses
    /// the stress extrapolated from there.
    ///
    /// # Errors
    ///
    /// See [`Failure`]; `q` is then of no use.
    pub fn solve(
        &mut self,
        system: &mut System,
        problem: &Problem<'_>,
        q: &mut [f64],
        last: Option<&[f64]>,
        observer: &dyn Observer,
    ) -> Result<Report, Failure> {
        self.iterate(system, *problem, None, q, last, observer)
    }

    /// The same with a load factor that is found, from `problem.t` on: the coordinates stay in the plane through `q`
    /// with the given normal instead.
    ///
    /// # Source
    ///
    /// Riks (1979); Keller (1977): the bordered equations are solved with two right-hand sides.
    ///
    /// # Errors
    ///
    /// See [`Failure`]; `q` is then of no use.
    pub fn solve_in_plane(
        &mut self,
        system: &mut System,
        problem: &Problem<'_>,
        normal: &[f64],
        q: &mut [f64],
        last: Option<&[f64]>,
        observer: &dyn Observer,
    ) -> Result<Report, Failure> {
        self.iterate(system, *problem, Some(normal), q, last, observer)
    }

    /// Iterates with the factorisation that is kept, if reuse is wanted; should that fail, without it; should that fail in
    /// motion, from the last state.
    ///
    /// Where accelerations change much in a step, as where an element snaps, what they predict may be further from the
    /// solution than the last state. A solution found from there counts if it is a minimum, as that of a short step is.
    fn iterate(
        &mut self,
        system: &mut System,
        problem: Problem<'_>,
        normal: Option<&[f64]>,
        q: &mut [f64],
        last: Option<&[f64]>,
        observer: &dyn Observer,
    ) -> Result<Report, Failure> {
        let final_end = |end: &Result<_, _>| matches!(end, Ok(_) | Err(Failure::Stopped | Failure::TooLarge));
        let reuse = self.options.reuse;
        let mut end = self.attempt(reuse, system, problem, normal, q, last, observer);
        if reuse && !final_end(&end) {
            q.copy_from_slice(&self.begin);
            end = self.attempt(false, system, problem, normal, q, last, observer);
        }
        match last {
            Some(state) if problem.mass != 0.0 && !final_end(&end) => {
                q.copy_from_slice(&self.begin);
                system.free().iter().for_each(|&i| q[i] = state[i]);
                let again = self.attempt(false, system, problem, normal, q, last, observer);
                let counts = again.as_ref().is_ok_and(|report| report.negative_pivots == 0);
                if counts || again == Err(Failure::Stopped) { again } else { end }
            }
            _ => end,
        }
    }

    #[expect(clippy::too_many_arguments, reason = "those of `iterate`, and how")]
    fn attempt(
        &mut self,
        mut reuse: bool,
        system: &mut System,
        mut problem: Problem<'_>,
        normal: Option<&[f64]>,
        q: &mut [f64],
        last: Option<&[f64]>,
        observer: &dyn Observer,
    ) -> Result<Report, Failure> {
        let Options { variant, tolerance, max_iterations, .. } = self.options;
        let mip = variant == Variant::MixedIntegrationPoint;
        let mut extrapolate = false;
        if let (Some(last), true) = (last, mip) {
            self.previous.copy_from_slice(last);
            extrapolate = true;
        }
        self.begin.copy_from_slice(q);
        let begin = problem.t;
        let coefficients = problem.coefficients();
        self.reuse.begin(reuse, coefficients);
        let mut trusted = true;
        self.forces.begin(&problem, q);
        let mut convergence = Convergence::new(tolerance);
        for iteration in 1..=max_iterations {
            if observer.stop() {
                return Err(Failure::Stopped);
            }
            self.iterations += 1;
            let fresh = self.reuse.kept.is_none();
            let tangent = fresh.then_some(Tangent { previous: extrapolate.then_some(self.previous.as_slice()) });
            let strain = self.forces.evaluate(system, &problem, q, tangent);
            let finite = self.forces.residual.iter().all(|r| r.is_finite());
            if fresh && !finite {
                return Err(Failure::NotFinite { iteration });
            }
            let mut inertia = self.reuse.kept.map_or_else(|| factorize(system, iteration), |kept| Ok(kept.inertia))?;
            // Such a tangent says nothing about the stability of the solution.
            let firmer = fresh
                && extrapolate
                && problem.stable
                && iteration <= FIRST_ITERATIONS
                && system.instabilities(inertia) > 0;
            if firmer {
                inertia = self.bring_in_stress(system, &problem, q, iteration)?;
            }
            let mut size = f64::INFINITY;
            if finite {
                system.solve(&self.forces.residual, &mut self.correction);
                if problem.start.is_some() {
                    self.bring_in_turning(system, &problem, q);
                }
                if let Some(normal) = normal {
                    problem.t += stay_in_plane(system, normal, q, problem.t, &mut self.correction);
                }
                size = self.correction.iter().zip(&self.scale).map(|(d, s)| d.abs() / s).fold(0.0, nan_max);
            }
            if !(fresh || finite && convergence.leads_on(size)) {
                // The old factorisation leads away: back to the start with a new one.
                q.copy_from_slice(&self.begin);
                problem.t = begin;
                self.forces.begin(&problem, q);
                self.reuse.failed();
                (self.reuse.kept, extrapolate, reuse) = (None, false, false);
                convergence.restart();
                continue;
            }
            // One that did not serve shows that the solution is far: from here on each iteration has its own.
            let contracts = convergence.contracts(size);
            if !(fresh || contracts) {
                self.reuse.failed();
                reuse = false;
            }
            if fresh && iteration == 1 {
                trusted = reuse && self.reuse.try_first();
            }
            let small = convergence.take(iteration, size, dot(&self.correction, &self.forces.residual))?;
            let converged = small && !firmer;
            self.previous.copy_from_slice(q);
            self.forces.correct(&self.correction, q);
            extrapolate = mip;
            // Where the first factorisation is not trusted, the next one is that has shown to contract.
            let keep = reuse && (trusted || iteration > 1 && contracts) || converged && self.options.reuse;
            let keep = keep || problem.mass == 0.0 && contracts && size <= NEAR && !firmer;
            self.reuse.kept = keep.then_some(Kept { coefficients, inertia });
            if converged {
                if !fresh {
                    self.reuse.served();
                }
                // The energy was evaluated one correction before the solution.
                let energy = strain.total() - dot(&self.correction, &self.forces.internal);
                return Ok(Report {
                    t: problem.t,
                    iterations: iteration,
                    growth: convergence.growth,
                    negative_pivots: system.instabilities(inertia),
                    energy,
                });
            }
        }
        Err(Failure::NotConverged { iterations: max_iterations, correction: convergence.size })
    }

    /// Factorises the tangent with as much of the actual stress as makes it positive, if that does.
    ///
    /// Extrapolated along a step, compression grows in proportion where that of a buckled skin does not, and with it the
    /// tangent loses its definiteness. The actual stress at the prediction is one of tension by all that has turned.
    /// Extrapolation over a part `f` of the step has a share `1 - f^2` of it, if strains are quadratic in the coordinates.
    fn bring_in_stress(
        &mut self,
        system: &mut System,
        problem: &Problem<'_>,
        q: &[f64],
        iteration: usize,
    ) -> Result<Inertia, Failure> {
        let mut inertia = Inertia { negative: 0 };
        for share in ACTUAL {
            let part = (1.0_f64 - share).sqrt();
            let previous: Vec<f64> = q.iter().zip(&self.previous).map(|(q, p)| q - part * (q - p)).collect();
            self.forces.evaluate(system, problem, q, Some(Tangent { previous: Some(&previous) }));
            inertia = factorize(system, iteration)?;
            if system.instabilities(inertia) == 0 {
                break;
            }
        }
        Ok(inertia)
    }

    /// Corrects for what the assembled tangent of mean forces lacks: strains change along `B` at the end of the step, not at
    /// its middle, `B_m^T W (B_1 - B_m) / 2`, which is not symmetric. The factorised tangent is the preconditioner.
    fn bring_in_turning(&mut self, system: &mut System, problem: &Problem<'_>, q: &[f64]) {
        let Self { forces, correction, scale, .. } = self;
        let mut product = vec![0.0; q.len()];
        let apply = |x: &[f64], y: &mut [f64]| {
            let size = x.iter().zip(scale.iter()).map(|(x, s)| x.abs() / s).fold(0.0, f64::max);
            forces.derivative(system, problem, [q, x], DIFFERENCE / size, &mut product);
            system.solve(&product, y);
        };
        gmres(apply, correction, TURNING_TOLERANCE, TURNING_PRODUCTS);
    }
}

/// Factorises the tangent of an iteration.
fn factorize(system: &mut System, iteration: usize) -> Result<Inertia, Failure> {
    system.factorize().map_err(|error| Failure::from_linear(error, iteration, |row| system.describe(row)))
}

/// Changes a correction so that it keeps the coordinates in the plane with the given normal, and returns the change of the
/// load factor that this takes.
fn stay_in_plane(system: &mut System, normal: &[f64], q: &[f64], t: f64, correction: &mut [f64]) -> f64 {
    let [mut force, mut rate] = [vec![0.0; q.len()], vec![0.0; q.len()]];
    system.external_force_rate(q, t, &mut force);
    system.solve(&force, &mut rate);
    let change = dot(normal, correction) / dot(normal, &rate);
    correction.iter_mut().zip(&rate).for_each(|(c, v)| *c -= change * v);
    change
}

/// The larger of two numbers; NaN if either is.
fn nan_max(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}
