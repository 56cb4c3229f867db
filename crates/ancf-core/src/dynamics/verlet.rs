//! Stormer-Verlet: the cheapest method where the waves are slow.

use crate::nonlinear::Failure;
use crate::observe::Observer;

use super::equations::Equations;
use super::method::Integrator;
use super::state::Instantaneous;

/// Velocity Verlet, the explicit member of Newmark's family: second order, symplectic, one force a step.
///
/// Damping forces at the end of the step are those of the velocities predicted there.
///
/// # Source
///
/// Hairer, Lubich and Wanner (2003); Belytschko, Liu and Moran (2000), 6.2, for the damping.
#[derive(Clone, Copy, Debug)]
pub(super) struct Verlet;

impl Integrator for Verlet {
    fn order(&self) -> usize {
        2
    }

    fn explicit_limit(&self) -> Option<f64> {
        Some(2.0)
    }

    /// The error is what the position misses of the third derivative.
    fn step(
        &self,
        equations: &mut Equations<'_>,
        now: &Instantaneous,
        next: &mut Instantaneous,
        error: &mut [f64],
        _observer: &dyn Observer,
    ) -> Result<(), Failure> {
        let h = next.t - now.t;
        for i in 0..now.q.len() {
            next.v[i] = now.v[i] + h * now.a[i];
            next.q[i] = now.q[i] + h * (now.v[i] + 0.5 * h * now.a[i]);
        }
        equations.prescribe(next);
        equations.accelerate(next)?;
        for i in 0..now.q.len() {
            next.v[i] = now.v[i] + 0.5 * h * (now.a[i] + next.a[i]);
            error[i] = h * h / 6.0 * (next.a[i] - now.a[i]);
        }
        if equations.system.is_damped() {
            // Once more with the velocities just found, which makes damped motion second order too.
            equations.accelerate(next)?;
            for i in 0..now.q.len() {
                next.v[i] = now.v[i] + 0.5 * h * (now.a[i] + next.a[i]);
            }
        }
        equations.prescribe(next);
        next.accumulate(now);
        Ok(())
    }
}
