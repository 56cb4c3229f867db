//! Along the path of a given load where load steps fail; on loss of stability the structure moves, damped, to the next stable
//! equilibrium.
//!
//! Arc length leads over the limit point, or through the bifurcation, to an equilibrium that is not stable. From there
//! the structure slides down its potential energy.

use crate::nonlinear::Failure;
use crate::observe::Observer;

use super::Options;
use super::arc::Walk;
use super::metric::Metric;
use super::motion::{Start, settle};
use super::path::{Load, Path, Point, difference, product};

/// Steps by arc length in which stability is lost or the load is reached.
const MOST_STEPS: usize = 50;
/// How far beyond the load at which stability is lost the structure moves, relative to that load, but no more than to the
/// first step: there the equilibrium that it leaves is no longer, and nor are those that are as close to their limit.
const BEYOND: f64 = 0.01;
/// Iterations of a motion.
const MOST_MOTION: usize = 5000;
/// Disturbance along the mode that has lost its stiffness, relative to the size of the model.
const DISTURBANCE: f64 = 1e-3;

/// Gets the load on from a point where a step has failed: along the path, in steps of which the first changes the load by
/// `first`, or by a jump; or leaves the path at the last stable point.
pub(super) fn pass(
    path: &mut Path<'_>,
    to: [f64; 2],
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<(), Failure> {
    let mut stable = (path.at.clone(), path.work);
    let end = lead_on(path, to, &mut stable, options, observer);
    if end.is_err() {
        (path.at, path.work) = stable;
    }
    end
}

fn lead_on(
    path: &mut Path<'_>,
    [first, target]: [f64; 2],
    stable: &mut (Point, f64),
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<(), Failure> {
    path.linearize()?;
    let start = path.at.load.t;
    let direction = (target - start).signum();
    let onwards = |from: f64, change: f64| from + direction * change.min((target - from).abs());
    let mut walk = Walk::new(path, [target - start, first, options.min_step])?;
    let mut farthest = start;
    for _ in 0..MOST_STEPS {
        match walk.step(path, target, observer) {
            Ok(()) => path.steps += 1,
            Err(failure @ (Failure::Stopped | Failure::TooLarge)) => return Err(failure),
            // The path leads nowhere, but a motion does.
            Err(_) => {
                path.linearize()?;
                let (q, t) = (path.at.q.clone(), onwards(farthest, first));
                let change = path.change(&q, Load { t, held: 0.0 });
                let mut shape = vec![0.0; q.len()];
                path.system.solve(&change, &mut shape);
                let stiffness = product(&change, &shape);
                return jump(path, stable, Start { t, q, shape: &shape, stiffness }, observer);
            }
        }
        let back = (farthest - path.at.load.t) * direction;
        if back < 0.0 {
            farthest = path.at.load.t;
        }
        // A stable equilibrium at a smaller load lies beyond an unstable stretch that the step has passed over.
        if path.at.negative_pivots > 0 || back > 0.0 {
            let q = disturbed(path, &difference(&path.at.q, &stable.0.q));
            let shape = difference(&path.at.q, path.system.model().reference());
            let beyond = (BEYOND * first.min(farthest.abs())).max(options.min_step.min(BEYOND * first));
            let (t, stiffness) = (onwards(farthest, beyond), 2.0 * path.at.energy);
            return jump(path, stable, Start { t, q, shape: &shape, stiffness }, observer);
        }
        observer.reached(path.at.load.t);
        if path.at.load.t == target {
            break;
        }
        *stable = (path.at.clone(), path.work);
    }
    Ok(())
}

/// Moves from a state close to the last point to a stable equilibrium. The load does its work from the last stable one on:
/// the structure does not go the way on which arc length has led.
fn jump(
    path: &mut Path<'_>,
    (stable, work): &(Point, f64),
    start: Start<'_>,
    observer: &mut dyn Observer,
) -> Result<(), Failure> {
    let t = start.t;
    let end = settle(path, start, MOST_MOTION, observer)?;
    let straight = difference(&end.q, &stable.q);
    path.work = work + path.system.work(t, [&stable.q, &end.q], [&straight, &straight]);
    path.at = end;
    path.jumps.push(t);
    Ok(())
}

/// The coordinates of the last point, displaced along the softest mode of its tangent, which is factorised: forwards, if
/// the mode has a part along the last step.
fn disturbed(path: &mut Path<'_>, along: &[f64]) -> Vec<f64> {
    let metric = Metric::new(path);
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
