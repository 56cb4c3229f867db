//! An implicit stage of a step as the one nonlinear problem.

use crate::nonlinear::{Failure, Problem, Velocity};
use crate::observe::Observer;

use super::equations::Equations;
use super::state::Instantaneous;

/// Positions and velocities that are linear in accelerations which the equations of motion determine:
///
/// `q = position + length^2 a`, `v = velocity + length slope a`, and `inertia M a + forces F(t, q, v) + constant = 0`.
#[derive(Debug)]
pub(super) struct Stage<'a> {
    /// Positions without acceleration.
    pub position: Vec<f64>,
    /// Velocities without acceleration.
    pub velocity: Vec<f64>,
    /// Square root of the derivative of positions with respect to accelerations, s.
    pub length: f64,
    /// Derivative of velocities with respect to accelerations, divided by `length`.
    pub slope: f64,
    /// Share of the inertia force at the end of the stage.
    pub inertia: f64,
    /// Share of the other forces at the end of the stage.
    pub forces: f64,
    /// The rest of the forces, none: zero.
    pub constant: Option<Vec<f64>>,
    /// Whether forces are means between this state and the end of the stage, see [`Problem::start`].
    pub start: Option<&'a [f64]>,
}

impl Stage<'_> {
    /// Finds positions, velocities and accelerations at the time of `at`, beginning with the accelerations `guess`; those
    /// of moved supports are in `at` already. The stress is extrapolated from `last`.
    ///
    /// Accelerations come from what Newton's method adds up, not from the difference of rounded positions: momentum is
    /// kept to rounding however far a body has moved.
    ///
    /// # Errors
    ///
    /// Those of Newton's method.
    pub fn solve(
        mut self,
        equations: &mut Equations<'_>,
        at: &mut Instantaneous,
        guess: &[f64],
        last: &[f64],
        observer: &dyn Observer,
    ) -> Result<(), Failure> {
        let (by_position, by_velocity) = (self.length * self.length, self.length * self.slope);
        let held: Vec<_> = equations.moved().map(|i| (i, [at.q[i], at.v[i], at.a[i]])).collect();
        for (i, guess) in guess.iter().enumerate() {
            at.q[i] = self.position[i] + by_position * guess;
        }
        for &(i, [q, v, a]) in &held {
            at.q[i] = q;
            self.position[i] = q - by_position * a;
            self.velocity[i] = v - by_velocity * a;
        }
        let viscous = equations.system.is_damped() || self.start.is_some();
        let problem = Problem {
            t: at.t,
            mass: self.inertia / by_position,
            stiffness: self.forces,
            origin: &self.position,
            constant: self.constant.as_deref(),
            velocity: viscous.then_some(Velocity { rate: self.slope / self.length, at_origin: &self.velocity }),
            start: self.start,
            stable: false,
        };
        let report = equations.newton.solve(equations.system, &problem, &mut at.q, Some(last), observer)?;
        for (i, moved) in equations.newton.distance_from_origin().iter().enumerate() {
            at.a[i] = moved / by_position;
            at.v[i] = self.velocity[i] + by_velocity * at.a[i];
        }
        for (i, state) in held {
            [at.q[i], at.v[i], at.a[i]] = state;
        }
        at.negative_pivots = Some(report.negative_pivots);
        Ok(())
    }
}
