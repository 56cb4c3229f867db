//! Newton's method, plain and with mixed integration points.

use crate::assembly::{StrainRates, System};
use crate::element::{At, Motion, Want};
use crate::error::InputError;
use crate::observe::Observer;

use super::{Failure, Problem, Velocity};

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

/// How a solution was found.
#[derive(Clone, Copy, Debug)]
pub struct Report {
    /// Time, or load factor, of the solution.
    pub t: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// Largest ratio of a correction, if it is above rounding, to the one before: Newton's method that starts near the
    /// solution has less than one.
    pub growth: f64,
    /// Negative pivots of the last tangent.
    pub negative_pivots: usize,
    /// Strain energy of the solution, J.
    pub energy: f64,
}

/// A Newton solver: settings and working memory.
pub struct Newton {
    options: Options,
    scale: Vec<f64>,
    internal: Vec<f64>,
    external: Vec<f64>,
    residual: Vec<f64>,
    correction: Vec<f64>,
    previous: Vec<f64>,
    offset: Vec<f64>,
    velocity: Vec<f64>,
    begin: Vec<f64>,
    kept: Option<Kept>,
    iterations: usize,
}

/// The factorisation that the system holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kept {
    /// The factors of inertia and stiffness, and the rate of the velocities, that it was made with.
    pub coefficients: [f64; 3],
    /// Negative pivots.
    pub negative: usize,
}

/// A correction this many times the size of the model cannot lead anywhere.
const ABSURD: f64 = 1e3;
/// Corrections below this that no longer shrink are rounding.
const ROUNDING: f64 = 1e-6;
/// Iterations without progress after which there will be none.
const HOPELESS: usize = 6;
/// The energy of a correction, relative to the first one, that goes with convergence.
const ENERGY: f64 = 1e-6;
/// A kept factorisation must shrink the corrections by this factor.
const CONTRACTION: f64 = 0.2;
/// The correction of the mean stress stays below this share of the stress that a step adds.
const MOST_CORRECTION: f64 = 0.25;

impl Newton {
    /// A solver for the equations of `system`.
    pub fn new(system: &System, options: Options) -> Self {
        let zeros = || vec![0.0; system.coordinates()];
        Self {
            options,
            scale: scales(system),
            internal: zeros(),
            external: zeros(),
            residual: zeros(),
            correction: zeros(),
            previous: zeros(),
            offset: zeros(),
            velocity: zeros(),
            begin: zeros(),
            kept: None,
            iterations: 0,
        }
    }

    /// Iterations of all solutions so far.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// The factorisation that the next solution may use.
    pub(crate) fn kept(&self) -> Option<Kept> {
        self.kept
    }

    /// Makes the next solution use the factorisation that the system holds, or none.
    pub(crate) fn keep(&mut self, kept: Option<Kept>) {
        self.kept = kept;
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

    fn iterate(
        &mut self,
        system: &mut System,
        mut problem: Problem<'_>,
        normal: Option<&[f64]>,
        q: &mut [f64],
        last: Option<&[f64]>,
        observer: &dyn Observer,
    ) -> Result<Report, Failure> {
        let Options { variant, tolerance, max_iterations, reuse } = self.options;
        let mip = variant == Variant::MixedIntegrationPoint;
        let mut extrapolate = false;
        if let (Some(last), true) = (last, mip) {
            self.previous.copy_from_slice(last);
            extrapolate = true;
        }
        self.begin.copy_from_slice(q);
        let begin = problem.t;
        let rate = problem.velocity.map_or(0.0, |velocity| velocity.rate);
        let coefficients = [problem.mass, problem.stiffness, rate];
        self.kept = self.kept.filter(|kept| reuse && kept.coefficients == coefficients);
        let mut viscosity = 0.0;
        let mut first_energy = f64::NAN;
        let mut smallest = f64::INFINITY;
        let mut stalled = 0;
        let mut small = false;
        let mut growth: f64 = 0.0;
        let mut size = f64::INFINITY;
        for iteration in 1..=max_iterations {
            if observer.stop() {
                return Err(Failure::Stopped);
            }
            self.iterations += 1;
            let mut motion = None;
            if let Some(Velocity { rate, still }) = problem.velocity {
                for i in 0..q.len() {
                    self.velocity[i] = rate * (q[i] - still[i]);
                }
                motion = Some(Motion { velocity: &self.velocity, rate, viscosity });
            }
            let at = At { q, start: problem.start, motion };
            let fresh = self.kept.is_none();
            let strain = if fresh {
                let previous = extrapolate.then_some(self.previous.as_slice());
                let want = Want { mass: problem.mass, stiffness: problem.stiffness, previous };
                system.assemble_at(at, problem.t, want, &mut self.internal)
            } else {
                system.force(at, &mut self.internal)
            };
            if problem.start.is_some() {
                viscosity = conserving_viscosity(system.strain_rates(), rate);
            }
            self.form_residual(system, &problem, q);
            let finite = self.residual.iter().all(|r| r.is_finite());
            if fresh && !finite {
                return Err(Failure::NotFinite { iteration });
            }
            let negative = match self.kept {
                Some(kept) => kept.negative,
                None => {
                    let inertia = system
                        .factorize()
                        .map_err(|e| Failure::from_linear(e, iteration, |row| system.describe(row)))?;
                    inertia.negative
                }
            };
            let last_size = size;
            if finite {
                system.solve(&self.residual, &mut self.correction);
                if let Some(normal) = normal {
                    problem.t += self.stay_in_plane(system, normal, q, problem.t);
                }
                size = self.correction.iter().zip(&self.scale).map(|(d, s)| d.abs() / s).fold(0.0, nan_max);
            }
            let leads_on = finite && size <= 2.0 * last_size;
            if !(fresh || leads_on) {
                // The old factorisation leads away: back to the start with a new one.
                q.copy_from_slice(&self.begin);
                problem.t = begin;
                (self.kept, extrapolate, size) = (None, false, f64::INFINITY);
                continue;
            }
            if size > ROUNDING {
                growth = growth.max(size / last_size);
            }
            if !size.is_finite() {
                return Err(Failure::NotFinite { iteration });
            }
            if size > ABSURD {
                return Err(Failure::Diverged { iteration, correction: size });
            }
            self.previous.copy_from_slice(q);
            for (q, d) in q.iter_mut().zip(&self.correction) {
                *q -= d;
            }
            extrapolate = mip;
            let useful = fresh || size <= CONTRACTION * last_size;
            self.kept = (reuse && useful).then_some(Kept { coefficients, negative });

            let energy = self.correction.iter().zip(&self.residual).map(|(d, r)| d * r).sum::<f64>().abs();
            if first_energy.is_nan() {
                first_energy = energy;
            }
            // Where the start is almost the solution the first energy is rounding; then two small corrections settle it.
            let settled = energy <= ENERGY * first_energy || small;
            small = size <= tolerance;
            if small && settled {
                // The energy was evaluated one correction before the solution.
                let change: f64 = self.correction.iter().zip(&self.internal).map(|(d, f)| d * f).sum();
                let energy = strain.total() - change;
                return Ok(Report { t: problem.t, iterations: iteration, growth, negative_pivots: negative, energy });
            }
            stalled = if size < 0.5 * smallest { 0 } else { stalled + 1 };
            smallest = smallest.min(size);
            if smallest < ROUNDING && stalled >= 4 {
                return Err(Failure::BelowRounding { floor: smallest, tolerance });
            }
            if stalled >= HOPELESS {
                return Err(Failure::NotConverged { iterations: iteration, correction: size });
            }
        }
        Err(Failure::NotConverged { iterations: max_iterations, correction: size })
    }

    /// Changes the correction so that it keeps the coordinates in the plane with the given normal, and returns the change
    /// of the load factor that this takes.
    fn stay_in_plane(&mut self, system: &mut System, normal: &[f64], q: &[f64], t: f64) -> f64 {
        system.external_force_rate(q, t, &mut self.external);
        system.solve(&self.external, &mut self.offset);
        let along = |x: &[f64]| normal.iter().zip(x).map(|(n, x)| n * x).sum::<f64>();
        let change = along(&self.correction) / along(&self.offset);
        self.correction.iter_mut().zip(&self.offset).for_each(|(c, v)| *c -= change * v);
        change
    }

    /// `residual = c M (q - q*) + k (Q_k - Q_e + damping) + p`.
    fn form_residual(&mut self, system: &System, problem: &Problem<'_>, q: &[f64]) {
        let Problem { t, mass, stiffness, origin, constant, velocity, start } = *problem;
        // Loads act on the mean configuration where forces are means.
        self.offset.copy_from_slice(q);
        if let Some(start) = start {
            for (mean, start) in self.offset.iter_mut().zip(start) {
                *mean = 0.5 * (*mean + start);
            }
        }
        system.external_force(&self.offset, t, &mut self.external);
        for i in 0..q.len() {
            self.residual[i] = stiffness * (self.internal[i] - self.external[i]) + constant.map_or(0.0, |p| p[i]);
        }
        if mass != 0.0 {
            for i in 0..q.len() {
                self.offset[i] = mass * (q[i] - origin[i]);
            }
            if let (Some(damping), true) = (system.mass_damping(), velocity.is_some()) {
                for i in 0..q.len() {
                    self.offset[i] += stiffness * damping[i / 3] * self.velocity[i];
                }
            }
            system.add_mass_times(&self.offset, &mut self.residual);
        }
    }
}

/// The larger of two numbers; NaN if either is.
fn nan_max(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// The viscosity whose power over a step makes up for the energy that mean forces miss; `rate` is the inverse of the
/// step.
fn conserving_viscosity(rates: StrainRates, rate: f64) -> f64 {
    if rates.square == 0.0 {
        return 0.0;
    }
    let most = MOST_CORRECTION / rate;
    (rates.missed * rate / rates.square).clamp(-most, most)
}

/// The size that a correction of each coordinate is compared with: the extent of the body for positions, and what
/// moves a position by as much for gradients.
fn scales(system: &System) -> Vec<f64> {
    let model = system.model();
    let mut scale = vec![1.0; system.coordinates()];
    for body in model.bodies() {
        let extent = extent(body, model.reference());
        let ranges = body.grid().domain().map(|[from, to]| to - from);
        for node in 0..body.grid().nodes() {
            for (index, vector) in body.nodal_vectors().iter().enumerate() {
                // A vector through the thickness only turns with the body.
                let size = vector.orders().map_or(1.0, |(dx, dy)| extent / (ranges[0].powi(dx) * ranges[1].powi(dy)));
                let v = body.vector(node, index);
                scale[3 * v..3 * v + 3].fill(size);
            }
        }
    }
    scale
}

/// Diagonal of the box around a body at rest.
fn extent(body: &crate::model::Body, reference: &[f64]) -> f64 {
    let positions = (0..body.grid().nodes()).map(|node| &reference[3 * body.vector(node, 0)..][..3]);
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for r in positions {
        for c in 0..3 {
            low[c] = low[c].min(r[c]);
            high[c] = high[c].max(r[c]);
        }
    }
    (0..3).map(|c| (high[c] - low[c]).powi(2)).sum::<f64>().sqrt()
}
