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
    external: Vec<f64>,
    velocity: Vec<f64>,
    coordinates: Vec<f64>,
    viscosity: f64,
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
        let [internal, residual, external, velocity] = [zeros(), zeros(), zeros(), zeros()];
        Self { internal, residual, external, velocity, coordinates: zeros(), viscosity: 0.0 }
    }

    /// Begins another problem.
    pub fn begin(&mut self) {
        self.viscosity = 0.0;
    }

    /// Evaluates the residual and leaves the tangent, if wanted, with the system. Returns the strain energy.
    pub fn evaluate(
        &mut self,
        system: &mut System,
        problem: &Problem<'_>,
        q: &[f64],
        tangent: Option<Tangent<'_>>,
    ) -> StrainEnergy {
        let mut motion = None;
        if let Some(Velocity { rate, still }) = problem.velocity {
            for i in 0..q.len() {
                self.velocity[i] = rate * (q[i] - still[i]);
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
        if problem.start.is_some() {
            let rate = problem.velocity.map_or(0.0, |velocity| velocity.rate);
            self.viscosity = conserving_viscosity(system.strain_rates(), rate);
        }
        self.form_residual(system, problem, q);
        strain
    }

    fn form_residual(&mut self, system: &System, problem: &Problem<'_>, q: &[f64]) {
        let Problem { t, mass, stiffness, origin, constant, velocity, start } = *problem;
        // Loads act on the mean configuration where forces are means.
        self.coordinates.copy_from_slice(q);
        if let Some(start) = start {
            for (mean, start) in self.coordinates.iter_mut().zip(start) {
                *mean = 0.5 * (*mean + start);
            }
        }
        system.external_force(&self.coordinates, t, &mut self.external);
        for i in 0..q.len() {
            self.residual[i] = stiffness * (self.internal[i] - self.external[i]) + constant.map_or(0.0, |p| p[i]);
        }
        if mass != 0.0 {
            for i in 0..q.len() {
                self.coordinates[i] = mass * (q[i] - origin[i]);
            }
            if let (Some(damping), true) = (system.mass_damping(), velocity.is_some()) {
                for i in 0..q.len() {
                    self.coordinates[i] += stiffness * damping[i / 3] * self.velocity[i];
                }
            }
            system.add_mass_times(&self.coordinates, &mut self.residual);
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
