//! The one nonlinear problem behind statics and every implicit integrator:
//! `c M (q - q*) + k (Q_k(q) - Q_e(t, q)) + p = 0`.

mod failure;
mod newton;

pub use failure::Failure;
pub use newton::{Newton, Options, Report, Variant};

/// The coefficients of the problem.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// Time, or the load factor in statics.
    pub t: f64,
    /// Factor `c` of the inertia force.
    pub mass: f64,
    /// Factor `k` of the elastic force and the loads.
    pub stiffness: f64,
    /// Coordinates `q*` at which the inertia force vanishes.
    pub origin: &'a [f64],
    /// Constant force `p`.
    pub constant: &'a [f64],
}
