//! The registry of methods: what each is called and what it can do.

use crate::error::InputError;
use crate::nonlinear::Failure;
use crate::observe::Observer;

use super::dormand_prince::DORMAND_PRINCE;
use super::energy_momentum::EnergyMomentum;
use super::equations::Equations;
use super::esdirk::ESDIRK;
use super::generalized_alpha::GeneralizedAlpha;
use super::rigid::Rigid;
use super::state::Instantaneous;
use super::tr_bdf2::TR_BDF2;
use super::verlet::Verlet;

/// A method of time integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// HHT-alpha: second order; high frequencies are damped.
    Hht {
        /// From -1/3, most damping, to 0, none.
        alpha: f64,
    },
    /// Generalised-alpha: second order; high frequencies are damped as wanted, low ones less than by HHT.
    GeneralizedAlpha {
        /// Spectral radius at infinite frequency, from 0, which removes it within a step, to 1, no damping.
        rho_inf: f64,
    },
    /// Newmark's trapezoidal rule: second order, without damping; fails on stiff problems.
    Newmark,
    /// Trapezoidal rule and second backward difference: second order, L-stable.
    TrBdf2,
    /// Diagonally implicit Runge-Kutta: fourth order, L-stable, accurate at large steps.
    Esdirk,
    /// Keeps energy, momentum and angular momentum at any step: second order.
    EnergyMomentum,
    /// Stormer-Verlet: explicit, second order, cheapest where the waves are slow.
    Verlet {
        /// Whether to use the lumped mass matrix.
        lumped: bool,
    },
    /// Dormand and Prince's Runge-Kutta pair: explicit, fifth order, for references.
    Rk,
    /// No body deforms: six motions each, by the pair of `Rk`.
    Rigid,
}

impl Method {
    /// All methods for flexible bodies, each with its usual parameters.
    pub const ALL: [Self; 8] = [
        Self::Hht { alpha: -0.05 },
        Self::GeneralizedAlpha { rho_inf: 0.9 },
        Self::Newmark,
        Self::TrBdf2,
        Self::Esdirk,
        Self::EnergyMomentum,
        Self::Verlet { lumped: false },
        Self::Rk,
    ];

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hht { .. } => "hht",
            Self::GeneralizedAlpha { .. } => "generalized_alpha",
            Self::Newmark => "newmark",
            Self::TrBdf2 => "tr_bdf2",
            Self::Esdirk => "esdirk",
            Self::EnergyMomentum => "energy_momentum",
            Self::Verlet { .. } => "verlet",
            Self::Rk => "rk",
            Self::Rigid => "rigid",
        }
    }

    /// The method of a name, with its usual parameters.
    ///
    /// # Errors
    ///
    /// There must be one of that name.
    pub fn find(name: &str) -> Result<Self, InputError> {
        let methods = [&Self::ALL[..], &[Self::Rigid]].concat();
        let names: Vec<_> = methods.iter().map(|method| method.name()).collect();
        let found = methods.iter().find(|method| method.name() == name);
        found.copied().ok_or_else(|| InputError::new("method", format!("\"{name}\""), names.join(", ")))
    }

    /// The order of convergence.
    pub fn order(self) -> usize {
        self.integrator().order()
    }

    /// Whether equations are solved in every step; otherwise steps are limited by the highest frequency.
    pub fn is_implicit(self) -> bool {
        self.integrator().explicit_limit().is_none()
    }

    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// `alpha` must be from -1/3 to 0, `rho_inf` from 0 to 1.
    pub fn validate(self) -> Result<(), InputError> {
        match self {
            Self::Hht { alpha } => {
                InputError::check("alpha", alpha, (-1.0 / 3.0..=0.0).contains(&alpha), "from -1/3 to 0")
            }
            Self::GeneralizedAlpha { rho_inf } => {
                InputError::check("rho_inf", rho_inf, (0.0..=1.0).contains(&rho_inf), "from 0 to 1")
            }
            _ => Ok(()),
        }
    }

    pub(super) fn integrator(self) -> Box<dyn Integrator> {
        match self {
            Self::Hht { alpha } => Box::new(GeneralizedAlpha::hht(alpha)),
            Self::GeneralizedAlpha { rho_inf } => Box::new(GeneralizedAlpha::from_spectral_radius(rho_inf)),
            Self::Newmark => Box::new(GeneralizedAlpha::hht(0.0)),
            Self::TrBdf2 => Box::new(TR_BDF2),
            Self::Esdirk => Box::new(ESDIRK),
            Self::EnergyMomentum => Box::new(EnergyMomentum),
            Self::Verlet { .. } => Box::new(Verlet),
            Self::Rk => Box::new(DORMAND_PRINCE),
            Self::Rigid => Box::new(Rigid),
        }
    }
}

/// A one-step integrator.
pub(super) trait Integrator {
    /// The order of convergence.
    fn order(&self) -> usize;

    /// The order to which the error is known: its estimate over a step of length `h` shrinks as `h` to this plus one.
    fn error_order(&self) -> usize {
        self.order()
    }

    /// For explicit methods the largest stable step times the highest frequency (rad/s).
    fn explicit_limit(&self) -> Option<f64> {
        None
    }

    /// Finds the accelerations of the state at the start, whose positions and velocities are known.
    ///
    /// # Errors
    ///
    /// The forces must be finite.
    fn begin(&self, equations: &mut Equations<'_>, at: &mut Instantaneous) -> Result<(), Failure> {
        equations.accelerate(at)
    }

    /// Advances from `now` to the time of `next` and fills all the rest of `next`, and an estimate of what the step adds
    /// to the error of each nodal coordinate.
    ///
    /// # Errors
    ///
    /// When the step could not be made; `next` is then of no use.
    fn step(
        &self,
        equations: &mut Equations<'_>,
        now: &Instantaneous,
        next: &mut Instantaneous,
        error: &mut [f64],
        observer: &dyn Observer,
    ) -> Result<(), Failure>;
}
