//! The energy-momentum method: what a conservative system keeps, it keeps at any step.

use std::f64::consts::FRAC_1_SQRT_2;

use crate::linear::dot;
use crate::nonlinear::Failure;
use crate::observe::Observer;

use super::equations::Equations;
use super::method::Integrator;
use super::stage::Stage;
use super::state::Instantaneous;

/// `M (v_1 - v_0) / h + mean force = 0`, `q_1 - q_0 = h (v_0 + v_1) / 2`, with the mean elastic force of
/// [`Problem::start`](crate::nonlinear::Problem::start), whose work over the step is the change of strain energy. Second order; energy, momentum and
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
        next.lag = 0.5 * h;
        equations.prescribe(next);
        // Velocities and accelerations are means over the step, positions those at its end.
        let mut mean = Instantaneous { t: now.t + 0.5 * h, ..next.clone() };
        for i in equations.moved() {
            mean.v[i] = (next.q[i] - now.q[i]) / h;
            mean.a[i] = (next.v[i] - now.v[i]) / h;
        }
        let stage = Stage {
            position: (0..n).map(|i| now.q[i] + h * now.v[i]).collect(),
            velocity: now.v.clone(),
            length: h * FRAC_1_SQRT_2,
            slope: FRAC_1_SQRT_2,
            inertia: 1.0,
            forces: 1.0,
            constant: None,
            start: Some(&now.q),
        };
        stage.solve(equations, &mut mean, &now.a, &now.q, observer)?;

        let distance = 0.5 * h + now.lag;
        for i in 0..n {
            error[i] = h * h * h / 12.0 * (mean.a[i] - now.a[i]) / distance;
            next.v[i] = now.v[i] + h * mean.a[i];
        }
        next.q.copy_from_slice(&mean.q);
        next.a.copy_from_slice(&mean.a);
        equations.prescribe(next);
        equations.load_mean(&mut mean, &now.q);
        next.work = now.work + h * dot(&mean.external, &mean.v);
        next.dissipated = now.dissipated + h * mean.damping;
        (next.external, next.damping) = (mean.external, mean.damping);
        next.negative_pivots = mean.negative_pivots;
        Ok(())
    }
}
