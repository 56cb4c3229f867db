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
        let n = now.q.len();
        // Slices of one length, so that the loops need not check it.
        let (q, v, a) = (&now.q[..n], &now.v[..n], &now.a[..n]);
        let (next_q, next_v) = (&mut next.q[..n], &mut next.v[..n]);
        for i in 0..n {
            next_v[i] = v[i] + h * a[i];
            next_q[i] = q[i] + h * (v[i] + 0.5 * h * a[i]);
        }
        equations.prescribe(next);
        equations.accelerate(next)?;
        let (next_v, next_a, error) = (&mut next.v[..n], &next.a[..n], &mut error[..n]);
        for i in 0..n {
            next_v[i] = v[i] + 0.5 * h * (a[i] + next_a[i]);
            error[i] = h * h / 6.0 * (next_a[i] - a[i]);
        }
        if equations.system.is_damped() {
            // Once more with the velocities just found, which makes damped motion second order too.
            equations.accelerate(next)?;
            for i in 0..n {
                next.v[i] = v[i] + 0.5 * h * (a[i] + next.a[i]);
            }
        }
        equations.prescribe(next);
        next.accumulate(now);
        Ok(())
    }
}
