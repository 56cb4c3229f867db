//! A motion to rest: from a state that is not in equilibrium down the potential energy to a stable equilibrium.
//!
//! The motion `c M dq/dtau = Q_e - Q_k` is overdamped, in implicit steps whose length grows until inertia has no part any
//! more. Only its end matters: a step must go down, but need not be exact.

use std::sync::Arc;

use crate::assembly::System;
use crate::nonlinear::{Failure, Newton, Options as NewtonOptions, Problem};
use crate::observe::Observer;

use super::load::ROUNDING;
use super::path::{Load, Path, Point, difference, product};

/// Density, kg/m3, that lets a body without mass move and weighs nothing.
const WEIGHTLESS: f64 = 1e-12;
/// Factor of the inertia in a motion: by how much it changes after a step that succeeds, the same once one has failed, and
/// after one that fails; relative to that of free vibration the least at which it may be left out and the largest that is
/// tried. Motions that come to rest have needed up to 4e5; where an element collapses no step is short enough.
const LONGER: [f64; 2] = [0.25, 0.8];
const SHORTER: f64 = 6.0;
const LIGHTEST: f64 = 1e-3;
const HEAVIEST: f64 = 1e7;
/// Iterations in a step after which the next one may be longer.
const QUICK: usize = 4;
/// Largest change of a coordinate in such a step, relative to the size of the model.
const LONGEST: f64 = 0.3;
/// A motion that moves less in a step, relative to the size of the model, and less than this share of the step before,
/// has almost come to rest.
const AT_REST: f64 = 0.05;
const CALMER: f64 = 0.5;
/// A step that moves less, relative to the size of the model, changes nothing but rounding: the motion is stuck.
const STUCK: f64 = 1e-12;
/// Accuracy of a step.
const TOLERANCE: f64 = 1e-3;
/// Iterations after which a step has failed.
const ITERATIONS: usize = 8;

/// Where a motion begins, and what it needs to find its time scale.
pub(super) struct Start<'a> {
    /// Load factor.
    pub t: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// A displacement like the one to come.
    pub shape: &'a [f64],
    /// Its product with the stiffness and itself, J.
    pub stiffness: f64,
}

/// Moves until it comes to rest in a stable equilibrium, in about so many iterations.
///
/// A step minimises the potential energy with a penalty on its length. The longest that goes down is sought, and one that is
/// short enough always does: from where the stiffness is not positive the motion leads away.
///
/// # Errors
///
/// The motion does not come to rest.
pub(super) fn settle(
    path: &mut Path<'_>,
    Start { t, mut q, shape, stiffness }: Start<'_>,
    most: usize,
    observer: &dyn Observer,
) -> Result<Point, Failure> {
    let model = path.system.model().with_density_where_none(WEIGHTLESS);
    let mut damped = System::new(Arc::new(model)).map_err(|e| Failure::from_linear(e, 0, |_| String::new()))?;
    let options = NewtonOptions { tolerance: TOLERANCE, max_iterations: ITERATIONS, ..NewtonOptions::default() };
    let mut newton = Newton::new(&damped, options);

    let mut force = vec![0.0; q.len()];
    let mut energy = damped.internal_force(&q, &mut force).total();
    force.fill(0.0);
    damped.add_mass_times(shape, &mut force);
    // Rayleigh's quotient.
    let scale = stiffness / product(shape, &force);
    // Along `shape` the first step is not too long.
    let mut mass = scale * (newton.distance(&vec![0.0; q.len()], shape) / LONGEST).max(1.0);
    let mut longer = LONGER[0];
    let mut last = f64::INFINITY;
    let (mut end, mut cause, mut stuck) = (None, None, false);
    while newton.iterations() < most {
        let mut next = q.clone();
        let problem = Problem { t, mass, stiffness: 1.0, origin: &q, ..Problem::default() };
        let report = match newton.solve(&mut damped, &problem, &mut next, None, observer) {
            Err(failure @ (Failure::Stopped | Failure::TooLarge)) => return Err(failure),
            Err(failure) => {
                cause = Some(failure);
                None
            }
            Ok(report) => Some(report),
        };
        let (moved, step) = (newton.distance(&q, &next), difference(&next, &q));
        let mut valid = report.filter(|report| report.negative_pivots == 0 && moved <= LONGEST);
        if let (Some(_), Err(failure)) = (valid, path.check_collapse(&q, &next, t)) {
            (valid, cause) = (None, Some(failure));
        }
        let lower = valid.and_then(|report| {
            // The energy of the report is not exact enough for small steps.
            let there = damped.internal_force(&next, &mut force).total();
            let descent = energy + damped.work(t, [&q, &next], [&step, &step]) - there;
            (descent >= -ROUNDING * energy).then_some((report, there))
        });
        let Some((report, there)) = lower else {
            mass *= SHORTER;
            longer = LONGER[1];
            if mass > HEAVIEST * scale || !mass.is_finite() {
                break;
            }
            continue;
        };
        (q, energy) = (next, there);
        let quick = report.iterations <= QUICK;
        if quick {
            mass *= longer;
        }
        let calm = mass < LIGHTEST * scale || quick && moved < CALMER * last;
        last = moved;
        stuck = moved < STUCK;
        if moved < AT_REST && calm || stuck {
            match rest(path, t, &q, observer) {
                Ok(point) => end = Some(point),
                Err(failure @ (Failure::Stopped | Failure::TooLarge)) => return Err(failure),
                Err(failure) => cause = Some(failure),
            }
            if end.is_some() || stuck {
                break;
            }
        }
    }
    path.system.add_timers(damped.timers());
    path.forces += damped.forces();
    path.factorizations += damped.factorizations();
    path.iterations += newton.iterations();
    end.ok_or_else(|| match cause {
        // No step has succeeded, the motion rests where there is no stable equilibrium, or elements collapse.
        Some(failure) if stuck || last == f64::INFINITY || matches!(failure, Failure::Collapsed { .. }) => failure,
        _ => Failure::NotSettled { iterations: newton.iterations(), moved: last },
    })
}

/// The stable equilibrium close to `q`.
fn rest(path: &mut Path<'_>, t: f64, q: &[f64], observer: &dyn Observer) -> Result<Point, Failure> {
    let problem = Problem { t, stiffness: 1.0, ..Problem::default() };
    let mut end = q.to_vec();
    let report = path.newton.solve(path.system, &problem, &mut end, None, observer)?;
    let moved = path.newton.distance(q, &end);
    if moved >= AT_REST {
        return Err(Failure::NotSettled { iterations: report.iterations, moved });
    }
    if report.negative_pivots > 0 {
        return Err(Failure::Unstable { negative: report.negative_pivots });
    }
    Ok(Point { load: Load { t, held: 0.0 }, q: end, energy: report.energy, negative_pivots: 0 })
}
