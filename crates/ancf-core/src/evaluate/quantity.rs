//! What can be evaluated at a material point.

use std::str::FromStr;

use crate::error::InputError;

/// A surface through the thickness of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// The face that the normal `r_x x r_y` points to.
    Top,
    /// The middle surface.
    Middle,
    /// The other face.
    Bottom,
}

impl Layer {
    /// Its height above the middle surface, in units of half the thickness.
    pub(super) fn side(self) -> f64 {
        match self {
            Self::Top => 1.0,
            Self::Middle => 0.0,
            Self::Bottom => -1.0,
        }
    }
}

/// What can be evaluated at a material point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Position, m.
    Position,
    /// Displacement from the reference position, m.
    Displacement,
    /// Velocity, m/s.
    Velocity,
    /// Unit normal along `r_x x r_y`.
    Normal,
    /// Membrane strain `E_xx`, `E_yy`, `2 E_xy`: Dufva and Shabana (2005), (30), (31).
    MembraneStrain,
    /// Change of curvature `kappa_xx`, `kappa_yy`, `2 kappa_xy`, 1/m, positive towards the normal: Dufva and Shabana (2005), (32).
    Curvature,
    /// Membrane force per length `N = h D E`: `xx`, `yy`, `xy`, N/m.
    MembraneForce,
    /// Bending moment per length `M = h^3/12 D kappa`: `xx`, `yy`, `xy`, N m/m. It is minus the integral of `z` times the
    /// stress, `z` along the normal: a positive one presses the top.
    Moment,
    /// Transverse shear force per length, `xz`, `yz`, N/m, from the equilibrium of moments, `-div M`: what the part
    /// beyond a cut across x or y exerts along the normal.
    ShearForce,
    /// Second Piola-Kirchhoff stress `xx`, `yy`, `xy`, Pa.
    Stress(Layer),
    /// Cauchy stress `xx`, `yy`, `xy`, Pa, in the orthonormal frame of the deformed layer with x along its `r_x`.
    CauchyStress(Layer),
    /// The larger and the smaller principal value of the Cauchy stress in the layer, Pa.
    PrincipalStress(Layer),
    /// Von Mises' equivalent of the Cauchy stress, Pa.
    VonMises(Layer),
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Self; 21] = [
        Self::Position,
        Self::Displacement,
        Self::Velocity,
        Self::Normal,
        Self::MembraneStrain,
        Self::Curvature,
        Self::MembraneForce,
        Self::Moment,
        Self::ShearForce,
        Self::Stress(Layer::Top),
        Self::Stress(Layer::Middle),
        Self::Stress(Layer::Bottom),
        Self::CauchyStress(Layer::Top),
        Self::CauchyStress(Layer::Middle),
        Self::CauchyStress(Layer::Bottom),
        Self::PrincipalStress(Layer::Top),
        Self::PrincipalStress(Layer::Middle),
        Self::PrincipalStress(Layer::Bottom),
        Self::VonMises(Layer::Top),
        Self::VonMises(Layer::Middle),
        Self::VonMises(Layer::Bottom),
    ];

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Normal => "normal",
            Self::MembraneStrain => "membrane_strain",
            Self::Curvature => "curvature",
            Self::MembraneForce => "membrane_force",
            Self::Moment => "moment",
            Self::ShearForce => "shear_force",
            Self::Stress(Layer::Top) => "stress_top",
            Self::Stress(Layer::Middle) => "stress_middle",
            Self::Stress(Layer::Bottom) => "stress_bottom",
            Self::CauchyStress(Layer::Top) => "cauchy_stress_top",
            Self::CauchyStress(Layer::Middle) => "cauchy_stress_middle",
            Self::CauchyStress(Layer::Bottom) => "cauchy_stress_bottom",
            Self::PrincipalStress(Layer::Top) => "principal_stress_top",
            Self::PrincipalStress(Layer::Middle) => "principal_stress_middle",
            Self::PrincipalStress(Layer::Bottom) => "principal_stress_bottom",
            Self::VonMises(Layer::Top) => "von_mises_top",
            Self::VonMises(Layer::Middle) => "von_mises_middle",
            Self::VonMises(Layer::Bottom) => "von_mises_bottom",
        }
    }

    /// Whether it depends on the membrane strain that carries energy.
    pub(super) fn needs_membrane(self) -> bool {
        use Quantity::{CauchyStress, MembraneForce, PrincipalStress, Stress, VonMises};
        matches!(self, MembraneForce | Stress(_) | CauchyStress(_) | PrincipalStress(_) | VonMises(_))
    }

    /// How many components it has.
    pub fn components(self) -> usize {
        match self {
            Self::VonMises(_) => 1,
            Self::ShearForce | Self::PrincipalStress(_) => 2,
            _ => 3,
        }
    }
}

impl FromStr for Quantity {
    type Err = InputError;

    fn from_str(name: &str) -> Result<Self, InputError> {
        Self::ALL
            .into_iter()
            .find(|quantity| quantity.name() == name)
            .ok_or_else(|| InputError::new("quantity", format!("\"{name}\""), Self::ALL.map(Self::name).join(", ")))
    }
}
