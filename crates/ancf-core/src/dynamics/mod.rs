//! Motion: `M q'' + Q_k(q) + damping = Q_e(t, q)`, integrated in time.
//!
//! `method` is the registry: a [`Method`] is a name with parameters, an `Integrator` makes one step. The integrators are
//! `generalized_alpha` (also HHT and Newmark), `runge_kutta` with the tableaux `tr_bdf2`, `esdirk` and
//! `dormand_prince`, `energy_momentum`, `verlet` and, for bodies that do not deform, `rigid`. What they need of a model
//! is in `equations`: implicit ones state their step as a `stage`, which is the one nonlinear problem of
//! [`nonlinear`](crate::nonlinear), explicit ones ask for accelerations,
//! which `inertia` finds. `control` chooses the length of steps, `stability` limits it, `simulation` strings steps together
//! and refuses those that turn elements inside out, and `checkpoint` is what is needed to go on later.

mod checkpoint;
mod control;
mod dormand_prince;
mod energy_momentum;
mod equations;
mod esdirk;
mod fingerprint;
mod generalized_alpha;
mod inertia;
mod method;
mod rigid;
mod runge_kutta;
mod simulation;
mod stability;
mod stage;
mod state;
mod tr_bdf2;
mod verlet;

use std::time::Instant;

use crate::assembly::{Bodies, System};
use crate::error::InputError;
use crate::nonlinear::{Failure, Newton, Options as NewtonOptions};
use crate::observe::Observer;
use crate::report::{Counts, Outcome, Run, Seconds};

pub use checkpoint::Checkpoint;
pub use control::{Steps, Tolerances};
pub use method::Method;

use equations::Equations;
use inertia::Inertia;
use simulation::Simulation;

/// Settings of a motion.
#[derive(Clone, Debug)]
pub struct Options {
    /// Duration, s.
    pub until: f64,
    /// The length of steps.
    pub steps: Steps,
    /// The integrator.
    pub method: Method,
    /// Times at which a state is wanted, s. Steps whose error is controlled end there; between fixed steps states are
    /// interpolated.
    pub outputs: Vec<f64>,
    /// Velocities of the nodal coordinates at the start; none: at rest. Moved supports have their own.
    pub velocity: Option<Vec<f64>>,
    /// Newton's method.
    pub newton: NewtonOptions,
}

impl Options {
    /// Checks the numbers for a system.
    ///
    /// # Errors
    ///
    /// Duration and steps must be positive, outputs increase within the duration, velocities must be finite, as many as
    /// there are coordinates, and zero where the coordinate is fixed.
    pub fn validate(&self, system: &System) -> Result<(), InputError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        InputError::check("until", self.until, positive(self.until), "a positive number, s")?;
        self.steps.validate()?;
        self.method.validate()?;
        if self.method == Method::Rigid {
            rigid::check(system.model())?;
        }
        let inside = self.outputs.iter().all(|t| (0.0..=self.until).contains(t));
        let increasing = self.outputs.is_sorted_by(|a, b| a < b);
        let allowed = format!("increasing times from 0 to {}", self.until);
        InputError::check("outputs", format!("{:?}", self.outputs), inside && increasing, &allowed)?;
        if let Some(velocity) = &self.velocity {
            let n = system.coordinates();
            let given = format!("{} numbers", velocity.len());
            InputError::check("velocity", given, velocity.len() == n, &format!("{n} numbers"))?;
            let valid = |(v, fixed): (&f64, &bool)| v.is_finite() && (*v == 0.0 || !fixed);
            let wrong = velocity.iter().zip(system.model().fixed()).position(|pair| !valid(pair));
            if let Some(i) = wrong {
                let allowed = "finite, and 0 where the coordinate is fixed";
                return Err(InputError::new(format!("velocity.{i}"), velocity[i], allowed));
            }
        }
        self.newton.validate()
    }

    /// Newton's method must be more precise than the steps.
    fn newton(&self) -> NewtonOptions {
        let tolerance = match self.steps {
            Steps::Fixed { .. } => self.newton.tolerance,
            Steps::Controlled(tolerances) => self.newton.tolerance.min(1e-2 * tolerances.rtol),
        };
        NewtonOptions { tolerance, ..self.newton }
    }
}

/// Integrates the motion from the reference configuration, or from a checkpoint of the same motion.
///
/// States are given to the observer at the requested times. Between fixed steps positions are interpolated by the
/// polynomial through positions and velocities (and accelerations, if the order of the method is above 2) at both ends,
/// whose error is of higher order than the integrator's.
///
/// # Errors
///
/// Impossible options, a checkpoint of another model; a motion that could not be continued is not an error here but an
/// [`Outcome`].
pub fn simulate(
    system: &mut System,
    options: &Options,
    checkpoint: Option<Checkpoint>,
    observer: &mut dyn Observer,
) -> Result<Run, InputError> {
    options.validate(system)?;
    if let Some(checkpoint) = &checkpoint {
        checkpoint.validate(system, options)?;
    }
    let start = Instant::now();
    let mut counts = Counts::default();
    let mut reached = 0.0;
    let work = |system: &mut System| run(system, options, checkpoint, &mut counts, &mut reached, observer);
    let lumped = options.method == Method::Verlet { lumped: true };
    let end = if lumped { system.with_lumped_mass(work) } else { work(system) };
    let counts = Counts { forces: counts.forces, factorizations: counts.factorizations, ..counts.of(system) };
    let seconds = Seconds::new(system, start.elapsed());
    Ok(Run { outcome: Outcome::from_end(end), reached, jumps: Vec::new(), counts, seconds })
}

fn run(
    system: &mut System,
    options: &Options,
    checkpoint: Option<Checkpoint>,
    counts: &mut Counts,
    reached: &mut f64,
    observer: &mut dyn Observer,
) -> Result<(), Failure> {
    let inertia = Inertia::new(system)?;
    let newton = Newton::new(system, options.newton());
    let bodies = if options.method == Method::Rigid { Bodies::Rigid } else { Bodies::Flexible };
    let mut simulation = Simulation::new(Equations::new(system, newton, inertia, bodies), options);
    let end = simulation.begin(checkpoint, observer).and_then(|()| simulation.run(observer));
    (*counts, *reached) = (simulation.counts(), simulation.reached());
    end
}
