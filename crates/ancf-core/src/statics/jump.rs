//! Loss of stability under a load: the structure moves, damped, to the next stable equilibrium.
//!
//! Arc length leads over the limit point, or through the bifurcation, to an equilibrium that is not stable. From there
//! the structure slides down its potential energy.

use crate::nonlinear::Failure;
use crate::observe::Observer;

use super::Options;
use super::arc::{Metric, Walk};
use super::motion::{Start, settle};
use super::path::{Path, Point, difference};

/// Steps by arc length in which stability must be lost or the load must get on.
const MOST_STEPS: usize = 50;
/// Load, relative to the first step, after which it has got on; the same where the step that failed, four times as long, has
/// seen an unstable state.
const PASSED: f64 = 16.0;
const PASSED_UNSTABLE: f64 = 4.0;
/// Jumps that may come to nothing: close to a bifurcation the branches are close together and the motion almost at rest.
const MOST_JUMPS: usize = 3;
/// The step after a jump that came to nothing, relative to the one before.
const FURTHER: f64 = 0.1;
/// Iterations of a motion.
const MOST_MOTION: usize = 1500;
/// Disturbance along the mode that has lost its stiffness, relative to the size of the model.
const DISTURBANCE: f64 = 1e-3;

/// Gets the load on from a point where a step has failed, of which `length` is a part: along the path, or by a jump; or
/// leaves the path as it was.
///
/// Where an `unstable` state has been seen on the way, no step is longer than `length`: it could step over the stretch of
/// the path that is not stable.
pub(super) fn pass(
    path: &mut Path<'_>,
    [length, target]: [f64; 2],
    unstable: bool,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<(), Failure> {
    let (begin, work) = (path.at.clone(), path.work);
    lead_on(path, [length, target], unstable, options, observer).inspect_err(|_| {
        (path.at, path.work) = (begin, work);
    })
}

fn lead_on(
    path: &mut Path<'_>,
    [length, target]: [f64; 2],
    unstable: bool,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<(), Failure> {
    path.linearize()?;
    let start = path.at.load.t;
    let direction = (target - start).signum();
    let longest = if unstable { length } else { PASSED * length };
    let passed = if unstable { PASSED_UNSTABLE } else { PASSED } * length;
    let mut walk = Walk::new(path, [longest * direction, length, options.min_step]).bounded_by_load();
    let (mut stable, mut farthest) = (path.at.q.clone(), start);
    let mut stuck = None;
    let mut jumps = 0;
    for _ in 0..MOST_STEPS {
        walk.step(path, target, observer)?;
        path.steps += 1;
        if (path.at.load.t - farthest) * direction > 0.0 {
            farthest = path.at.load.t;
        }
        // A stable equilibrium at a smaller load lies beyond an unstable stretch that the step has passed over.
        if path.at.negative_pivots > 0 || (farthest - path.at.load.t) * direction > 0.0 {
            match jump(path, &stable, farthest, observer) {
                Err(failure @ Failure::Unstable { .. }) if jumps < MOST_JUMPS => stuck = Some(failure),
                result => return result,
            }
            jumps += 1;
            walk.shorten(FURTHER);
            continue;
        }
        if let Some(failure) = stuck {
            return Err(failure);
        }
        if path.at.load.t == target || (farthest - start) * direction > passed {
            return Ok(());
        }
        stable.copy_from_slice(&path.at.q);
    }
    Err(Failure::NotConverged { iterations: MOST_STEPS, correction: f64::NAN })
}

/// Moves from the last point, which is not stable, to a stable one at load factor `t`, farther from `stable`.
fn jump(path: &mut Path<'_>, stable: &[f64], t: f64, observer: &mut dyn Observer) -> Result<(), Failure> {
    // At least one, where the step has passed over the unstable stretch.
    let negative = path.at.negative_pivots.max(1);
    let metric = Metric::new(path);
    let away = difference(&path.at.q, stable);
    let q = disturbed(path, &metric, &away);
    let beyond = |_: &Path<'_>, point: &Point| metric.length(&difference(&point.q, stable)) > metric.length(&away);
    let displacement = difference(&path.at.q, path.system.model().reference());
    let start = Start { t, q, shape: &displacement, stiffness: 2.0 * path.at.energy, stable: false };
    let found = settle(path, start, MOST_MOTION, beyond, observer)?;
    let end = found.ok_or(Failure::Unstable { negative })?;
    let straight = difference(&end.q, &path.at.q);
    path.work += path.system.work(t, [&path.at.q, &end.q], [&straight, &straight]);
    path.at = end;
    path.jumps.push(t);
    Ok(())
}

/// The coordinates of the last point, displaced along the softest mode of its tangent, which is factorised: forwards, if
/// the mode has a part along the last step.
fn disturbed(path: &mut Path<'_>, metric: &Metric, along: &[f64]) -> Vec<f64> {
    let n = along.len();
    // Uniform numbers by a linear congruential generator with Knuth's MMIX constants: a start with every mode in it.
    let mut seed = 1_u64;
    let mut mode: Vec<f64> = (0..n)
        .map(|_| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        })
        .collect();
    for _ in 0..4 {
        let right = metric.weighted(&mode);
        path.system.solve(&right, &mut mode);
        let length = metric.length(&mode);
        mode.iter_mut().for_each(|x| *x /= length);
    }
    let largest = mode.iter().zip(path.newton.scale()).map(|(x, s)| x.abs() / s).fold(0.0, f64::max);
    let amplitude = DISTURBANCE / largest * if metric.product(&mode, along) < 0.0 { -1.0 } else { 1.0 };
    path.at.q.iter().zip(&mode).map(|(q, x)| q + amplitude * x).collect()
}
