//! The limit of stability, which explicit steps stay below.

use crate::dynamics::checkpoint::Memory;
use crate::dynamics::control::Steps;
use crate::dynamics::stability::highest_frequency;
use crate::nonlinear::Failure;
use crate::observe::Observer;

use super::Simulation;

/// Explicit steps after which the limit of stability is estimated again.
pub(super) const EVERY: usize = 20;
/// Share of the limit of stability that controlled explicit steps may take: stiffness changes between two estimates. Fixed
/// ones that are longer are compared with a precise estimate.
const STABLE: f64 = 0.9;
/// A limit that has risen by less than this factor is left as it is: steps that change at every estimate pump energy into what
/// oscillates fast.
const STEADY: f64 = 1.02;
/// Change of the squared highest frequency in an iteration at which it is found: for a fixed step that the limit may refuse,
/// and where the share above covers what is missing.
const PRECISE: f64 = 1e-6;
const ROUGH: f64 = 1e-2;

impl Simulation<'_> {
    /// The longest stable step of an explicit method in the present state.
    ///
    /// # Source
    ///
    /// Belytschko, Liu and Moran, Nonlinear Finite Elements for Continua and Structures (2000), (6.2.21) for damping.
    fn limit(&mut self, precision: f64) -> Option<f64> {
        let limit = self.integrator.explicit_limit()?;
        let omega = highest_frequency(&mut self.equations, self.now.t, &self.now.q, precision);
        let damping = self.equations.system.model().bodies().iter().map(|body| body.plate().material.damping());
        let ratio = damping.map(|d| 0.5 * (d.viscosity * omega + d.mass / omega)).fold(0.0, f64::max);
        Some(limit / omega * ((1.0 + ratio * ratio).sqrt() - ratio))
    }

    /// Refuses a fixed explicit step that is not stable in the present state, and holds controlled ones below the limit.
    ///
    /// Error control alone would not: it sees positions only, and where the tolerance is loose, what grows in the other
    /// coordinates has made the model another one before positions show it.
    pub(super) fn heed_limit(&mut self, observer: &mut dyn Observer) -> Result<(), Failure> {
        match self.options.steps {
            Steps::Fixed { force: true, .. } => {}
            Steps::Fixed { step, .. } => {
                if let Some(failure) = self.unstable(step) {
                    return Err(self.unstable_before(step, observer)?.unwrap_or(failure));
                }
                if self.integrator.explicit_limit().is_some() {
                    self.stable = Some((self.now.clone(), self.counts.steps));
                }
            }
            Steps::Controlled(_) => {
                let limit = self.limit(ROUGH).map_or(f64::INFINITY, |limit| STABLE * limit);
                if !(self.controller.limit..STEADY * self.controller.limit).contains(&limit) {
                    self.controller.limit = limit;
                }
            }
        }
        Ok(())
    }

    /// Why a fixed step cannot be made in the present state, if it is not stable.
    fn unstable(&mut self, step: f64) -> Option<Failure> {
        self.limit(ROUGH).filter(|limit| step > STABLE * limit)?;
        let limit = self.limit(PRECISE).filter(|limit| step > *limit)?;
        Some(Failure::StepAboveLimit { t: self.now.t, step, limit })
    }

    /// Finds, up to the present state, the first in which a fixed step was not stable, and goes back there: what comes after
    /// it grows from step to step, and has a limit of its own.
    pub(super) fn unstable_before(
        &mut self,
        step: f64,
        observer: &mut dyn Observer,
    ) -> Result<Option<Failure>, Failure> {
        let Some((state, steps)) = self.stable.take() else { return Ok(None) };
        let end = self.counts.steps;
        (self.now, self.counts.steps) = (state, steps);
        self.middles.begin(self.equations.system.model(), &self.now.q);
        let mut found = None;
        while found.is_none() && self.counts.steps < end {
            self.fixed_step(step, observer)?;
            std::mem::swap(&mut self.now, &mut self.next);
            self.middles.accept();
            self.counts.steps += 1;
            found = self.unstable(step);
        }
        self.accepted = (self.controller, Memory::of(&self.equations), self.counts());
        observer.withdraw(self.now.t);
        Ok(found)
    }
}
