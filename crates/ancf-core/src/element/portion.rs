//! The state at which elements are evaluated, and what they give there.

/// The state at which elements are evaluated.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// Nodal coordinates.
    pub q: &'a [f64],
    /// Nodal coordinates at the start of a step, if mean forces over the step are wanted: the stress of the mean
    /// strain, on the directions `B` at the mean coordinates.
    ///
    /// # Source
    ///
    /// Simo and Tarnow (1994).
    pub start: Option<&'a [f64]>,
    /// Velocities, none: elastic forces only.
    pub motion: Option<Motion<'a>>,
}

impl<'a> At<'a> {
    /// At rest.
    pub fn rest(q: &'a [f64]) -> Self {
        Self { q, start: None, motion: None }
    }
}

/// Velocities, which damping acts on: the viscous stress is `(eta + viscosity) W B v`.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Velocities `v` of the nodal coordinates.
    pub velocity: &'a [f64],
    /// Derivative of the velocities with respect to the nodal coordinates in the time step, 1/s; for mean forces the
    /// inverse of the step.
    pub rate: f64,
    /// Viscosity in addition to the material's `eta`, s.
    pub viscosity: f64,
}

/// Which combination of mass and stiffness a tangent is, and how the stiffness is made.
#[derive(Clone, Copy, Debug)]
pub struct Want<'a> {
    /// Factor of the mass matrix.
    pub mass: f64,
    /// Factor of the stiffness.
    pub stiffness: f64,
    /// Coordinates before the last Newton correction, if the geometric stiffness is to use the stress extrapolated
    /// from there (mixed-integration-point Newton).
    pub previous: Option<&'a [f64]>,
}

/// Energies, forces and tangents of a few elements, one after the other.
pub struct Portion<'a> {
    /// The numbers of the elements in their body.
    pub elements: &'a [u32],
    /// Membrane and bending energy of each element.
    pub energy: &'a [[f64; 2]],
    /// Strain rates of each element as two numbers: `B v . W B v`, which times the viscosity is the power it takes, and
    /// for mean forces `s . (eps - eps_start - B (q - q_start))`, the energy that they miss. Zero without viscous stress.
    pub rates: &'a [[f64; 2]],
    /// Elastic and viscous force on the nodal vectors of each element: `3 N` numbers an element.
    pub force: &'a [f64],
    /// Tangent of each element, in the order of [`tangent_place`](super::tangent_place); empty unless it is wanted.
    pub tangent: &'a mut [f64],
}
