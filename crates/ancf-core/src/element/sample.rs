//! Strain samples: the strain at a point, and what a step or a correction makes of it.

use pulp::Simd;

use crate::lanes::{Lanes, Vector};
use crate::strain::Measure;

use super::kernel::Batch;
use super::patch::Patch;

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

impl<S: Simd, const N: usize> Batch<'_, S, N> {
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

/// `(a + b) / 2`.
#[inline(always)]
fn mean<S: Simd, const C: usize>(a: [Lanes<S>; C], b: [Lanes<S>; C]) -> [Lanes<S>; C] {
    let mut mean = a;
    for c in 0..C {
        mean[c] = (a[c] + b[c]) * 0.5;
    }
    mean
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

/// `a - b`.
#[inline(always)]
pub(super) fn difference<S: Simd, const C: usize>(a: [Lanes<S>; C], b: [Lanes<S>; C]) -> [Lanes<S>; C] {
    let mut difference = a;
    for c in 0..C {
        difference[c] = a[c] - b[c];
    }
    difference
}
