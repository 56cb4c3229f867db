//! The energy-momentum method: what a conservative system keeps, it keeps at any step.

use crate::nonlinear::{Failure, Problem, Velocity};
use crate::observe::Observer;

use super::equations::Equations;
use super::method::Integrator;
use super::state::Instantaneous;

/// `M (v_1 - v_0) / h + mean force = 0`, `q_1 - q_0 = h (v_0 + v_1) / 2`, with the mean elastic force of
/// [`Problem::start`], whose work over the step is the change of strain energy. Second order; energy, momentum and
/// angular momentum are kept to the tolerance of Newton's method.
///
/// # Source
///
/// Simo and Tarnow (1994); Gonzalez (1996).
#[derive(Clone, Copy, Debug)]
pub(super) struct EnergyMomentum;

impl Integrator for EnergyMomentum {
    fn order(&self) -> usize {
        2
    }

    /// The accelerations are those in the middle of a step. From one step to the next their change is the third
    /// derivative times the distance of the middles; the error is that of the midpoint rule, `h^3 q''' / 12`.
    fn step(
        &self,
        equations: &mut Equations<'_>,
        now: &Instantaneous,
        next: &mut Instantaneous,
        error: &mut [f64],
        observer: &dyn Observer,
    ) -> Result<(), Failure> {
        let h = next.t - now.t;
        let n = now.q.len();
        let middle = now.t + 0.5 * h;
        let mut origin: Vec<f64> = (0..n).map(|i| now.q[i] + h * now.v[i]).collect();
        for i in 0..n {
            next.q[i] = origin[i] + 0.5 * h * h * now.a[i];
        }
        next.lag = 0.5 * h;
        equations.prescribe(next);
        for i in equations.moved() {
            origin[i] = next.q[i] - 0.5 * h * (next.v[i] - now.v[i]);
        }
        let rate = 1.0 / h;
        let problem = Problem {
            t: middle,
            mass: 2.0 * rate * rate,
            stiffness: 1.0,
            origin: &origin,
            constant: None,
            velocity: Some(Velocity { rate, still: &now.q }),
            start: Some(&now.q),
        };
        let report = equations.newton.solve(equations.system, &problem, &mut next.q, Some(&now.q), observer)?;

        let distance = 0.5 * h + now.lag;
        let mut mean = next.clone();
        mean.t = middle;
        for i in 0..n {
            next.a[i] = 2.0 * rate * rate * (next.q[i] - origin[i]);
            next.v[i] = now.v[i] + h * next.a[i];
            error[i] = h * h * h / 12.0 * (next.a[i] - now.a[i]) / distance;
            mean.q[i] = 0.5 * (now.q[i] + next.q[i]);
            mean.v[i] = rate * (next.q[i] - now.q[i]);
            mean.a[i] = next.a[i];
        }
        equations.prescribe(next);
        equations.load(&mut mean);
        next.work = now.work + h * mean.external.iter().zip(&mean.v).map(|(force, v)| force * v).sum::<f64>();
        next.dissipated = now.dissipated + h * mean.damping;
        (next.external, next.damping) = (mean.external, mean.damping);
        next.negative_pivots = Some(report.negative_pivots);
        Ok(())
    }
}
