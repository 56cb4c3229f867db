//! Energy, force and tangent of several elements side by side, for every strain measure.
//!
//! Everything here is in the sums and differences over the corners of `corners`: coordinates, tables, forces, tangents.

use pulp::Simd;

use crate::lanes::{Lanes, Vector};
use crate::strain::{Curvature, Form, GreenLagrange, Measure, Metric, SOLID_PAIRS};

use super::constants::Couplings;
use super::projected;
use super::sample::{Sample, difference};
use super::tables::{Group, Samples, Tables};
use super::totals::{Tangent, Totals};

/// Number of strain components of a solid.
const SOLID: usize = SOLID_PAIRS.len();

/// Number of points in each of its two layers.
const SOLID_LAYER: usize = 16;

/// A batch of elements that share their tables.
pub(crate) struct Batch<'a, S: Simd, const N: usize> {
    pub simd: S,
    pub tables: &'a Tables<N>,
    pub couplings: &'a Couplings,
    pub constants: &'a [Lanes<S>],
    /// The vectors of the current state.
    pub current: &'a [Vector<S>; N],
    /// The vectors of the state before the last Newton correction, when the geometric stiffness is to use the stress
    /// extrapolated from there instead of the current one.
    pub previous: Option<&'a [Vector<S>; N]>,
    /// The vectors at the start of the step, when mean forces over it are wanted.
    pub start: Option<&'a [Vector<S>; N]>,
    /// Velocities and viscosity.
    pub flow: Option<Flow<'a, S, N>>,
    /// Share of the geometric stiffness in the tangent, relative to that of the material stiffness.
    pub geometric: f64,
}

/// Velocities that cause viscous stress.
#[derive(Clone, Copy)]
pub(crate) struct Flow<'a, S: Simd, const N: usize> {
    pub velocity: &'a [Vector<S>; N],
    /// Viscosity, s.
    pub factor: f64,
    /// Derivative of the velocities with respect to the nodal vectors, 1/s.
    pub rate: f64,
}

impl<S: Simd, const N: usize> Batch<'_, S, N> {
    /// Adds energy, force and, if it is wanted, the tangent of the batch.
    #[inline(always)]
    pub fn evaluate(&self, totals: &mut Totals<S, N>, mut tangent: Option<&mut Tangent<S, N>>) {
        let mut constants = self.constants;
        for group in &self.tables.groups {
            let (own, rest) = constants.split_at(group.constants());
            constants = rest;
            let tangent = tangent.as_deref_mut();
            match group {
                Group::Membrane(samples) => self.samples::<Metric<S>, 2, 3>(samples, (), own, 0, totals, tangent),
                Group::Projected(samples, projection) => {
                    projected::add(self, samples, projection, own, totals, tangent);
                }
                Group::Bending(samples, law) => {
                    self.samples::<Curvature<S>, 5, 3>(samples, *law, own, 1, totals, tangent);
                }
                Group::Solid(samples) => {
                    self.samples::<GreenLagrange<S>, 3, SOLID>(samples, (), own, 0, totals, tangent);
                }
            }
        }
    }

    /// The same for samples that are weighted point by point.
    #[inline(always)]
    fn samples<M: Measure<S, D, C>, const D: usize, const C: usize>(
        &self,
        samples: &Samples<N, D>,
        law: M::Law,
        constants: &[Lanes<S>],
        part: usize,
        totals: &mut Totals<S, N>,
        mut tangent: Option<&mut Tangent<S, N>>,
    ) {
        let first = constants;
        let mut constants = constants.chunks_exact(point_constants(C));
        // Strains of the first of a solid's two layers of points.
        let mut below = if C == SOLID { Some([[first[0]; C]; SOLID_LAYER]) } else { None };
        for (layer, patch) in samples.patches.iter().enumerate() {
            for (g, constants) in constants.by_ref().take(patch.points).enumerate() {
                let sample = self.sample::<M, D, C>(patch, g, law, constants, tangent.is_some());
                match &mut below {
                    Some(below) if layer == 0 => below[g] = sample.strain,
                    Some(below) => {
                        let first = &first[g * constants.len()..][..constants.len()];
                        totals.split(first, constants, difference(sample.strain, below[g]));
                    }
                    None => {}
                }
                let form = tangent.as_deref_mut().map(|tangent| Form::new(&mut tangent.forms, patch.points, g));
                let force = self.point::<M, D, C>(&sample, law, constants, None, part, totals, form);
                totals.on_gradients[g * D..(g + 1) * D].copy_from_slice(&force);
            }
            patch.add_forces(&totals.on_gradients, &mut totals.force);
            if let Some(tangent) = tangent.as_deref_mut() {
                tangent.add_moments(&patch.moments, D * (D + 1) / 2 * patch.points);
            }
        }
    }

    /// Adds the energy of a sample, gives the forces on its gradient vectors and sets its stiffness; `added` is stress that
    /// comes from elsewhere, for the forces and for the geometric stiffness.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "what a sample needs, and where its parts go")]
    pub fn point<M: Measure<S, D, C>, const D: usize, const C: usize>(
        &self,
        sample: &Sample<S, D, C>,
        law: M::Law,
        constants: &[Lanes<S>],
        added: Option<[[Lanes<S>; C]; 2]>,
        part: usize,
        totals: &mut Totals<S, N>,
        form: Option<Form<'_, S>>,
    ) -> [Vector<S>; D] {
        let weights = &constants[1 + C..];
        let mut weight = [[constants[0]; C]; C];
        for c in 0..C {
            weight[c].copy_from_slice(&weights[c * C..(c + 1) * C]);
        }
        let measure = M::new(law, sample.gradients, constants[0]);
        let mut stress = times(&weight, sample.strain);
        for c in 0..C {
            totals.energy[part] = (stress[c] * 0.5).mul_add(sample.strain[c], totals.energy[part]);
        }
        if let Some(flow) = self.flow {
            let viscous = times(&weight, sample.rate);
            totals.add_rates(&stress, &viscous, &sample.rate, &sample.missed);
            for c in 0..C {
                stress[c] = viscous[c].scale_add(flow.factor, stress[c]);
            }
        }
        if let Some(form) = form {
            let mut stress = match sample.extrapolated {
                Some(strain) => times(&weight, strain),
                None => stress,
            };
            for c in 0..C {
                if let Some([_, added]) = added {
                    stress[c] = stress[c] + added[c];
                }
                stress[c] = stress[c] * self.geometric;
            }
            measure.stiffness(&weight, stress, form);
        }
        if let Some([added, _]) = added {
            for c in 0..C {
                stress[c] = stress[c] + added[c];
            }
        }
        measure.forces(stress)
    }
}

/// Number of constants of a point: the reference area stretch, the reference strain and the weight.
pub(crate) const fn point_constants(components: usize) -> usize {
    1 + components + components * components
}

/// `weight strain`.
#[inline(always)]
fn times<S: Simd, const C: usize>(weight: &[[Lanes<S>; C]; C], strain: [Lanes<S>; C]) -> [Lanes<S>; C] {
    let mut stress = strain;
    for c in 0..C {
        stress[c] = weight[c][0] * strain[0];
        for other in 1..C {
            stress[c] = weight[c][other].mul_add(strain[other], stress[c]);
        }
    }
    stress
}
