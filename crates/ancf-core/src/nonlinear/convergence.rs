//! When an iteration has converged, and when it never will.

use super::Failure;

/// A correction this many times the size of the model cannot lead anywhere.
const ABSURD: f64 = 1e3;
/// Nor can one that is larger than the model and this many times any before.
const LEAP: f64 = 5.0;
/// Corrections below this that no longer shrink are rounding.
const ROUNDING: f64 = 1e-6;
/// Iterations without progress after which there will be none: at the level of rounding, and above it.
const SETTLED: usize = 4;
const HOPELESS: usize = 6;
/// The energy of a correction, relative to the first one, that goes with convergence.
const ENERGY: f64 = 1e-6;
/// A kept factorisation must shrink the corrections by one factor, and may not let them grow by the other.
const CONTRACTION: f64 = 0.2;
const DIVERGENCE: f64 = 2.0;

/// The corrections of an iteration so far. Their sizes are relative to that of the model.
pub(super) struct Convergence {
    tolerance: f64,
    /// The last size.
    pub size: f64,
    /// Largest ratio of a size, if it is above rounding, to the one before.
    pub growth: f64,
    smallest: f64,
    largest: f64,
    stalled: usize,
    small: bool,
    first_energy: Option<f64>,
}

impl Convergence {
    pub fn new(tolerance: f64) -> Self {
        let size = f64::INFINITY;
        Self {
            tolerance,
            size,
            growth: 0.0,
            smallest: size,
            largest: size,
            stalled: 0,
            small: false,
            first_energy: None,
        }
    }

    /// Whether a correction of this size, by an old factorisation, may lead to the solution.
    pub fn leads_on(&self, size: f64) -> bool {
        size <= DIVERGENCE * self.size
    }

    /// Whether a factorisation that gives a correction of this size is worth keeping.
    pub fn contracts(&self, size: f64) -> bool {
        size <= CONTRACTION * self.size
    }

    /// The iteration goes back to its start.
    pub fn restart(&mut self) {
        self.size = f64::INFINITY;
    }

    /// Takes the size of a correction and its energy, and says whether it is the last one.
    ///
    /// # Errors
    ///
    /// There is no hope of a solution.
    pub fn take(&mut self, iteration: usize, size: f64, energy: f64) -> Result<bool, Failure> {
        if !size.is_finite() {
            return Err(Failure::NotFinite { iteration });
        }
        let leaps = size > LEAP * self.largest.max(1.0 / LEAP);
        if size > ABSURD || leaps {
            return Err(Failure::Diverged { iteration, correction: size });
        }
        if size > ROUNDING {
            self.growth = self.growth.max(size / self.size);
        }
        self.size = size;
        self.largest = if iteration == 1 { size } else { self.largest.max(size) };
        let energy = energy.abs();
        let first_energy = *self.first_energy.get_or_insert(energy);
        // Where the start is almost the solution the first energy is rounding; then two small corrections settle it.
        let settled = energy <= ENERGY * first_energy || self.small;
        self.small = size <= self.tolerance;
        if self.small && settled {
            return Ok(true);
        }
        self.stalled = if size < 0.5 * self.smallest { 0 } else { self.stalled + 1 };
        self.smallest = self.smallest.min(size);
        if self.smallest < ROUNDING && self.stalled >= SETTLED {
            return Err(Failure::BelowRounding { floor: self.smallest, tolerance: self.tolerance });
        }
        if self.stalled >= HOPELESS {
            return Err(Failure::NotConverged { iterations: iteration, correction: size });
        }
        Ok(false)
    }
}
