//! Motion: `M q'' + Q_k(q) = Q_e(t, q)`, integrated in time with fixed steps.

mod generalized_alpha;
mod interpolate;

use std::time::Instant;

use crate::assembly::System;
use crate::element::Want;
use crate::error::InputError;
use crate::nonlinear::{Failure, Newton, Options as NewtonOptions};
use crate::observe::{Observer, State};
use crate::report::{Counts, Outcome, Run, Seconds};

pub use generalized_alpha::GeneralizedAlpha;

/// Settings of a motion.
#[derive(Clone, Debug)]
pub struct Options {
    /// Duration, s.
    pub until: f64,
    /// Time step, s. The last step is shortened to end at `until`.
    pub step: f64,
    /// The integrator.
    pub method: GeneralizedAlpha,
    /// Times at which a state is wanted, s; between steps it is interpolated.
    pub outputs: Vec<f64>,
    /// Velocities of the nodal coordinates at the start; none: at rest.
    pub velocity: Option<Vec<f64>>,
    /// Newton's method.
    pub newton: NewtonOptions,
}

impl Options {
    /// Checks the numbers for a system.
    ///
    /// # Errors
    ///
    /// Duration and step must be positive, outputs increase within the duration, velocities must be finite, as many as
    /// there are coordinates, and zero where the coordinate is fixed.
    pub fn validate(&self, system: &System) -> Result<(), InputError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        InputError::check("until", self.until, positive(self.until), "a positive number, s")?;
        InputError::check("step", self.step, positive(self.step), "a positive number, s")?;
        let inside = self.outputs.iter().all(|t| (0.0..=self.until).contains(t));
        let increasing = self.outputs.is_sorted_by(|a, b| a < b);
        let allowed = format!("increasing times from 0 to {}", self.until);
        InputError::check("outputs", format!("{:?}", self.outputs), inside && increasing, &allowed)?;
        if let Some(velocity) = &self.velocity {
            let n = system.coordinates();
            InputError::check(
                "velocity",
                format!("{} numbers", velocity.len()),
                velocity.len() == n,
                &format!("{n} numbers"),
            )?;
            let valid = |(v, fixed): (&f64, &bool)| v.is_finite() && (*v == 0.0 || !fixed);
            let wrong = velocity.iter().zip(system.model().fixed()).position(|pair| !valid(pair));
            if let Some(i) = wrong {
                return Err(InputError::new(
                    format!("velocity.{i}"),
                    velocity[i],
                    "finite, and 0 where the coordinate is fixed",
                ));
            }
        }
        self.newton.validate()
    }
}

/// The state of a motion at one time.
#[derive(Clone, Debug, Default)]
struct Instantaneous {
    t: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    /// Force of the loads.
    external: Vec<f64>,
    /// Work of the loads since the start.
    work: f64,
    negative_pivots: Option<usize>,
}

/// Integrates the motion from the reference configuration.
///
/// States are given to the observer at the requested times. Between two steps positions are interpolated by the cubic
/// through the positions and velocities at both, whose error is of higher order than the integrator's.
///
/// # Errors
///
/// Impossible options; a motion that could not be continued is not an error here but an [`Outcome`].
pub fn simulate(system: &mut System, options: &Options, observer: &mut dyn Observer) -> Result<Run, InputError> {
    options.validate(system)?;
    let start = Instant::now();
    let mut newton = Newton::new(system, options.newton);
    let mut counts = Counts::default();
    let mut reached = 0.0;
    let end = run(system, options, &mut newton, &mut counts, &mut reached, observer);
    counts.iterations = newton.iterations();
    let seconds = Seconds::new(system, start.elapsed());
    Ok(Run { outcome: Outcome::from_end(end), reached, jumps: Vec::new(), counts: counts.of(system), seconds })
}

fn run(
    system: &mut System,
    options: &Options,
    newton: &mut Newton,
    counts: &mut Counts,
    reached: &mut f64,
    observer: &mut dyn Observer,
) -> Result<(), Failure> {
    let mut now = start(system, options)?;
    let mut next = now.clone();
    let mut outputs = options.outputs.iter().copied().peekable();
    if outputs.next_if_eq(&0.0).is_some() {
        observer.state(output(system, &now));
    }
    // Steps are counted, so that their ends do not drift with rounding; the last may be shorter.
    let steps = (options.until / options.step - 1e-9).ceil().max(1.0) as usize;
    for k in 1..=steps {
        if observer.stop() {
            return Err(Failure::Stopped);
        }
        next.t = if k == steps { options.until } else { k as f64 * options.step };
        if let Err(failure) = options.method.step(system, newton, &now, &mut next, observer) {
            counts.rejected += usize::from(failure != Failure::Stopped);
            return Err(failure);
        }
        system.external_force(&next.q, next.t, &mut next.external);
        next.work = now.work;
        for i in 0..next.q.len() {
            next.work += 0.5 * (now.external[i] + next.external[i]) * (next.q[i] - now.q[i]);
        }
        counts.steps += 1;
        while let Some(t) = outputs.next_if(|t| *t <= next.t) {
            let state =
                if t == next.t { output(system, &next) } else { output(system, &interpolate::between(&now, &next, t)) };
            observer.state(state);
        }
        std::mem::swap(&mut now, &mut next);
        *reached = now.t;
        observer.reached(now.t);
    }
    Ok(())
}

/// The initial state: the accelerations satisfy the equations of motion on the free coordinates.
fn start(system: &mut System, options: &Options) -> Result<Instantaneous, Failure> {
    if let Some(body) = system.model().bodies().iter().find(|body| body.plate().material.density() == 0.0) {
        return Err(Failure::Massless { body: body.name().to_owned() });
    }
    let q = system.model().reference().to_vec();
    let zeros = vec![0.0; q.len()];
    let mut now = Instantaneous {
        v: options.velocity.clone().unwrap_or_else(|| zeros.clone()),
        a: zeros.clone(),
        external: zeros.clone(),
        q,
        ..Instantaneous::default()
    };
    let want = Want { mass: 1.0, stiffness: 0.0, previous: None };
    let mut internal = zeros;
    system.assemble(&now.q, 0.0, want, &mut internal);
    system.external_force(&now.q, 0.0, &mut now.external);
    system.factorize().map_err(|e| Failure::from_linear(e, 0, |row| system.describe(row)))?;
    for (force, external) in internal.iter_mut().zip(&now.external) {
        *force = external - *force;
    }
    system.solve(&internal, &mut now.a);
    Ok(now)
}

/// The output for a state.
fn output(system: &mut System, at: &Instantaneous) -> State {
    let (kinetic, momentum, angular_momentum) = system.motion(&at.q, &at.v);
    let strain = system.internal_force(&at.q, &mut vec![0.0; at.q.len()]);
    State {
        t: at.t,
        q: at.q.clone(),
        v: at.v.clone(),
        a: at.a.clone(),
        strain,
        kinetic,
        work: at.work,
        momentum,
        angular_momentum,
        negative_pivots: at.negative_pivots,
    }
}
