//! TR-BDF2: a trapezoidal stage, then the second backward difference formula.

use std::f64::consts::SQRT_2;

use super::runge_kutta::Tableau;

const W: f64 = SQRT_2 / 4.0;
/// Both implicit stages have the same tangent.
const D: f64 = 1.0 - SQRT_2 / 2.0;

/// Second order, L-stable, with an embedded solution of third order: what MATLAB's `ode23tb` is.
///
/// # Source
///
/// Bank et al. (1985); Hosea and Shampine (1996).
pub(super) const TR_BDF2: Tableau = Tableau {
    order: 2,
    embedded_order: 3,
    a: &[&[], &[D, D], &[W, W, D]],
    embedded: &[(1.0 - W) / 3.0, (3.0 * W + 1.0) / 3.0, D / 3.0],
};
