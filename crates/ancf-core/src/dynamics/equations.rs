//! The equations of motion at one time, for every integrator.

use crate::assembly::{Bodies, Reaction, StrainEnergy, System};
use crate::element::{At, Motion};
use crate::nonlinear::{Failure, Newton};

use super::inertia::Inertia;
use super::state::Instantaneous;

/// `M a + F(t, q, v) = 0` with `F = Q_k + damping - Q_e`, and the solvers for it.
pub(super) struct Equations<'a> {
    pub system: &'a mut System,
    pub newton: Newton,
    pub inertia: Inertia,
    bodies: Bodies,
    work: Vec<f64>,
}

impl<'a> Equations<'a> {
    pub fn new(system: &'a mut System, newton: Newton, inertia: Inertia, bodies: Bodies) -> Self {
        let work = vec![0.0; system.coordinates()];
        Self { system, newton, inertia, bodies, work }
    }

    /// The force `F`, the loads `Q_e` in it, and the power that damping takes.
    pub fn force(&mut self, t: f64, q: &[f64], v: &[f64], force: &mut [f64], loads: &mut [f64]) -> f64 {
        let (_, power) = self.internal(At::rest(q), v, force);
        self.system.external_force(q, t, loads);
        for (force, load) in force.iter_mut().zip(loads) {
            *force -= *load;
        }
        power
    }

    /// The force `F` without velocities.
    pub fn force_at_rest(&mut self, t: f64, q: &[f64], force: &mut [f64]) {
        self.system.external_force(q, t, &mut self.work);
        self.system.internal_force(q, force);
        for (force, load) in force.iter_mut().zip(&self.work) {
            *force -= load;
        }
    }

    /// The elastic force and that of damping; the strain energy, and the power that damping takes at the velocities `v`.
    fn internal(&mut self, at: At<'_>, v: &[f64], force: &mut [f64]) -> (StrainEnergy, f64) {
        let motion = self.system.is_damped().then_some(Motion { velocity: v, rate: 0.0, viscosity: 0.0 });
        let strain = self.system.force(At { motion, ..at }, force);
        let mut power = if motion.is_some() { self.system.strain_rates().power } else { 0.0 };
        if let Some(damping) = self.system.mass_damping() {
            for (i, product) in self.work.iter_mut().enumerate() {
                *product = damping[i / 3] * v[i];
            }
            let mut drag = vec![0.0; v.len()];
            self.inertia.add_product(&self.work, &mut drag);
            for (i, drag) in drag.iter().enumerate() {
                power += v[i] * drag;
                force[i] += drag;
            }
        }
        (strain, power)
    }

    /// Sets positions, velocities and accelerations of moved supports.
    pub fn prescribe(&self, at: &mut Instantaneous) {
        let model = self.system.model();
        for moved in model.moved() {
            let i = moved.coordinate;
            [at.q[i], at.v[i], _] = model.prescribed(moved, at.t);
            [_, _, at.a[i]] = model.prescribed(moved, at.t - at.lag);
        }
    }

    /// Coordinates whose motion is prescribed.
    pub fn moved(&self) -> impl Iterator<Item = usize> {
        self.system.model().moved().iter().map(|moved| moved.coordinate)
    }

    /// The accelerations of a state whose free positions and velocities are known, its loads and the power of damping; moved
    /// supports are set.
    ///
    /// # Errors
    ///
    /// The forces must be finite.
    pub fn accelerate(&mut self, at: &mut Instantaneous) -> Result<(), Failure> {
        self.prescribe(at);
        let mut force = vec![0.0; at.q.len()];
        at.damping = self.force(at.t, &at.q, &at.v, &mut force, &mut at.external);
        if !force.iter().all(|f| f.is_finite()) {
            return Err(Failure::Overflow { t: at.t });
        }
        self.balance(&force, &mut at.a);
        self.add_reactions(&force, at);
        Ok(())
    }

    /// Sets the accelerations of free coordinates to those that balance a force; those of moved supports are known.
    fn balance(&mut self, force: &[f64], a: &mut [f64]) {
        for (right, force) in self.work.iter_mut().zip(force) {
            *right = -force;
        }
        if self.moved().next().is_some() {
            // Free coordinates see the inertia of moved ones as a force.
            let mut moved = vec![0.0; force.len()];
            for i in self.moved() {
                moved[i] = -a[i];
            }
            self.inertia.add_product(&moved, &mut self.work);
        }
        self.inertia.solve(&self.work, a);
    }

    /// Loads and the power of damping of a state whose accelerations are known.
    pub fn load(&mut self, at: &mut Instantaneous) {
        if self.system.is_damped() || self.moved().next().is_some() {
            let mut force = vec![0.0; at.q.len()];
            at.damping = self.force(at.t, &at.q, &at.v, &mut force, &mut at.external);
            self.add_reactions(&force, at);
        } else {
            self.system.external_force(&at.q, at.t, &mut at.external);
        }
    }

    /// Mean loads and the mean power of damping over a step from `start` to the positions of `mean`, whose other parts are
    /// means already; leaves the mean positions there.
    ///
    /// What moves a support is the mean force, which elastic forces at the mean positions are not: there a body that has
    /// turned is strained.
    pub fn load_mean(&mut self, mean: &mut Instantaneous, start: &[f64]) {
        let mut force = vec![0.0; mean.q.len()];
        let moves = self.moved().next().is_some();
        if self.system.is_damped() || moves {
            (_, mean.damping) = self.internal(At { q: &mean.q, start: Some(start), motion: None }, &mean.v, &mut force);
        }
        for (q, start) in mean.q.iter_mut().zip(start) {
            *q = 0.5 * (*q + start);
        }
        self.system.external_force(&mean.q, mean.t, &mut mean.external);
        if moves {
            for (force, load) in force.iter_mut().zip(&mean.external) {
                *force -= load;
            }
            self.add_reactions(&force, mean);
        }
    }

    /// The strain energy of a state, and what supports exert in it.
    ///
    /// Accelerations are those that its forces give a flexible body: the integrator's may lag behind.
    pub fn reactions(&mut self, at: &Instantaneous) -> (StrainEnergy, Vec<Reaction>) {
        let mut force = vec![0.0; at.q.len()];
        let (strain, _) = self.internal(At::rest(&at.q), &at.v, &mut force);
        self.system.external_force(&at.q, at.t, &mut self.work);
        for (force, load) in force.iter_mut().zip(&self.work) {
            *force -= load;
        }
        let mut a = at.a.clone();
        if self.bodies == Bodies::Flexible && !self.system.model().supports().is_empty() {
            let model = self.system.model();
            for moved in model.moved() {
                [_, _, a[moved.coordinate]] = model.prescribed(moved, at.t);
            }
            self.balance(&force, &mut a);
        }
        self.inertia.add_product(&a, &mut force);
        (strain, self.system.reactions(&at.q, &force, self.bodies))
    }

    /// Adds the forces of moved supports to the external ones.
    fn add_reactions(&mut self, force: &[f64], at: &mut Instantaneous) {
        if self.moved().next().is_some() {
            let mut reaction = force.to_vec();
            self.inertia.add_product(&at.a, &mut reaction);
            for i in self.moved() {
                at.external[i] += reaction[i];
            }
        }
    }
}
