//! Generalised-alpha and, as members of the family, HHT-alpha and Newmark's trapezoidal rule.

use crate::assembly::System;
use crate::error::InputError;
use crate::nonlinear::{Failure, Newton, Problem};
use crate::observe::Observer;

use super::Instantaneous;

/// The generalised-alpha family. The *forces* at both ends of a step are averaged, not the configurations:
///
/// `M ((1 - alpha_m) a_1 + alpha_m a_0) + (1 - alpha_f) F_1 + alpha_f F_0 = 0`, `F = Q_k - Q_e`,
///
/// with Newmark's formulas for positions and velocities. Second order, unconditionally stable for linear problems.
///
/// # Source
///
/// Chung and Hulbert (1993); Hilber, Hughes and Taylor (1977); Newmark (1959).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralizedAlpha {
    alpha_m: f64,
    alpha_f: f64,
    beta: f64,
    gamma: f64,
}

impl GeneralizedAlpha {
    /// Generalised-alpha with the spectral radius `rho_inf` at infinite frequency: 1 keeps the energy of high
    /// frequencies, 0 removes it within a step.
    ///
    /// # Errors
    ///
    /// `rho_inf` must be from 0 to 1.
    pub fn from_spectral_radius(rho_inf: f64) -> Result<Self, InputError> {
        InputError::check("rho_inf", rho_inf, (0.0..=1.0).contains(&rho_inf), "from 0 to 1")?;
        Ok(Self::new((2.0 * rho_inf - 1.0) / (rho_inf + 1.0), rho_inf / (rho_inf + 1.0)))
    }

    /// HHT-alpha; `alpha` = 0 is Newmark's trapezoidal rule, -1/3 damps high frequencies most.
    ///
    /// # Errors
    ///
    /// `alpha` must be from -1/3 to 0.
    pub fn hht(alpha: f64) -> Result<Self, InputError> {
        InputError::check("alpha", alpha, (-1.0 / 3.0..=0.0).contains(&alpha), "from -1/3 to 0")?;
        Ok(Self::new(0.0, -alpha))
    }

    /// The member that is second order and damps as the two averages say.
    fn new(alpha_m: f64, alpha_f: f64) -> Self {
        let shift = alpha_f - alpha_m;
        Self { alpha_m, alpha_f, beta: 0.25 * (1.0 + shift).powi(2), gamma: 0.5 + shift }
    }

    /// Advances from `now` to `next.t`.
    pub(super) fn step(
        &self,
        system: &mut System,
        newton: &mut Newton,
        now: &Instantaneous,
        next: &mut Instantaneous,
        observer: &dyn Observer,
    ) -> Result<(), Failure> {
        let Self { alpha_m, alpha_f, beta, gamma } = *self;
        let h = next.t - now.t;
        let n = now.q.len();

        // Newmark's position for zero acceleration at the end, and the prediction for an unchanged acceleration.
        let origin: Vec<f64> = (0..n).map(|i| now.q[i] + h * now.v[i] + h * h * (0.5 - beta) * now.a[i]).collect();
        let mut constant = vec![0.0; n];
        if alpha_f != 0.0 {
            system.internal_force(&now.q, &mut constant);
            for i in 0..n {
                constant[i] = alpha_f * (constant[i] - now.external[i]);
            }
        }
        if alpha_m != 0.0 {
            let inertia: Vec<f64> = now.a.iter().map(|a| alpha_m * a).collect();
            system.add_mass_times(&inertia, &mut constant);
        }
        for i in 0..n {
            next.q[i] = origin[i] + h * h * beta * now.a[i];
        }
        let mass = (1.0 - alpha_m) / (beta * h * h);
        let problem = Problem { t: next.t, mass, stiffness: 1.0 - alpha_f, origin: &origin, constant: &constant };
        let report = newton.solve(system, &problem, &mut next.q, Some(&now.q), observer)?;

        for i in 0..n {
            next.a[i] = (next.q[i] - origin[i]) / (beta * h * h);
            next.v[i] = now.v[i] + h * ((1.0 - gamma) * now.a[i] + gamma * next.a[i]);
        }
        next.negative_pivots = Some(report.negative_pivots);
        Ok(())
    }
}
