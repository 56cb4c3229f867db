//! The membrane energy of generalised strains.

use pulp::Simd;

use crate::lanes::{Lanes, Vector, axpy};
use crate::strain::{Form, Metric};

use super::constants::Couplings;
use super::kernel::{Batch, point_constants};
use super::patch::combination;
use super::projection::{MODES, POINTS, Projection, Row};
use super::sample::Sample;
use super::tables::Samples;
use super::totals::{Tangent, Totals};

/// Number of strain components.
const C: usize = 3;

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
    let patch = &samples.patches[0];
    let (constants, weights) = constants.split_at(POINTS * point_constants(C));
    let mut constants_of = [&constants[..0]; POINTS];
    for (part, constants) in constants_of.iter_mut().zip(constants.chunks_exact(point_constants(C))) {
        *part = constants;
    }

    let with_tangent = tangent.is_some();
    let mut at = [batch.sample::<Metric<S>, 2, C>(patch, 0, (), constants_of[0], with_tangent); POINTS];
    for g in 1..POINTS {
        at[g] = batch.sample::<Metric<S>, 2, C>(patch, g, (), constants_of[g], with_tangent);
    }
    let couplings = batch.couplings;
    let strain = amplitudes(zero, projection, &at, |sample| &sample.strain);
    let mut stress = conjugates(zero, couplings, weights, &strain);
    for k in 0..MODES {
        totals.energy[0] = (stress[k] * 0.5).mul_add(strain[k], totals.energy[0]);
    }
    if let Some(flow) = batch.flow {
        let rate = amplitudes(zero, projection, &at, |sample| &sample.rate);
        let missed = amplitudes(zero, projection, &at, |sample| &sample.missed);
        let viscous = conjugates(zero, couplings, weights, &rate);
        totals.add_rates(&stress, &viscous, &rate, &missed);
        for k in 0..MODES {
            stress[k] = viscous[k].scale_add(flow.factor, stress[k]);
        }
    }

    let on_points = at_points(zero, projection, &stress);
    let mut geometric = on_points;
    if with_tangent && batch.previous.is_some() {
        let strain = amplitudes(zero, projection, &at, |sample| sample.extrapolated.as_ref().unwrap_or(&sample.strain));
        geometric = at_points(zero, projection, &conjugates(zero, couplings, weights, &strain));
    }
    let mut tangent = tangent;
    for g in 0..POINTS {
        let form = tangent.as_deref_mut().map(|tangent| Form::new(&mut tangent.forms, POINTS, g));
        let added = Some([on_points[g], geometric[g]]);
        let force = batch.point::<Metric<S>, 2, C>(&at[g], (), constants_of[g], added, 0, totals, form);
        totals.on_gradients[2 * g..2 * g + 2].copy_from_slice(&force);
    }
    patch.add_forces(&totals.on_gradients, &mut totals.force);
    if let Some(tangent) = tangent {
        tangent.add_moments(&patch.moments, 3 * POINTS);
        let mut vectors = [[zero; 3]; 2 * POINTS];
        for g in 0..POINTS {
            vectors[2 * g..2 * g + 2].copy_from_slice(&at[g].gradients);
        }
        add_material(zero, projection, couplings, weights, &vectors, tangent);
    }
}

/// Adds the material stiffness `sum_kl row_k^T W_kl row_l`.
#[inline(always)]
fn add_material<S: Simd, const N: usize>(
    zero: Lanes<S>,
    projection: &Projection<N>,
    couplings: &Couplings,
    weights: &[Lanes<S>],
    vectors: &[Vector<S>; 2 * POINTS],
    tangent: &mut Tangent<S, N>,
) {
    let mut rows = [[[zero; 3]; MODES]; N];
    for b in 0..N {
        for row in &projection.rows[b] {
            rows[b][row.mode] = combination([zero; 3], &row.gradients, vectors);
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
            tangent.blocks[b][a] = sum;
        }
    }
}

/// The generalised strains of one of the strains of each sample.
#[inline(always)]
fn amplitudes<S: Simd, const N: usize>(
    zero: Lanes<S>,
    projection: &Projection<N>,
    at: &[Sample<S, 2, C>; POINTS],
    strain: impl Fn(&Sample<S, 2, C>) -> &[Lanes<S>; C],
) -> [Lanes<S>; MODES] {
    let mut amplitudes = [zero; MODES];
    for (amplitude, mode) in amplitudes.iter_mut().zip(&projection.modes) {
        let mut sum = zero;
        for &(g, weight) in &mode.basis {
            sum = strain(&at[g])[mode.component].scale_add(weight, sum);
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

/// The stresses at the sample points.
#[inline(always)]
fn at_points<S: Simd, const N: usize>(
    zero: Lanes<S>,
    projection: &Projection<N>,
    stress: &[Lanes<S>; MODES],
) -> [[Lanes<S>; C]; POINTS] {
    let mut at_points = [[zero; C]; POINTS];
    for (stress, mode) in stress.iter().zip(&projection.modes) {
        for &(g, weight) in &mode.basis {
            at_points[g][mode.component] = stress.scale_add(weight, at_points[g][mode.component]);
        }
    }
    at_points
}
