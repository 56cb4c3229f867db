//! Steps whose length an estimate of their error sets.

use super::Simulation;
use crate::dynamics::control::Tolerances;
use crate::nonlinear::Failure;
use crate::observe::Observer;

/// Steps without a solution in a short part of the duration, after which the motion is stuck: where an element collapses
/// short steps find solutions, which lead nowhere.
const MOST_UNSOLVED: usize = 40;
const SHORT: f64 = 1e-3;

impl Simulation<'_> {
    /// The next kink, if any.
    pub(super) fn next_kink(&self) -> Option<f64> {
        let after = self.now.t + self.rounding();
        self.kinks.get(self.kinks.partition_point(|kink| *kink <= after)).copied()
    }

    /// A step within the tolerances that does not go beyond `target`.
    ///
    /// A step may add as much of the allowed error as its share of the duration, so that together they add no more.
    pub(super) fn controlled_step(
        &mut self,
        tolerances: Tolerances,
        target: f64,
        observer: &dyn Observer,
    ) -> Result<(), Failure> {
        let power = self.integrator.error_order() as f64;
        let limit = self.controller.limit;
        let unstable = Failure::StepAboveLimit { t: self.now.t, step: tolerances.min_step, limit };
        let mut cause = (tolerances.min_step > limit).then(|| Box::new(unstable));
        loop {
            let left = target - self.now.t;
            let step = self.controller.step.min(tolerances.max_step).min(limit);
            let h = if step > 0.999 * left {
                left
            } else if limit.is_finite() {
                // Equal steps: near the limit of an explicit method what oscillates fast may grow with each change of
                // their length, which at outputs comes at regular times.
                left / (left / step - 0.001).ceil()
            } else {
                // Two equal steps rather than one and a tiny rest.
                step.min(0.5 * left).max(step.min(left - step))
            };
            self.next.t = if h == left { target } else { self.now.t + h };
            // Only what ends at an output may be shorter than the shortest.
            if step < tolerances.min_step.min(left) || self.next.t <= self.now.t {
                return Err(Failure::StepTooSmall { t: self.now.t, step, cause });
            }
            match self.try_step(observer) {
                Ok(()) => {
                    let error = self.relative_error() * self.options.until / h;
                    if error <= 1.0 {
                        self.controller.accept(h, error, power);
                        return Ok(());
                    }
                    if error.is_finite() {
                        self.controller.reject(h, error, power);
                        self.counts.rejected.inaccurate += 1;
                    } else {
                        self.controller.cut(h);
                        self.counts.rejected.not_finite += 1;
                    }
                    cause = None;
                }
                Err(failure @ (Failure::Stopped | Failure::TooLarge)) => return Err(failure),
                Err(failure) => {
                    self.controller.cut(h);
                    self.counts.rejected.count(&failure);
                    cause = Some(Box::new(failure));
                    let (since, unsolved) = self.unsolved;
                    let near = self.now.t - since <= SHORT * self.options.until;
                    self.unsolved = if near { (since, unsolved + 1) } else { (self.now.t, 1) };
                    if self.unsolved.1 > MOST_UNSOLVED {
                        return Err(Failure::StepTooSmall { t: self.now.t, step: self.controller.step, cause });
                    }
                }
            }
        }
    }

    /// The largest error of a position, relative to what is allowed in all.
    fn relative_error(&self) -> f64 {
        let errors = self.allowed.iter().map(|&(i, allowed)| self.error[i].abs() / allowed);
        // Not f64::max, which would drop a NaN.
        errors.fold(0.0, |worst, error| if error > worst || error.is_nan() { error } else { worst })
    }

    /// A first step in which velocities and accelerations at the start move positions by little.
    pub(super) fn first_step(&mut self, tolerances: Tolerances) -> f64 {
        let power = 1.0 / (self.integrator.error_order() as f64 + 1.0);
        let share = 0.1 * tolerances.rtol.powf(power) / tolerances.rtol;
        let mut step = self.options.until;
        for &(i, allowed) in &self.allowed {
            let distance = share * allowed;
            step = step.min(distance / self.now.v[i].abs()).min((2.0 * distance / self.now.a[i].abs()).sqrt());
        }
        step
    }
}
