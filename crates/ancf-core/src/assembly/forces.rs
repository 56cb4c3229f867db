//! Forces and tangents: elements evaluated and summed.

use std::time::Instant;

use crate::element::{At, Portion, Want};
use crate::material::Damping;
use crate::model::History;

use super::System;
use super::totals::{StrainEnergy, StrainRates};

impl System {
    /// Elastic force `Q_k` on all coordinates, and the strain energy.
    ///
    /// # Source
    ///
    /// Dufva and Shabana (2005), (25), (35).
    pub fn internal_force(&mut self, q: &[f64], force: &mut [f64]) -> StrainEnergy {
        self.force(At::rest(q), force)
    }

    /// Elastic and viscous force on all coordinates, and the strain energy.
    pub fn force(&mut self, at: At<'_>, force: &mut [f64]) -> StrainEnergy {
        self.evaluate(at, None, force)
    }

    /// Force of the loads `Q_e` on all coordinates at time (or load factor) `t`.
    pub fn external_force(&self, q: &[f64], t: f64, force: &mut [f64]) {
        self.sum_loads(|history| history.factor(t), q, force);
    }

    /// Derivative of [`external_force`](Self::external_force) with respect to `t`, just after it.
    pub fn external_force_rate(&self, q: &[f64], t: f64, force: &mut [f64]) {
        self.sum_loads(|history| history.rate(t), q, force);
    }

    /// The loads, each times a number that its history gives.
    fn sum_loads(&self, factor: impl Fn(&History) -> f64, q: &[f64], force: &mut [f64]) {
        self.loads.sum(&self.blocks, self.model.reference(), q, factor, force);
    }

    /// Work of the loads, held as they are at `t`, on the way between two states whose coordinates change at the rates
    /// `p0` and `p1` there, per unit of a parameter that runs from 0 to 1.
    ///
    /// Exact for dead loads. For a follower it is that of the mean force on the straight way, unless the rates of work
    /// at both ends bound it: a moment that turns an edge does the same work in each part of the way, and the straight
    /// way is too short.
    pub(crate) fn work(&self, t: f64, ends: [&[f64]; 2], rates: [&[f64]; 2]) -> f64 {
        self.loads.work(&self.blocks, self.model.reference(), t, ends, rates)
    }

    /// The tangent of elastic forces at rest, as [`assemble_at`](Self::assemble_at).
    pub fn assemble(&mut self, q: &[f64], t: f64, want: Want<'_>, force: &mut [f64]) -> StrainEnergy {
        self.assemble_at(At::rest(q), t, want, force)
    }

    /// Forces as [`force`](Self::force), and the tangent `want.mass M + want.stiffness (dQ_k/dq - dQ_e/dq)`, damping
    /// included, which is kept for [`factorize`](Self::factorize). It is symmetric: of loads that follow the surface it
    /// has the symmetric half, of viscous and mean forces what stays when `B` does not change within a step.
    pub fn assemble_at(&mut self, at: At<'_>, t: f64, want: Want<'_>, force: &mut [f64]) -> StrainEnergy {
        if self.loads.follow() {
            let factors = self.loads.follower_factors(t).map(|factor| want.stiffness * factor).collect();
            self.tangent_at = (at.q.to_vec(), factors);
        }
        self.evaluate(at, Some(want), force)
    }

    /// Evaluates and sums forces, and the tangent if it is wanted.
    fn evaluate(&mut self, at: At<'_>, want: Option<Want<'_>>, force: &mut [f64]) -> StrainEnergy {
        let start = Instant::now();
        self.forces += 1;
        let Self { blocks, loads, model, tangent_at, .. } = self;
        let followers = want.is_some() && loads.follow();
        let evaluate = |block: usize, elements: &[u32], take: &mut dyn FnMut(Portion<'_>)| {
            blocks[block].evaluate(elements, at, want, &mut |mut portion| {
                if followers {
                    loads.subtract_stiffness(blocks, block, model.reference(), at.q, &tangent_at.1, &mut portion);
                }
                take(portion);
            });
        };
        let values = want.map(|_| self.values.as_mut_slice());
        self.timers.scatter += self.scatter.sum(evaluate, values, &mut self.ordered, force, &mut self.subtotals);
        self.timers.assembly += start.elapsed();

        let mut energy = StrainEnergy::default();
        for [membrane, bending] in self.subtotals.iter().flat_map(|subtotal| &subtotal.energy) {
            energy.membrane += membrane;
            energy.bending += bending;
        }
        energy
    }

    /// Strain rates of the forces that were evaluated last, at the velocities given there.
    pub fn strain_rates(&self) -> StrainRates {
        let mut rates = StrainRates::default();
        for subtotal in &self.subtotals {
            for (block, [square, missed]) in self.blocks.iter().zip(&subtotal.rates) {
                rates.power += block.damping().viscosity * square;
                rates.square += square;
                rates.missed += missed;
            }
        }
        rates
    }

    /// Whether any material is damped.
    pub fn is_damped(&self) -> bool {
        self.blocks.iter().any(|block| block.damping() != Damping::default())
    }
}
