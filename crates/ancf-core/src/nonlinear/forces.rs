//! The residual of a problem and its tangent.

use crate::assembly::{StrainEnergy, StrainRates, System};
use crate::element::{At, Motion, Want};

use super::{Problem, Velocity};

/// The correction of the mean stress stays below this share of the stress that a step adds.
const MOST_CORRECTION: f64 = 0.25;

/// Forces of a problem at some coordinates, with the memory to find them.
pub(super) struct Forces {
    /// The elastic force, with that of viscosity.
    pub internal: Vec<f64>,
    /// `c M (q - q*) + k (Q_k - Q_e + damping) + p`.
    pub residual: Vec<f64>,
    /// `q - q*`, more precise than the difference of rounded coordinates; without inertia of no matter.
    pub from_origin: Vec<f64>,
    external: Vec<f64>,
    velocity: Vec<f64>,
    work: Vec<f64>,
    /// The viscosity of the last evaluation, and the one that would have kept the energy there.
    viscosity: f64,
    conserving: f64,
}

/// The tangent that is wanted beside the forces.
#[derive(Clone, Copy)]
pub(super) struct Tangent<'a> {
    /// Coordinates from which the stress in the geometric stiffness is extrapolated.
    pub previous: Option<&'a [f64]>,
}

impl Forces {
    pub fn new(coordinates: usize) -> Self {
        let zeros = || vec![0.0; coordinates];
        let [internal, residual, from_origin] = [zeros(), zeros(), zeros()];
        Self {
            internal,
            residual,
            from_origin,
            external: zeros(),
            velocity: zeros(),
            work: zeros(),
            viscosity: 0.0,
            conserving: 0.0,
        }
    }

    /// Begins at some coordinates.
    pub fn begin(&mut self, problem: &Problem<'_>, q: &[f64]) {
        self.conserving = 0.0;
        for ((from_origin, q), origin) in self.from_origin.iter_mut().zip(q).zip(problem.origin) {
            *from_origin = q - origin;
        }
    }

    /// Subtracts a correction from the coordinates.
    pub fn correct(&mut self, correction: &[f64], q: &mut [f64]) {
        for ((q, from_origin), d) in q.iter_mut().zip(&mut self.from_origin).zip(correction) {
            *q -= d;
            *from_origin -= d;
        }
    }

    /// Evaluates the residual and leaves the tangent, if wanted, with the system. Returns the strain energy.
    pub fn evaluate(
        &mut self,
        system: &mut System,
        problem: &Problem<'_>,
        q: &[f64],
        tangent: Option<Tangent<'_>>,
    ) -> StrainEnergy {
        self.viscosity = self.conserving;
        let strain = self.form(system, problem, q, tangent);
        if problem.start.is_some() {
            let rate = problem.velocity.map_or(0.0, |velocity| velocity.rate);
            self.conserving = conserving_viscosity(system.strain_rates(), rate);
        }
        strain
    }

    /// `J x` by a difference, where `J` is the true derivative of the residual at the coordinates `q` of the last
    /// evaluation, for the viscosity there; `length` is that of the difference.
    pub fn derivative(
        &self,
        system: &mut System,
        problem: &Problem<'_>,
        [q, x]: [&[f64]; 2],
        length: f64,
        product: &mut [f64],
    ) {
        let moved: Vec<f64> = q.iter().zip(x).map(|(q, x)| q + length * x).collect();
        let mut there = Self::new(q.len());
        there.begin(problem, &moved);
        there.viscosity = self.viscosity;
        there.form(system, problem, &moved, None);
        for ((product, there), here) in product.iter_mut().zip(&there.residual).zip(&self.residual) {
            *product = (there - here) / length;
        }
    }

    fn form(
        &mut self,
        system: &mut System,
        problem: &Problem<'_>,
        q: &[f64],
        tangent: Option<Tangent<'_>>,
    ) -> StrainEnergy {
        let mut motion = None;
        if let Some(Velocity { rate, at_origin }) = problem.velocity {
            for i in 0..q.len() {
                self.velocity[i] = at_origin[i] + rate * self.from_origin[i];
            }
            motion = Some(Motion { velocity: &self.velocity, rate, viscosity: self.viscosity });
        }
        let at = At { q, start: problem.start, motion };
        let strain = if let Some(Tangent { previous }) = tangent {
            let want = Want { mass: problem.mass, stiffness: problem.stiffness, previous };
            system.assemble_at(at, problem.t, want, &mut self.internal)
        } else {
            system.force(at, &mut self.internal)
        };
        self.form_residual(system, problem, q);
        strain
    }

    fn form_residual(&mut self, system: &System, problem: &Problem<'_>, q: &[f64]) {
        let Problem { t, mass, stiffness, constant, velocity, start, .. } = *problem;
        // Loads act on the mean configuration where forces are means.
        self.work.copy_from_slice(q);
        if let Some(start) = start {
            for (mean, start) in self.work.iter_mut().zip(start) {
                *mean = 0.5 * (*mean + start);
            }
        }
        system.external_force(&self.work, t, &mut self.external);
        for i in 0..q.len() {
            self.residual[i] = stiffness * (self.internal[i] - self.external[i]) + constant.map_or(0.0, |p| p[i]);
        }
        if mass != 0.0 {
            for i in 0..q.len() {
                self.work[i] = mass * self.from_origin[i];
            }
            if let (Some(damping), true) = (system.mass_damping(), velocity.is_some()) {
                for i in 0..q.len() {
                    self.work[i] += stiffness * damping[i / 3] * self.velocity[i];
                }
            }
            system.add_mass_times(&self.work, &mut self.residual);
        }
    }
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
