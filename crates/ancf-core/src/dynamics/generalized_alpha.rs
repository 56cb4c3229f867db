//! Generalised-alpha and, as members of the family, HHT-alpha and Newmark's trapezoidal rule.

use crate::nonlinear::Failure;
use crate::observe::Observer;

use super::equations::Equations;
use super::method::Integrator;
use super::stage::Stage;
use super::state::Instantaneous;

/// The generalised-alpha family. The *forces* at both ends of a step are averaged, not the configurations:
///
/// `M ((1 - alpha_m) a_1 + alpha_m a_0) + (1 - alpha_f) F_1 + alpha_f F_0 = 0`, `F = Q_k + damping - Q_e`,
///
/// with Newmark's formulas for positions and velocities. Second order, unconditionally stable for linear problems.
///
/// # Source
///
/// Chung and Hulbert (1993); Hilber, Hughes and Taylor (1977); Newmark (1959).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GeneralizedAlpha {
    alpha_m: f64,
    alpha_f: f64,
    beta: f64,
    gamma: f64,
}

impl GeneralizedAlpha {
    /// Generalised-alpha with the spectral radius `rho_inf` at infinite frequency.
    pub fn from_spectral_radius(rho_inf: f64) -> Self {
        Self::new((2.0 * rho_inf - 1.0) / (rho_inf + 1.0), rho_inf / (rho_inf + 1.0))
    }

    /// HHT-alpha; `alpha` = 0 is Newmark's trapezoidal rule.
    pub fn hht(alpha: f64) -> Self {
        Self::new(0.0, -alpha)
    }

    /// The member that is second order and damps as the two averages say.
    fn new(alpha_m: f64, alpha_f: f64) -> Self {
        let shift = alpha_f - alpha_m;
        Self { alpha_m, alpha_f, beta: 0.25 * (1.0 + shift).powi(2), gamma: 0.5 + shift }
    }
}

impl Integrator for GeneralizedAlpha {
    fn order(&self) -> usize {
        2
    }

    /// The accelerations are those of a time `(alpha_f - alpha_m) h` earlier (Chung and Hulbert 1993), so their change
    /// over a step is the third derivative times `h`. What Newmark's formula misses of it is the error.
    fn step(
        &self,
        equations: &mut Equations<'_>,
        now: &Instantaneous,
        next: &mut Instantaneous,
        error: &mut [f64],
        observer: &dyn Observer,
    ) -> Result<(), Failure> {
        let Self { alpha_m, alpha_f, beta, gamma } = *self;
        let h = next.t - now.t;
        let n = now.q.len();

        let mut constant = vec![0.0; n];
        if alpha_f != 0.0 {
            equations.force(now.t, &now.q, &now.v, &mut constant, &mut next.external);
            for force in &mut constant {
                *force *= alpha_f;
            }
        }
        if alpha_m != 0.0 {
            let inertia: Vec<f64> = now.a.iter().map(|a| alpha_m * a).collect();
            equations.inertia.add_product(&inertia, &mut constant);
        }
        next.lag = (alpha_f - alpha_m) * h;
        equations.prescribe(next);
        // Newmark's formulas without the acceleration at the end.
        let stage = Stage {
            position: (0..n).map(|i| now.q[i] + h * now.v[i] + h * h * (0.5 - beta) * now.a[i]).collect(),
            velocity: (0..n).map(|i| now.v[i] + h * (1.0 - gamma) * now.a[i]).collect(),
            length: h * beta.sqrt(),
            slope: gamma / beta.sqrt(),
            inertia: 1.0 - alpha_m,
            forces: 1.0 - alpha_f,
            constant: Some(constant),
            start: None,
        };
        stage.solve(equations, next, &now.a, &now.q, observer)?;

        let missing = h * h * (1.0 / 6.0 - beta + 0.5 * (alpha_f - alpha_m));
        for i in 0..n {
            error[i] = missing * (next.a[i] - now.a[i]);
        }
        equations.load(next);
        next.accumulate(now);
        Ok(())
    }
}
