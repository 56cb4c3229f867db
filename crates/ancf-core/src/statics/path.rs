//! A path of equilibria: the point it has reached and what is known there.

use crate::assembly::{Bodies, System};
use crate::element::Want;
use crate::nonlinear::{Failure, Middles, Newton, Options as NewtonOptions};
use crate::observe::{Observer, State};
use crate::report::{Counts, Rejections};

use super::{Control, Options, arc, load};

/// Where the loads are on their way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Load {
    /// The load factor.
    pub t: f64,
    /// The share of the unbalanced force at the start, of loads that do not vanish at load factor 0, that is still held
    /// back.
    pub held: f64,
}

impl Load {
    /// The load at `share` of the way to another one.
    pub fn towards(self, to: Self, share: f64) -> Self {
        let between = |a: f64, b: f64| if share == 1.0 { b } else { a + share * (b - a) };
        Self { t: between(self.t, to.t), held: between(self.held, to.held) }
    }
}

/// An equilibrium on the path.
#[derive(Clone)]
pub(super) struct Point {
    pub load: Load,
    pub q: Vec<f64>,
    /// Strain energy, J.
    pub energy: f64,
    /// Negative pivots of the tangent.
    pub negative_pivots: usize,
}

/// The path so far. The tangent of its last point is factorised whenever a step begins.
pub(super) struct Path<'a> {
    pub system: &'a mut System,
    pub newton: Newton,
    pub at: Point,
    /// Force of the loads at the start.
    pub initial: Vec<f64>,
    /// Work of the loads so far, J.
    pub work: f64,
    /// Load factors at which the structure has jumped.
    pub jumps: Vec<f64>,
    pub steps: usize,
    pub rejected: Rejections,
    /// The load factor of the point that the observer was given last.
    pub told: Option<f64>,
    /// Iterations, evaluations and factorisations of jumps.
    pub iterations: usize,
    pub forces: usize,
    pub factorizations: usize,
}

impl<'a> Path<'a> {
    /// A path that begins at rest, all loads held back.
    pub fn new(system: &'a mut System, options: NewtonOptions) -> Self {
        // Steps begin with the tangent of the last solution, which is factorised anyway.
        let newton = Newton::new(system, NewtonOptions { reuse: false, ..options });
        let q = system.model().reference().to_vec();
        let mut initial = vec![0.0; q.len()];
        system.external_force(&q, 0.0, &mut initial);
        let load = Load { t: 0.0, held: 1.0 };
        let at = Point { load, q, energy: 0.0, negative_pivots: 0 };
        Self {
            system,
            newton,
            at,
            initial,
            work: 0.0,
            jumps: Vec::new(),
            steps: 0,
            rejected: Rejections::default(),
            iterations: 0,
            forces: 0,
            factorizations: 0,
            told: None,
        }
    }

    /// Follows the path from rest to its end.
    pub fn follow(&mut self, options: &Options, observer: &mut dyn Observer) -> Result<(), Failure> {
        self.begin()?;
        load::release(self, options, observer)?;
        self.output(observer);
        match options.control {
            Control::Load => load::follow(self, options, observer),
            Control::Arc => arc::follow(self, options, observer),
        }
    }

    /// Checks that the supports suffice and factorises the tangent at rest.
    fn begin(&mut self) -> Result<(), Failure> {
        let motions = self.system.model().rigid_motions(&self.at.q);
        if !motions.is_empty() {
            let motions = motions.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
            return Err(Failure::Unsupported { motions });
        }
        self.linearize()
    }

    /// Factorises the tangent of the last point.
    pub fn linearize(&mut self) -> Result<(), Failure> {
        let Self { system, at, .. } = self;
        let want = Want { mass: 0.0, stiffness: 1.0, previous: None };
        system.assemble(&at.q, at.load.t, want, &mut vec![0.0; at.q.len()]);
        system.factorize().map_err(|e| Failure::from_linear(e, 0, |row| system.describe(row)))?;
        Ok(())
    }

    /// Refuses a step to `to` on which an element is turned inside out or squeezed to nothing: no material has equilibria there.
    pub fn check_collapse(&self, from: &[f64], to: &[f64], t: f64) -> Result<(), Failure> {
        let model = self.system.model();
        let mut middles = Middles::new(model);
        middles.begin(model, from);
        let place = middles.collapsed(model, to).or_else(|| middles.squeezed(model, to));
        place.map_or(Ok(()), |place| Err(Failure::Collapsed { place, end: format!("load factor {t:.6}") }))
    }

    /// Change of the force at coordinates `q` from the load of the last point to another one.
    pub fn change(&self, q: &[f64], to: Load) -> Vec<f64> {
        let [mut now, mut next] = [vec![0.0; q.len()], vec![0.0; q.len()]];
        self.system.external_force(q, self.at.load.t, &mut now);
        self.system.external_force(q, to.t, &mut next);
        let released = self.at.load.held - to.held;
        for (i, force) in next.iter_mut().enumerate() {
            *force += released * self.initial[i] - now[i];
        }
        next
    }

    /// Change of the coordinates per change of the load factor; the tangent there is factorised.
    pub fn rate(&mut self, q: &[f64], t: f64) -> Vec<f64> {
        let [mut force, mut rate] = [vec![0.0; q.len()], vec![0.0; q.len()]];
        self.system.external_force_rate(q, t, &mut force);
        self.system.solve(&force, &mut rate);
        rate
    }

    /// What the path has taken.
    pub fn counts(&self) -> Counts {
        let iterations = self.newton.iterations() + self.iterations;
        let Self { steps, rejected, forces, factorizations, .. } = *self;
        Counts { steps, rejected, iterations, forces, factorizations, ..Counts::default() }
    }

    /// Gives the last point to the observer, unless it has it.
    pub fn output_last(&mut self, observer: &mut dyn Observer) {
        let Load { t, held } = self.at.load;
        if held == 0.0 && self.told != Some(t) {
            self.output(observer);
        }
    }

    /// Gives the last point to the observer.
    pub fn output(&mut self, observer: &mut dyn Observer) {
        self.told = Some(self.at.load.t);
        let Point { load, ref q, negative_pivots, .. } = self.at;
        let zeros = vec![0.0; q.len()];
        let [mut residual, mut external] = [zeros.clone(), zeros.clone()];
        let strain = self.system.internal_force(q, &mut residual);
        self.system.external_force(q, load.t, &mut external);
        for (residual, external) in residual.iter_mut().zip(&external) {
            *residual -= external;
        }
        observer.state(State {
            t: load.t,
            q: q.clone(),
            v: zeros.clone(),
            a: zeros,
            strain,
            kinetic: 0.0,
            work: self.work,
            dissipated: 0.0,
            momentum: [0.0; 3],
            angular_momentum: [0.0; 3],
            reactions: self.system.reactions(q, &residual, Bodies::Flexible),
            negative_pivots: Some(negative_pivots),
        });
        observer.reached(load.t);
    }
}

/// `a - b`.
pub(super) fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// `a . b`.
pub(super) fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Value and derivative at `u` of the cubic with values `a`, `b` and slopes `p`, `s` at 0 and 1.
pub(super) fn hermite(u: f64, a: f64, b: f64, p: f64, s: f64) -> (f64, f64) {
    let (c, d) = (3.0 * (b - a) - 2.0 * p - s, p + s - 2.0 * (b - a));
    (a + u * (p + u * (c + u * d)), p + u * (2.0 * c + u * 3.0 * d))
}
