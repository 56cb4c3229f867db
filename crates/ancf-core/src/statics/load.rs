//! Load control: equilibria at given load factors, in steps of adaptive size, each connected to the one before.
//!
//! Newton's method can converge to a stable equilibrium of another branch. Between stable equilibria of one branch the
//! displacement along the load grows with the load, and the strain energy gained is the work done on the way. The slopes
//! of load over displacement at both ends of a step tell how much that should be, and a step whose end lies far from
//! where its tangent points says too little about the way to be trusted.
//!
//! Energy that is missing has been set free by a snap on the way.
//!
//! Where neither the whole step nor a quarter of it is found so, arc length leads on: with the displacement given, Newton's
//! method converges where it does not under a given load.

use crate::nonlinear::{Failure, Problem};
use crate::observe::Observer;

use super::Options;
use super::jump;
use super::path::{Load, Path, Point, product};

/// Displacement along the load's change relative to its prediction. Below, a structure that seems to stiffen may as well
/// be on another branch: a cantilever of one element with full quadrature, whose membrane locks, has one at 0.04. Above,
/// it softens as before a limit point.
const PROGRESS: [f64; 2] = [0.1, 3.0];
/// A solution that falls short of its prediction by more than this, or is beyond it, must have been found without detours:
/// the same cantilever of two elements has another branch at 0.31, to which Newton's method comes by a correction that is
/// 8 times the one before; to the pulled cylinder beyond its snap it comes at 1.43 by one that is 2.9 times.
const NEAR: [f64; 2] = [0.5, 1.25];
/// Growth of a correction that is a detour.
const GROWTH: f64 = 2.0;
/// Largest strain energy that is missing and that is in excess of what is expected, relative to the work of the load's
/// change. A snap sets energy free: the pulled cylinder of Sze, Liu and Lo (2004) 0.012 in a step over half of the load, on
/// coarse meshes 0.009. Estimates for cantilevers and shells, up to steps that are 0.1 of their prediction, lie below what is
/// gained by up to 0.06 and above by up to 0.004.
const LOST: f64 = 0.006;
const EXCESS: f64 = 0.1;
/// A step that moves the model by less than this, relative to its size, cannot lead to another branch, and its energies
/// may be nothing but rounding.
const SMALL: f64 = 1e-6;
/// Energies are known to this accuracy only.
pub(super) const ROUNDING: f64 = 1e-10;
/// The number of iterations that a step should take.
pub(super) const ITERATIONS: f64 = 8.0;
/// The length of a step after one that failed, and most of one after one that succeeded, relative to it.
const CUT: f64 = 0.25;
pub(super) const GROWN: f64 = 4.0;
/// Steps that fail one after the other before arc length leads on.
const PATIENCE: usize = 2;
/// How often arc length may lead on while the load gets on by less than a share of the way to the next load factor.
const MOST_PASSES: usize = 20;
const ONWARDS: f64 = 1e-2;

/// Brings the loads that do not vanish at load factor 0 into equilibrium.
pub(super) fn release(path: &mut Path<'_>, options: &Options, observer: &mut dyn Observer) -> Result<(), Failure> {
    if path.initial.iter().any(|f| *f != 0.0) {
        reach(path, Load::default(), options, &mut { f64::INFINITY }, observer)?;
    }
    path.at.load.held = 0.0;
    Ok(())
}

/// Follows the path through the load factors.
pub(super) fn follow(path: &mut Path<'_>, options: &Options, observer: &mut dyn Observer) -> Result<(), Failure> {
    let mut step = options.first_step.unwrap_or(f64::INFINITY);
    for &t in &options.load_factors {
        for t in path.system.model().kinks(path.at.load.t, t, 0.0).chain([t]) {
            reach(path, Load { t, held: 0.0 }, options, &mut step, observer)?;
        }
        path.output(observer);
    }
    Ok(())
}

/// Follows the path to a load, in steps of at most `step`, which is adapted.
fn reach(
    path: &mut Path<'_>,
    target: Load,
    options: &Options,
    step: &mut f64,
    observer: &mut dyn Observer,
) -> Result<(), Failure> {
    // Changes of the coordinates, per length of step, that the tangent at the last point predicts.
    let mut rate = None;
    let mut failed = 0;
    let whole = (target.t - path.at.load.t).abs();
    // Where the last step that failed would have ended.
    let mut lost = f64::NAN;
    // How often arc length has led on, and from where.
    let (mut passes, mut begun) = (0, path.at.load.t);
    while path.at.load != target {
        let from = path.at.load;
        let left = (target.t - from.t).abs() + (target.held - from.held).abs();
        let length = if *step >= 0.999 * left { left } else { *step };
        let to = from.towards(target, length / left);
        let change = path.change(&path.at.q, to);
        let rate_here = rate.get_or_insert_with(|| {
            let mut rate = vec![0.0; change.len()];
            path.system.solve(&change, &mut rate);
            rate.iter_mut().for_each(|v| *v /= length);
            rate
        });
        let predicted: Vec<f64> = rate_here.iter().map(|v| v * length).collect();
        match advance(path, to, &change, &predicted, observer) {
            Ok(iterations) => {
                path.steps += 1;
                *step = length * (ITERATIONS / iterations as f64).powi(2).clamp(0.5, GROWN);
                (rate, failed) = (None, 0);
                observer.reached(path.at.load.t);
            }
            Err(failure @ (Failure::Stopped | Failure::TooLarge)) => {
                return Err(failure);
            }
            Err(failure) => {
                path.rejected.count(&failure);
                *step = length
                    * match failure {
                        Failure::Disconnected { progress, .. } => (progress / PROGRESS[0]).clamp(1e-2, CUT),
                        _ => CUT,
                    };
                failed += 1;
                // Coming closer has not helped.
                if failed == 1 && (lost - to.t) * (to.t - from.t) >= 0.0 {
                    failed = PATIENCE;
                }
                lost = to.t;
                if from.held == 0.0 && (failed == PATIENCE || *step < options.min_step) {
                    if (from.t - begun).abs() > ONWARDS * whole {
                        (passes, begun) = (0, from.t);
                    }
                    passes += 1;
                    if passes > MOST_PASSES {
                        return Err(failure);
                    }
                    jump::pass(path, [*step, target.t], options, observer)?;
                    *step = GROWN * length;
                    (rate, failed) = (None, 0);
                    observer.reached(path.at.load.t);
                } else if *step < options.min_step {
                    return Err(failure);
                }
            }
        }
    }
    Ok(())
}

/// Solves at another load and accepts the solution, or leaves the path as it was. Returns the number of iterations.
fn advance(
    path: &mut Path<'_>,
    to: Load,
    change: &[f64],
    predicted: &[f64],
    observer: &dyn Observer,
) -> Result<usize, Failure> {
    let from = &path.at;
    let mut q: Vec<f64> = from.q.iter().zip(predicted).map(|(q, p)| q + p).collect();
    let held: Vec<f64> = path.initial.iter().map(|f| to.held * f).collect();
    let problem = Problem { t: to.t, stiffness: 1.0, constant: Some(&held), stable: true, ..Problem::default() };
    let report = path.newton.solve(path.system, &problem, &mut q, Some(&from.q), observer)?;
    let negative = report.negative_pivots;
    if negative > 0 {
        return Err(Failure::Unstable { negative });
    }
    let point = Point { load: to, q, energy: report.energy, negative_pivots: negative };
    accept(path, point, change, predicted, report.growth)?;
    Ok(report.iterations)
}

/// Accepts a solution as the next one on the path, or leaves the path as it was.
fn accept(path: &mut Path<'_>, end: Point, change: &[f64], predicted: &[f64], growth: f64) -> Result<(), Failure> {
    let from = &path.at;
    let Point { load: to, q, .. } = &end;
    let (to, report) = (*to, &end);

    let end_change = path.change(q, to);
    let mut slope = vec![0.0; q.len()];
    path.system.solve(&end_change, &mut slope);
    let work = |load: Load| {
        let released: f64 = (0..q.len()).map(|i| -load.held * path.initial[i] * (q[i] - from.q[i])).sum();
        released + path.system.work(load.t, [&from.q, q], [predicted, &slope])
    };
    let start = work(from.load);
    let added = work(to) - start;
    let rates = [product(change, predicted), product(&end_change, &slope)];
    let [progress, backward] = rates.map(|rate| if rate == 0.0 { 1.0 } else { added / rate });
    // Share of `added` that is work when the load changes with the displacement as its slopes at both ends say: exact to
    // third order for small steps, and close to u^k -> 1 / (k + 1) for a load that grows with a power k.
    let share = 0.5 + 0.5 * (progress - backward) / (progress + backward + 4.0);
    let expected = start + share * added;
    let gained = report.energy - from.energy;
    let mismatch = (gained - expected) / added;
    let slack = ROUNDING * (report.energy + from.energy);
    let near = (PROGRESS[0]..=PROGRESS[1]).contains(&progress)
        && ((NEAR[0]..=NEAR[1]).contains(&progress) || growth <= GROWTH);
    let small = path.newton.distance(&from.q, q) < SMALL;
    if !small && (!near || !(-LOST..=EXCESS).contains(&mismatch) && (gained - expected).abs() > slack) {
        return Err(Failure::Disconnected { progress, mismatch });
    }
    path.check_collapse(&path.at.q, &end.q, end.load.t)?;
    // On the way between two equilibria of one branch the work is the gain of strain energy.
    path.work += gained;
    path.at = end;
    Ok(())
}
