//! The membrane energy of generalised strains.

use pulp::Simd;

use crate::lanes::{Lanes, Vector, axpy};
use crate::strain::{Measure, Metric, packed};

use super::constants::Couplings;
use super::kernel::{AT_ONCE, Batch, Tangent, Totals, combination};
use super::projection::{MODES, POINTS, Projection, Row};
use super::tables::Samples;

/// Number of strain components.
const C: usize = 3;

/// Number of sample points of a patch.
const PATCH: usize = AT_ONCE / 2;

/// Adds energy, force and, if it is wanted, the tangent.
#[inline(always)]
pub(super) fn add<S: Simd, const N: usize>(
    batch: &Batch<'_, S, N>,
    samples: &Samples<N, 2>,
    projection: &Projection<N>,
    constants: &[Lanes<S>],
    totals: &mut Totals<S, N>,
    tangent: Option<&mut Tangent<S, N>>,
) {
    let zero = Lanes::splat(batch.simd, 0.0);
    let (references, weights) = constants.split_at(POINTS * C);
    let reference = |g: usize| [references[g * C], references[g * C + 1], references[g * C + 2]];

    let mut vectors = [[zero; 3]; 2 * POINTS];
    let [mut strain, mut rate, mut missed, mut extrapolated] = [[[zero; C]; POINTS]; 4];
    let with_tangent = tangent.is_some();
    for g in 0..POINTS {
        let patch = &samples.patches[g / PATCH];
        let sample = batch.sample::<Metric<S>, 2, C>(patch, g % PATCH, (), zero, reference(g), with_tangent);
        [vectors[2 * g], vectors[2 * g + 1]] = sample.gradients;
        (strain[g], rate[g], missed[g]) = (sample.strain, sample.rate, sample.missed);
        extrapolated[g] = sample.extrapolated.unwrap_or(strain[g]);
    }
    let amplitudes = |strain: &[[Lanes<S>; C]; POINTS]| self::amplitudes(zero, projection, strain);
    let conjugates = |amplitudes: &[Lanes<S>; MODES]| conjugates(zero, batch.couplings, weights, amplitudes);
    let strain = amplitudes(&strain);
    let mut stress = conjugates(&strain);
    for k in 0..MODES {
        totals.energy[0] = (stress[k] * 0.5).mul_add(strain[k], totals.energy[0]);
    }
    if let Some(flow) = batch.flow {
        let rate = amplitudes(&rate);
        let viscous = conjugates(&rate);
        totals.add_rates(&stress, &viscous, &rate, &amplitudes(&missed));
        for k in 0..MODES {
            stress[k] = viscous[k].scale_add(flow.factor, stress[k]);
        }
    }

    let mut at_points = [[zero; C]; POINTS];
    for (conjugate, mode) in stress.iter().zip(&projection.modes) {
        for &(g, weight) in &mode.basis {
            at_points[g][mode.component] = conjugate.scale_add(weight, at_points[g][mode.component]);
        }
    }
    let mut forces = [[zero; 3]; 2 * POINTS];
    for g in 0..POINTS {
        let measure = Metric::new((), [vectors[2 * g], vectors[2 * g + 1]], zero);
        [forces[2 * g], forces[2 * g + 1]] = measure.forces(at_points[g]);
    }
    for (patch, forces) in samples.patches.iter().zip(forces.chunks(AT_ONCE)) {
        patch.add_forces(forces, &mut totals.force);
    }

    if let Some(tangent) = tangent {
        if batch.previous.is_some() {
            stress = conjugates(&amplitudes(&extrapolated));
        }
        let stress = stress.map(|s| s * batch.geometric);
        add_tangent(zero, projection, batch.couplings, weights, &vectors, &stress, tangent);
    }
}

/// Adds `sum_kl row_k^T W_kl row_l` and the second derivatives times their stress.
#[inline(always)]
fn add_tangent<S: Simd, const N: usize>(
    zero: Lanes<S>,
    projection: &Projection<N>,
    couplings: &Couplings,
    weights: &[Lanes<S>],
    vectors: &[Vector<S>; 2 * POINTS],
    stress: &[Lanes<S>; MODES],
    tangent: &mut Tangent<S, N>,
) {
    let mut rows = [[[zero; 3]; MODES]; N];
    for b in 0..N {
        for row in &projection.rows[b] {
            rows[b][row.mode] = combination(zero, &row.gradients, vectors);
        }
        let mut weighted = [[zero; 3]; MODES];
        for (target, couplings) in weighted.iter_mut().zip(couplings) {
            let mut sum = [zero; 3];
            for &(l, position) in couplings {
                sum = axpy(weights[position], rows[b][l], sum);
            }
            *target = sum;
        }
        for a in 0..=b {
            let mut sum = tangent.blocks[b][a];
            for &Row { mode, .. } in &projection.rows[a] {
                for i in 0..3 {
                    sum[i] = axpy(rows[a][mode][i], weighted[mode], sum[i]);
                }
            }
            let mut geometric = zero;
            for &(mode, factor) in &projection.second[packed(a, b)] {
                geometric = stress[mode].scale_add(factor, geometric);
            }
            for i in 0..3 {
                sum[i][i] = sum[i][i] + geometric;
            }
            tangent.blocks[b][a] = sum;
        }
    }
}

/// The generalised strains.
#[inline(always)]
fn amplitudes<S: Simd, const N: usize>(
    zero: Lanes<S>,
    projection: &Projection<N>,
    strain: &[[Lanes<S>; C]; POINTS],
) -> [Lanes<S>; MODES] {
    let mut amplitudes = [zero; MODES];
    for (amplitude, mode) in amplitudes.iter_mut().zip(&projection.modes) {
        let mut sum = zero;
        for &(g, weight) in &mode.basis {
            sum = strain[g][mode.component].scale_add(weight, sum);
        }
        *amplitude = sum;
    }
    amplitudes
}

/// The generalised stresses.
#[inline(always)]
fn conjugates<S: Simd>(
    zero: Lanes<S>,
    couplings: &Couplings,
    weights: &[Lanes<S>],
    amplitudes: &[Lanes<S>; MODES],
) -> [Lanes<S>; MODES] {
    let mut conjugates = [zero; MODES];
    for (conjugate, couplings) in conjugates.iter_mut().zip(couplings) {
        let mut sum = zero;
        for &(l, position) in couplings {
            sum = weights[position].mul_add(amplitudes[l], sum);
        }
        *conjugate = sum;
    }
    conjugates
}
