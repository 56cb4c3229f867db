//! The one nonlinear problem behind statics and every implicit integrator:
//! `c M (q - q*) + k (Q_k(q) - Q_e(t, q)) + p = 0`.

mod collapse;
mod convergence;
mod failure;
mod forces;
mod newton;
mod options;
mod reuse;
mod scale;

pub(crate) use collapse::Middles;
pub use failure::Failure;
pub use newton::{Newton, Report};
pub use options::{Options, Variant};
pub(crate) use reuse::{Kept, Reuse, Trial};

/// The coefficients of the problem.
#[derive(Clone, Copy, Debug, Default)]
pub struct Problem<'a> {
    /// Time, or the load factor in statics.
    pub t: f64,
    /// Factor `c` of the inertia force.
    pub mass: f64,
    /// Factor `k` of the elastic force, the damping and the loads.
    pub stiffness: f64,
    /// Coordinates `q*` at which the inertia force vanishes; of no matter without inertia.
    pub origin: &'a [f64],
    /// Constant force `p`, none: zero.
    pub constant: Option<&'a [f64]>,
    /// The velocities that damping acts on, none: without damping.
    pub velocity: Option<Velocity<'a>>,
    /// Coordinates at the start of a step, if forces are to be means over it that neither gain nor lose energy.
    ///
    /// The mean force is `B^T W (mean(eps) - eps_0)` with `B` at the mean coordinates; for strains that are quadratic
    /// in the coordinates its work is the change of energy. For the others a viscous stress is added whose coefficient,
    /// one for the whole model and of either sign, makes up the difference. It leaves momenta alone, as every stress
    /// does. The discrete gradient is so taken in the strains, in the norm of `W`, and not in the coordinates.
    ///
    /// # Source
    ///
    /// Simo and Tarnow (1994); Gonzalez (1996), discrete gradients; Laursen and Meng (2001), the correction of the stress.
    pub start: Option<&'a [f64]>,
    /// Whether the iteration begins at a stable equilibrium, so that the stiffness should stay positive.
    pub stable: bool,
}

impl Problem<'_> {
    /// What the tangent depends on beside the state: the factors of inertia and stiffness, and the rate of the velocities.
    fn coefficients(&self) -> [f64; 3] {
        [self.mass, self.stiffness, self.velocity.map_or(0.0, |velocity| velocity.rate)]
    }
}

/// Velocities as a function of the coordinates: `v = at_origin + rate (q - q*)`.
#[derive(Clone, Copy, Debug)]
pub struct Velocity<'a> {
    /// Derivative of the velocities, 1/s.
    pub rate: f64,
    /// Velocities where the inertia force vanishes.
    pub at_origin: &'a [f64],
}
