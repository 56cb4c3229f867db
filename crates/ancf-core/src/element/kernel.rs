//! Energy, force and tangent of several elements side by side, for every strain measure.
//!
//! Everything here is in the sums and differences over the corners of `corners`: coordinates, tables, forces, tangents.

use pulp::Simd;

use crate::lanes::{Lanes, Vector, table_axpy};
use crate::strain::{Block, Curvature, GreenLagrange, Measure, Metric};

use super::constants::Couplings;
use super::projected;
use super::tables::{Group, Patch, Samples, Tables};

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
pub(crate) struct Totals<S: Simd, const N: usize> {
    /// Membrane and bending energy; that of a solid counts as the first.
    pub energy: [Lanes<S>; 2],
    /// Power of a unit viscosity, and the energy that mean forces miss.
    pub rates: [Lanes<S>; 2],
    /// Force on each vector.
    pub force: [Vector<S>; N],
}

/// The tangent of a batch, which is added to.
pub(crate) struct Tangent<S: Simd, const N: usize> {
    /// `blocks[b][a]` for the vectors `a <= b`.
    pub blocks: [[Block<S>; N]; N],
    /// Stiffness of some samples with respect to their gradient vectors.
    forms: [Block<S>; AT_ONCE * MOST],
    /// The same with respect to their gradient vectors and one of the vectors.
    columns: [Block<S>; AT_ONCE],
}

/// Gradient vectors whose stiffness is kept at a time: what fits the first-level cache, and enough to make up for loading
/// and storing each block of the tangent once for them all.
pub(super) const AT_ONCE: usize = 16;

/// The most gradient vectors that a strain measure depends on.
const MOST: usize = 5;

impl<S: Simd, const N: usize> Totals<S, N> {
    /// Zeros.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        Self { energy: [zero; 2], rates: [zero; 2], force: [[zero; 3]; N] }
    }
}

impl<S: Simd, const N: usize> Tangent<S, N> {
    /// Zeros.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let none = [[Lanes::splat(simd, 0.0); 3]; 3];
        Self { blocks: [[none; N]; N], forms: [none; AT_ONCE * MOST], columns: [none; AT_ONCE] }
    }

    /// Back to zeros.
    #[inline(always)]
    pub fn clear(&mut self, simd: S) {
        let none = [[Lanes::splat(simd, 0.0); 3]; 3];
        for b in 0..N {
            self.blocks[b][..=b].fill(none);
        }
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
                    self.samples::<GreenLagrange<S>, 3, 6>(samples, (), own, 0, totals, tangent);
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
        let zero = Lanes::splat(self.simd, 0.0);
        let stride = point_constants(C);
        let groups = samples.tables.chunks(AT_ONCE / D).zip(constants.chunks(AT_ONCE / D * stride));
        for (patch, (tables, constants)) in samples.patches.iter().zip(groups) {
            let mut forces = [[zero; 3]; AT_ONCE];
            for (g, constants) in constants.chunks(stride).enumerate() {
                let area = constants[0];
                let mut reference = [zero; C];
                let mut weight = [[zero; C]; C];
                for c in 0..C {
                    reference[c] = constants[1 + c];
                    for other in 0..C {
                        weight[c][other] = constants[1 + C + c * C + other];
                    }
                }

                let with_tangent = tangent.is_some();
                let sample = self.sample::<M, D, C>(patch, g, law, area, reference, with_tangent);
                let measure = M::new(law, sample.gradients, area);
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
                forces[g * D..(g + 1) * D].copy_from_slice(&measure.forces(stress));

                if let Some(tangent) = &mut tangent {
                    let stress = sample.extrapolated.map_or(stress, |strain| times(&weight, strain));
                    let stress = stress.map(|s| s * self.geometric);
                    measure.stiffness(&weight, stress, &mut tangent.forms[g * D * D..(g + 1) * D * D]);
                }
            }
            patch.add_forces(&forces, &mut totals.force);
            if let Some(tangent) = &mut tangent {
                patch.add_forms(zero, tables, tangent);
            }
        }
    }

    /// A sample at a point of a patch.
    #[inline(always)]
    pub fn sample<M: Measure<S, D, C>, const D: usize, const C: usize>(
        &self,
        patch: &Patch<N>,
        point: usize,
        law: M::Law,
        area: Lanes<S>,
        reference: [Lanes<S>; C],
        with_tangent: bool,
    ) -> Sample<S, D, C> {
        let zero = Lanes::splat(self.simd, 0.0);
        let mut gradients = patch.gradients::<S, D>(point, self.current);
        let mut strain = M::new(law, gradients, area).strain();
        let mut extrapolated = self.previous.filter(|_| with_tangent).map(|previous| {
            let before = patch.gradients::<S, D>(point, previous);
            extrapolated::<S, M, D, C>(law, area, gradients, before)
        });
        let (mut rate, mut missed) = ([zero; C], [zero; C]);
        if let Some(start) = self.start {
            let first = patch.gradients::<S, D>(point, start);
            for d in 0..D {
                gradients[d] = mean(gradients[d], first[d]);
            }
            let first = M::new(law, first, area).strain();
            missed = difference(strain, first);
            strain = mean(strain, first);
            extrapolated = extrapolated.map(|extrapolated| mean(extrapolated, first));
        }
        strain = difference(strain, reference);
        extrapolated = extrapolated.map(|extrapolated| difference(extrapolated, reference));
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

impl<const N: usize> Patch<N> {
    /// The gradient vectors at a point.
    #[inline(always)]
    pub fn gradients<S: Simd, const D: usize>(&self, point: usize, vectors: &[Vector<S>; N]) -> [Vector<S>; D] {
        let zero = vectors[0][0].like(0.0);
        let mut gradients = [[zero; 3]; D];
        for d in 0..D {
            gradients[d] = combination(zero, &self.gradients[point * D + d], vectors);
        }
        gradients
    }

    /// Adds the forces on the vectors that the forces on the gradient vectors make.
    #[inline(always)]
    pub fn add_forces<S: Simd>(&self, forces: &[Vector<S>], totals: &mut [Vector<S>; N]) {
        for a in 0..N {
            let force = combination(totals[a][0].like(0.0), &self.functions[a], forces);
            for i in 0..3 {
                totals[a][i] = totals[a][i] + force[i];
            }
        }
    }

    /// Adds the stiffness of the points, `sum_de table_d,a form_de table_e,b`.
    #[inline(always)]
    fn add_forms<S: Simd, const D: usize>(
        &self,
        zero: Lanes<S>,
        tables: &[[[f64; N]; D]],
        Tangent { blocks, forms, columns }: &mut Tangent<S, N>,
    ) {
        for b in 0..N {
            for (table, (form, columns)) in tables.iter().zip(forms.chunks(D * D).zip(columns.chunks_mut(D))) {
                for d in 0..D {
                    let mut sum = [[zero; 3]; 3];
                    for e in 0..D {
                        let factor = table[e][b];
                        if factor != 0.0 {
                            let block = &form[if d <= e { d * D + e } else { e * D + d }];
                            for i in 0..3 {
                                for j in 0..3 {
                                    let entry = if d <= e { block[i][j] } else { block[j][i] };
                                    sum[i][j] = entry.scale_add(factor, sum[i][j]);
                                }
                            }
                        }
                    }
                    columns[d] = sum;
                }
            }
            for a in 0..=b {
                let mut sum = blocks[b][a];
                for &(gradient, factor) in &self.functions[a] {
                    for i in 0..3 {
                        sum[i] = table_axpy(factor, columns[gradient][i], sum[i]);
                    }
                }
                blocks[b][a] = sum;
            }
        }
    }
}

/// `sum factor_i vectors_i` over the entries `(i, factor_i)`.
#[inline(always)]
pub(super) fn combination<S: Simd>(zero: Lanes<S>, entries: &[(usize, f64)], vectors: &[Vector<S>]) -> Vector<S> {
    let mut sum = [zero; 3];
    for &(i, factor) in entries {
        sum = table_axpy(factor, vectors[i], sum);
    }
    sum
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
