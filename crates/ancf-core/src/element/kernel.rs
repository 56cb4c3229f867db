//! Energy, force and tangent of several elements side by side, for every strain measure.
//!
//! Everything here is in the sums and differences over the corners of `corners`: coordinates, tables, forces, tangents.

use pulp::Simd;

use crate::lanes::{Lanes, Vector};
use crate::strain::{Block, Curvature, Form, GreenLagrange, Measure, Metric, SOLID_PAIRS};

use super::constants::Couplings;
use super::moments::Moments;
use super::patch::Patch;
use super::projected;
use super::tables::{Group, Samples, Tables};

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

/// What a strain sample is in the state of a batch.
#[derive(Clone, Copy)]
pub(super) struct Sample<S: Simd, const D: usize, const C: usize> {
    /// The gradient vectors on which forces act: those of the mean state for mean forces.
    pub gradients: [Vector<S>; D],
    /// The strain, or its mean over the step, less the reference.
    pub strain: [Lanes<S>; C],
    /// The rate of the strain.
    pub rate: [Lanes<S>; C],
    /// The change of the strain over the step less what the rate makes of it.
    pub missed: [Lanes<S>; C],
    /// The strain that the last correction would have led to in a linear problem, less the reference, the viscous share
    /// included.
    pub extrapolated: Option<[Lanes<S>; C]>,
}

/// What a batch gives; each part is added to.
#[repr(C, align(64))]
pub(crate) struct Totals<S: Simd, const N: usize> {
    /// Force on each vector.
    pub force: [Vector<S>; N],
    /// Membrane and bending energy: of a solid that of strains which are odd across the thickness is the second, all else the
    /// first.
    pub energy: [Lanes<S>; 2],
    /// Power of a unit viscosity, and the energy that mean forces miss.
    pub rates: [Lanes<S>; 2],
    /// Forces on the gradient vectors of a patch, which become those on the nodal vectors.
    pub(super) on_gradients: [Vector<S>; MOST_GRADIENTS],
}

/// The tangent of a batch, which is added to.
#[repr(C, align(64))]
pub(crate) struct Tangent<S: Simd, const N: usize> {
    /// `blocks[b][a]` for the vectors `a <= b`, unless `empty`.
    pub blocks: [[Block<S>; N]; N],
    /// Stiffness of the points of a patch with respect to their gradient vectors; in the end the tangent by pairs of
    /// corners.
    pub(super) forms: [Block<S>; MOST_PAIRS],
    /// Whether nothing has been added.
    pub empty: bool,
}

/// The most gradient vectors of a patch: two at 4 x 4 points, three for a solid.
pub(super) const MOST_GRADIENTS: usize = 48;

/// Number of strain components of a solid.
const SOLID: usize = SOLID_PAIRS.len();

/// Number of points in each of its two layers.
const SOLID_LAYER: usize = 16;

/// The most pairs of gradient vectors at the points of a patch, 135 for the curvature at 3 x 3 points, and the tangent of
/// 16 vectors, 160 blocks.
const MOST_PAIRS: usize = 160;

impl<S: Simd, const N: usize> Totals<S, N> {
    /// Zeros.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        Self { energy: [zero; 2], rates: [zero; 2], force: [[zero; 3]; N], on_gradients: [[zero; 3]; MOST_GRADIENTS] }
    }

    /// Zeros again.
    #[inline(always)]
    pub fn clear(&mut self, simd: S) {
        let zero = Lanes::splat(simd, 0.0);
        self.energy.fill(zero);
        self.rates.fill(zero);
        self.force.fill([zero; 3]);
    }
}

impl<S: Simd, const N: usize> Tangent<S, N> {
    /// Zeros.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let none = [[Lanes::splat(simd, 0.0); 3]; 3];
        Self { blocks: [[none; N]; N], forms: [none; MOST_PAIRS], empty: true }
    }

    /// Adds what the stiffness of the points in the first `count` of `forms` makes.
    #[inline(always)]
    pub(super) fn add_moments(&mut self, moments: &Moments, count: usize) {
        let Self { blocks, forms, empty } = self;
        if *empty {
            moments.add::<S, N, true>(&mut forms[..count], blocks);
        } else {
            moments.add::<S, N, false>(&mut forms[..count], blocks);
        }
        *empty = false;
    }
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

    /// A sample at a point of a patch.
    #[inline(always)]
    pub fn sample<M: Measure<S, D, C>, const D: usize, const C: usize>(
        &self,
        patch: &Patch<N>,
        point: usize,
        law: M::Law,
        constants: &[Lanes<S>],
        with_tangent: bool,
    ) -> Sample<S, D, C> {
        let zero = Lanes::splat(self.simd, 0.0);
        let area = constants[0];
        let mut reference = [zero; C];
        reference.copy_from_slice(&constants[1..1 + C]);
        let mut gradients = patch.gradients::<S, D>(point, self.current);
        let mut strain = M::new(law, gradients, area).strain();
        let mut extrapolated = None;
        if let (Some(previous), true) = (self.previous, with_tangent) {
            let before = patch.gradients::<S, D>(point, previous);
            extrapolated = Some(self::extrapolated::<S, M, D, C>(law, area, gradients, before));
        }
        let (mut rate, mut missed) = ([zero; C], [zero; C]);
        if let Some(start) = self.start {
            let first = patch.gradients::<S, D>(point, start);
            for d in 0..D {
                gradients[d] = mean(gradients[d], first[d]);
            }
            let first = M::new(law, first, area).strain();
            missed = difference(strain, first);
            strain = mean(strain, first);
            if let Some(extrapolated) = &mut extrapolated {
                *extrapolated = mean(*extrapolated, first);
            }
        }
        strain = difference(strain, reference);
        if let Some(extrapolated) = &mut extrapolated {
            *extrapolated = difference(*extrapolated, reference);
        }
        if let Some(flow) = self.flow {
            rate = M::new(law, gradients, area).change(&patch.gradients::<S, D>(point, flow.velocity));
            for c in 0..C {
                missed[c] = missed[c] - rate[c] * (1.0 / flow.rate);
                if let Some(extrapolated) = &mut extrapolated {
                    extrapolated[c] = rate[c].scale_add(flow.factor, extrapolated[c]);
                }
            }
        }
        Sample { gradients, strain, rate, missed, extrapolated }
    }
}

impl<S: Simd, const N: usize> Totals<S, N> {
    /// Counts the energy of the part of a solid's strain that is odd across the thickness as bending: `twice` that part,
    /// at two points on top of each other with the constants `below` and `above`.
    #[inline(always)]
    fn split<const C: usize>(&mut self, below: &[Lanes<S>], above: &[Lanes<S>], twice: [Lanes<S>; C]) {
        let weights = (&below[1 + C..], &above[1 + C..]);
        for i in 0..C {
            for j in 0..C {
                let energy = (weights.0[C * i + j] + weights.1[C * i + j]) * twice[j] * twice[i] * 0.125;
                self.energy[0] = self.energy[0] - energy;
                self.energy[1] = self.energy[1] + energy;
            }
        }
    }

    /// Adds what strain rates do: `viscous` is their stress for a unit viscosity, `stress` the elastic one.
    #[inline(always)]
    pub fn add_rates(&mut self, stress: &[Lanes<S>], viscous: &[Lanes<S>], rate: &[Lanes<S>], missed: &[Lanes<S>]) {
        for k in 0..rate.len() {
            self.rates[0] = viscous[k].mul_add(rate[k], self.rates[0]);
            self.rates[1] = stress[k].mul_add(missed[k], self.rates[1]);
        }
    }
}

/// `(a + b) / 2`.
#[inline(always)]
fn mean<S: Simd, const C: usize>(a: [Lanes<S>; C], b: [Lanes<S>; C]) -> [Lanes<S>; C] {
    let mut mean = a;
    for c in 0..C {
        mean[c] = (a[c] + b[c]) * 0.5;
    }
    mean
}

/// Number of constants of a point: the reference area stretch, the reference strain and the weight.
pub(crate) const fn point_constants(components: usize) -> usize {
    1 + components + components * components
}

/// The strain that the last correction would have led to in a linear problem.
///
/// # Source
///
/// Magisano, Leonetti and Garcea (2017): mixed-integration-point Newton.
#[inline(always)]
fn extrapolated<S: Simd, M: Measure<S, D, C>, const D: usize, const C: usize>(
    law: M::Law,
    area: Lanes<S>,
    gradients: [Vector<S>; D],
    before: [Vector<S>; D],
) -> [Lanes<S>; C] {
    let mut step = gradients;
    for d in 0..D {
        step[d] = difference(gradients[d], before[d]);
    }
    let start = M::new(law, before, area);
    let mut strain = start.strain();
    let change = start.change(&step);
    for c in 0..C {
        strain[c] = strain[c] + change[c];
    }
    strain
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

/// `a - b`.
#[inline(always)]
pub(super) fn difference<S: Simd, const C: usize>(a: [Lanes<S>; C], b: [Lanes<S>; C]) -> [Lanes<S>; C] {
    let mut difference = a;
    for c in 0..C {
        difference[c] = a[c] - b[c];
    }
    difference
}
