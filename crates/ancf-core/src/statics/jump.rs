//! Loss of stability under a load: the structure moves, damped, to the next stable equilibrium.
//!
//! Arc length leads over the limit point, or through the bifurcation, to an equilibrium that is not stable. From there
//! the structure slides down its potential energy, `c M dq/dtau = Q_e - Q_k`, in implicit steps whose length grows until
//! inertia has no part any more: an overdamped motion, whose only purpose is its end.

use std::sync::Arc;

use crate::assembly::System;
use crate::nonlinear::{Failure, Newton, Problem};
use crate::observe::Observer;

use super::Options;
use super::arc::{Metric, Walk};
use super::load::ROUNDING;
use super::path::{Load, Path, Point};

/// Steps by arc length in which stability must be lost or the load must get on.
const MOST_STEPS: usize = 50;
/// Load, relative to the step that failed, after which it has got on.
const PASSED: f64 = 16.0;
/// Density, kg/m3, that lets a body without mass move and weighs nothing.
const WEIGHTLESS: f64 = 1e-12;
/// Disturbance along the mode that has lost its stiffness, relative to the size of the model.
const DISTURBANCE: f64 = 1e-3;
/// Factor of the inertia in a motion: by how much it changes after a step that succeeds and one that fails, relative to
/// that of free vibration the least at which it may be left out and the largest that is tried.
const LONGER: f64 = 0.25;
const SHORTER: f64 = 8.0;
const LIGHTEST: f64 = 1e-3;
const HEAVIEST: f64 = 1e12;
/// Implicit steps of a motion.
const MOST_MOTION: usize = 200;
/// Largest change of a coordinate in such a step, relative to the size of the model.
const LONGEST_MOTION: f64 = 0.3;
/// A motion that moves less in a step, relative to the size of the model, has almost come to rest.
const AT_REST: f64 = 0.05;

/// Gets the load on from a point where a step to `length` further on has failed: along the path, or by a jump.
pub(super) fn pass(
    path: &mut Path<'_>,
    length: f64,
    target: f64,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<(), Failure> {
    path.linearize()?;
    let start = path.at.load.t;
    let direction = (target - start).signum();
    let mut walk = Walk::new(path, PASSED * length * direction, length, options.min_step);
    let (mut stable, mut farthest) = (path.at.q.clone(), start);
    for _ in 0..MOST_STEPS {
        walk.step(path, target, observer)?;
        path.steps += 1;
        if (path.at.load.t - farthest) * direction > 0.0 {
            farthest = path.at.load.t;
        }
        if path.at.negative_pivots > 0 {
            return jump(path, &stable, farthest, options, observer);
        }
        if path.at.load.t == target || (path.at.load.t - start).abs() > PASSED * length {
            return Ok(());
        }
        stable.copy_from_slice(&path.at.q);
    }
    Err(Failure::NotConverged { iterations: MOST_STEPS, correction: f64::NAN })
}

/// Moves from the last point, which is not stable, to a stable one at load factor `t`, farther from `stable`.
fn jump(
    path: &mut Path<'_>,
    stable: &[f64],
    t: f64,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<(), Failure> {
    let negative = path.at.negative_pivots;
    let metric = Metric::new(path);
    let away = difference(&path.at.q, stable);
    let mut q = disturbed(path, &metric, &away);
    let model = path.system.model().with_least_density(WEIGHTLESS);
    let mut damped = System::new(Arc::new(model)).map_err(|e| Failure::from_linear(e, 0, |_| String::new()))?;
    let mut newton = Newton::new(&damped, options.newton);

    let displacement = difference(&q, damped.model().reference());
    let mut inertia = vec![0.0; q.len()];
    damped.add_mass_times(&displacement, &mut inertia);
    // Rayleigh's quotient of the displacement so far.
    let scale = 2.0 * path.at.energy / product(&displacement, &inertia);
    let mut mass = scale;
    let mut energy = damped.internal_force(&q, &mut vec![0.0; q.len()]).total();
    let mut found = None;
    for _ in 0..MOST_MOTION {
        let mut next = q.clone();
        let problem = Problem { t, mass, stiffness: 1.0, origin: &q, ..Problem::default() };
        let report = match newton.solve(&mut damped, &problem, &mut next, None, observer) {
            Err(failure @ (Failure::Stopped | Failure::TooLarge)) => return Err(failure),
            result => result.ok(),
        };
        let (moved, step) = (newton.distance(&q, &next), difference(&next, &q));
        let valid = report.filter(|report| {
            let descent = energy + damped.work(t, [&q, &next], [&step, &step]) - report.energy;
            report.negative_pivots == 0 && moved <= LONGEST_MOTION && descent >= -ROUNDING * energy
        });
        let Some(report) = valid else {
            mass *= SHORTER;
            if mass > HEAVIEST * scale {
                break;
            }
            continue;
        };
        (q, energy) = (next, report.energy);
        mass *= LONGER;
        if moved < AT_REST && mass < LIGHTEST * scale {
            found = rest(path, t, &q, observer)?;
            let beyond = |point: &Point| metric.length(&difference(&point.q, stable)) > metric.length(&away);
            if found.as_ref().is_some_and(beyond) {
                break;
            }
            found = None;
        }
    }
    path.forces += damped.forces();
    path.factorizations += damped.factorizations();
    path.iterations += newton.iterations();
    let end = found.ok_or(Failure::Unstable { negative })?;
    let straight = difference(&end.q, &path.at.q);
    path.work += path.system.work(t, [&path.at.q, &end.q], [&straight, &straight]);
    path.at = end;
    path.jumps.push(t);
    Ok(())
}

/// The stable equilibrium close to `q`, if there is one.
fn rest(path: &mut Path<'_>, t: f64, q: &[f64], observer: &mut dyn Observer) -> Result<Option<Point>, Failure> {
    let problem = Problem { t, stiffness: 1.0, ..Problem::default() };
    let mut end = q.to_vec();
    match path.newton.solve(path.system, &problem, &mut end, None, observer) {
        Err(failure @ (Failure::Stopped | Failure::TooLarge)) => Err(failure),
        Ok(report) if report.negative_pivots == 0 && path.newton.distance(q, &end) < AT_REST => {
            let load = Load { t, held: 0.0 };
            Ok(Some(Point { load, q: end, energy: report.energy, negative_pivots: 0 }))
        }
        _ => Ok(None),
    }
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

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
