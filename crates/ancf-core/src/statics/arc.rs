//! Arc length: a path whose load factor is found, through limit points and turning points.
//!
//! Each step predicts along the tangent and solves in the plane normal to it, in the metric of displacements.

use crate::nonlinear::{Failure, Problem};
use crate::observe::Observer;
use crate::quadrature::Rule;

use super::Options;
use super::load::{GROWN, ITERATIONS};
use super::metric::Metric;
use super::path::{Load, Path, Point, difference, hermite};

/// Largest distance of a solution from its prediction, relative to the step, and the one to aim at: beyond, Newton's method
/// rarely converges.
const TURN: [f64; 2] = [0.7, 0.4];
/// Largest difference between the gain of strain energy and the work on the cubic way, relative to the latter.
const MISMATCH: f64 = 0.03;
/// Length of a step after one along which the slope of the load falls to a share, relative to its length and that share, and
/// the least that it is cut to: some limit points come in pairs that are close together.
const FLATTENED: f64 = 6.0;
const LEAST: f64 = 0.1;
/// A limit point this close to the end of a step, relative to its length, is that end.
const LIMIT: f64 = 0.05;
/// The first step and the shortest, relative to the size of the model and to the thickness of its thinnest body: a flat
/// skin has hardly any stiffness before it has moved by its thickness.
const FIRST: f64 = 0.1;
const THIN: f64 = 0.01;
/// A step in which stability is lost though the load factor goes on becomes shorter by this share, until
/// it changes the load factor by less than so much of it: a bifurcation is located as well as this.
const BIFURCATION: [f64; 2] = [0.25, 5e-3];

/// Follows the path until it reaches the last load factor.
///
/// # Source
///
/// Riks (1979), Crisfield (1981) for the cylindrical measure; Feng, Peric and Owen (1995) for the direction, which is the
/// one that goes on along the last step.
pub(super) fn follow(path: &mut Path<'_>, options: &Options, observer: &mut dyn Observer) -> Result<(), Failure> {
    let factors = &options.load_factors;
    let (first, target) = (factors[0] - path.at.load.t, factors[factors.len() - 1]);
    let step = options.first_step.unwrap_or(f64::INFINITY);
    let mut walk = Walk::new(path, [first, step, options.min_step])?;
    if factors.len() > 1 {
        walk = walk.in_even_steps();
    }
    while path.at.load.t != target && path.steps < options.max_steps {
        walk.step(path, target, observer)?;
        path.steps += 1;
        path.output(observer);
    }
    Ok(())
}

/// Steps along a path.
pub(super) struct Walk {
    metric: Metric,
    tangent: Tangent,
    length: f64,
    shortest: f64,
    longest: f64,
    /// Largest change of the load factor along the tangent.
    most: f64,
}

impl Walk {
    /// From the last point of the path, whose tangent is factorised, in the direction in which the load factor changes
    /// by `most`; along the tangent no step changes it by more, the first one changes it by `first` and the shortest by
    /// `shortest`. Where a path turns away from its first direction it goes much farther for the same load.
    ///
    /// # Errors
    ///
    /// The loads do not change with the load factor.
    pub fn new(path: &mut Path<'_>, [most, first, shortest]: [f64; 3]) -> Result<Self, Failure> {
        let metric = Metric::new(path);
        let t = path.at.load.t;
        let rate = path.rate(&path.at.q.clone(), t);
        let size = metric.length(&rate);
        if size == 0.0 {
            return Err(Failure::ConstantLoad { t });
        }
        let bodies = path.system.model().bodies().iter();
        let thin = bodies.map(|body| body.plate().thickness / path.newton.scale()[3 * body.vector(0, 0)]);
        let thin = THIN * thin.fold(f64::INFINITY, f64::min);
        let tangent = Tangent::new(rate, most.signum() / size);
        let most = most.abs();
        Ok(Self {
            metric,
            tangent,
            length: (size * first.min(most)).min(FIRST),
            shortest: (size * shortest).min(thin),
            longest: f64::INFINITY,
            most,
        })
    }

    /// The same with steps no longer than the first tangent is for the largest change of the load factor.
    pub fn in_even_steps(self) -> Self {
        Self { longest: self.most / self.tangent.t.abs(), ..self }
    }

    /// Makes a step of the path; it ends where a limit point or the target is met.
    pub fn step(&mut self, path: &mut Path<'_>, target: f64, observer: &dyn Observer) -> Result<(), Failure> {
        let mut share = 1.0;
        loop {
            match self.advance(path, share * self.length, target, observer) {
                Ok(Step::Accepted { iterations, turn, end }) => {
                    let growth = (ITERATIONS / iterations as f64).powi(2).min(share * TURN[1] / turn).clamp(0.5, GROWN);
                    // Where the load hardly grows any more, but for a limit point that the step was to end at, one is near.
                    let flattened = if share == 1.0 { (end.t / self.tangent.t).abs() } else { 1.0 };
                    let growth = growth.min((FLATTENED * flattened).max(LEAST));
                    self.length = (growth * self.length).min(self.longest).min(self.most / end.t.abs());
                    self.tangent = end;
                    return Ok(());
                }
                Ok(Step::Shortened(by)) => share *= by,
                Ok(Step::Lost) => {
                    self.length *= BIFURCATION[0] * share;
                    share = 1.0;
                }
                Err(failure @ (Failure::Stopped | Failure::TooLarge)) => return Err(failure),
                Err(failure) => {
                    path.rejected.count(&failure);
                    self.length *= 0.5 * share;
                    share = 1.0;
                    // A load beyond all numbers gives lengths that never become short.
                    if !(self.shortest..f64::INFINITY).contains(&self.length) {
                        let (q, t) = (path.at.q.clone(), path.at.load.t);
                        let next = t + self.shortest * self.tangent.t;
                        let constant = self.metric.length(&path.rate(&q, next)) == 0.0;
                        return Err(if constant { Failure::ConstantLoad { t } } else { failure });
                    }
                }
            }
        }
    }

    /// One step, or none if it fails.
    fn advance(&self, path: &mut Path<'_>, length: f64, target: f64, observer: &dyn Observer) -> Result<Step, Failure> {
        let Self { metric, tangent, .. } = self;
        let from = &path.at;
        let mut q: Vec<f64> = from.q.iter().zip(&tangent.q).map(|(q, p)| q + length * p).collect();
        let predicted = q.clone();
        let t = from.load.t + length * tangent.t;
        let stable = from.negative_pivots == 0;
        let mut problem = Problem { t, stiffness: 1.0, stable, ..Problem::default() };
        let normal = metric.weighted(&tangent.q);
        let mut report = path.newton.solve_in_plane(path.system, &problem, &normal, &mut q, Some(&from.q), observer)?;
        let iterations = report.iterations;

        let way = {
            let straight = difference(&q, &from.q);
            let rate = path.rate(&q, report.t);
            let chord = metric.length(&straight);
            let forward = metric.product(&rate, &straight).signum() / metric.length(&rate);
            Way { from: &path.at, q: &q, t: report.t, start: tangent, end: Tangent::new(rate, forward), chord }
        };
        path.check_collapse(&path.at.q, &q, report.t)?;
        let turn = metric.length(&difference(&q, &predicted)) / length;
        let work = way.work(path);
        let gained = report.energy - path.at.energy;
        let mismatch = (gained - work) / work.abs();
        if turn > TURN[0] || mismatch.abs() > MISMATCH {
            return Err(Failure::Disconnected { progress: turn, mismatch });
        }
        let limit = way.limit();
        match limit {
            Some(share) if (LIMIT..1.0 - LIMIT).contains(&share) => return Ok(Step::Shortened(share)),
            // A limit point at an end explains one negative pivot.
            _ if length > self.shortest
                && stable
                && report.negative_pivots > usize::from(limit.is_some())
                && (way.t - way.from.load.t).abs() > BIFURCATION[1] * way.t.abs() =>
            {
                return Ok(Step::Lost);
            }
            _ => {}
        }
        let mut last = None;
        if (way.t - target) * (path.at.load.t - target) < 0.0 {
            let crossing = way.crossing(target);
            let mut end = way.at(crossing).0;
            problem.t = target;
            report = path.newton.solve(path.system, &problem, &mut end, Some(&path.at.q), observer)?;
            let miss = metric.length(&difference(&end, &way.at(crossing).0)) / length;
            if miss > LIMIT {
                return Err(Failure::Disconnected { progress: miss, mismatch });
            }
            last = Some(end);
        }
        let end = way.end;
        path.work += report.energy - path.at.energy;
        let load = Load { t: report.t, held: 0.0 };
        path.at = Point { load, q: last.unwrap_or(q), energy: report.energy, negative_pivots: report.negative_pivots };
        Ok(Step::Accepted { iterations, turn, end })
    }
}

enum Step {
    Accepted {
        iterations: usize,
        turn: f64,
        end: Tangent,
    },
    /// There is a limit point at this share of the step, which should end there.
    Shortened(f64),
    /// It passes over a bifurcation.
    Lost,
}

/// Changes per unit of length along the path.
struct Tangent {
    q: Vec<f64>,
    t: f64,
}

impl Tangent {
    /// From the changes per load factor and the load factor's change.
    fn new(mut rate: Vec<f64>, t: f64) -> Self {
        rate.iter_mut().for_each(|v| *v *= t);
        Self { q: rate, t }
    }
}

/// The cubic through both ends of a step, along a parameter from 0 to 1.
struct Way<'a> {
    from: &'a Point,
    q: &'a [f64],
    t: f64,
    start: &'a Tangent,
    end: Tangent,
    chord: f64,
}

impl Way<'_> {
    /// Coordinates and load factor, and their derivatives.
    fn at(&self, u: f64) -> (Vec<f64>, f64, Vec<f64>) {
        let value = |a, b, p, s| hermite(u, a, b, self.chord * p, self.chord * s);
        let all = self.from.q.iter().zip(self.q).zip(self.start.q.iter().zip(&self.end.q));
        let (q, rate) = all.map(|((a, b), (p, s))| value(*a, *b, *p, *s)).unzip();
        (q, value(self.from.load.t, self.t, self.start.t, self.end.t).0, rate)
    }

    /// Work of the loads.
    fn work(&self, path: &Path<'_>) -> f64 {
        let mut force = vec![0.0; self.q.len()];
        let points = Rule::Gauss(4).points().into_iter();
        points
            .map(|(u, weight)| {
                let (q, t, rate) = self.at(u);
                path.system.external_force(&q, t, &mut force);
                weight * force.iter().zip(&rate).map(|(f, v)| f * v).sum::<f64>()
            })
            .sum()
    }

    /// Where the load factor turns back: first, but for the ends, which are limit points as they are.
    fn limit(&self) -> Option<f64> {
        let [start, end] = [self.start.t, self.end.t].map(|t| self.chord * t);
        let rise = self.t - self.from.load.t;
        // The slope is start + 2 c u + 3 d u^2.
        let (c, d) = (3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise);
        let root = (c * c - 3.0 * d * start).sqrt();
        let sum = -(c + root.copysign(c));
        let roots = [start / sum, sum / (3.0 * d)].into_iter().filter(|u| (0.0..1.0).contains(u));
        let amid = |u: &f64| (LIMIT..1.0 - LIMIT).contains(u);
        roots.min_by(|a, b| (!amid(a), a).partial_cmp(&(!amid(b), b)).expect("numbers"))
    }

    /// Where the load factor has a value that lies between those of the ends.
    fn crossing(&self, t: f64) -> f64 {
        bisect(|u| hermite(u, self.from.load.t, self.t, self.chord * self.start.t, self.chord * self.end.t).0 - t)
    }
}

/// A root in [0, 1] of a function that changes its sign there.
fn bisect(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let sign = f(low);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) * sign > 0.0 { low = middle } else { high = middle }
    }
    low
}
