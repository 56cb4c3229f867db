//! The highest frequency of a model, which limits explicit steps.

use crate::assembly::System;
use crate::element::Want;
use crate::linear::multiply_add;

use super::inertia::Inertia;

/// Iterations after which the estimate is taken as it is.
const MOST: usize = 300;

/// The highest frequency (rad/s) of small oscillations about a state, by Lanczos's iteration with `M^-1 K`, from below,
/// taken as found when an iteration changes its square by less than `precision`, relative to it.
///
/// # Source
///
/// Golub and Van Loan, Matrix Computations (2013), 10.1, in the inner product of the mass matrix.
pub(super) fn highest_frequency(system: &mut System, inertia: &mut Inertia, t: f64, q: &[f64], precision: f64) -> f64 {
    let mut force = vec![0.0; q.len()];
    let want = Want { mass: 0.0, stiffness: 1.0, previous: None };
    system.assemble(q, t, want, &mut force);
    let ((pattern, stiffness), free) = (system.tangent(), system.free());
    let of_free = |x: &[f64], factor: f64| -> Vec<f64> { free.iter().map(|&k| factor * x[k]).collect() };
    // Numbers without a pattern, so that no mode is missed; a linear congruential generator with Knuth's constants.
    let mut seed = 1_u64;
    let mut x = vec![0.0; q.len()];
    for &coordinate in free {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        x[coordinate] = (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
    }
    let mut momentum = vec![0.0; q.len()];
    inertia.add_product(&x, &mut momentum);
    let norm = x.iter().zip(&momentum).map(|(x, p)| x * p).sum::<f64>().sqrt();
    let (mut v, mut p, mut p_before) = (of_free(&x, 1.0 / norm), of_free(&momentum, 1.0 / norm), vec![0.0; free.len()]);
    let (mut diagonal, mut beside, mut beta, mut squared) = (Vec::new(), Vec::new(), 0.0, 0.0);
    force.fill(0.0);
    for _ in 0..MOST.min(free.len()) {
        let mut r = vec![0.0; free.len()];
        multiply_add::<1>(pattern, stiffness, &v, &mut r);
        let alpha = dot(&v, &r);
        for ((r, p), before) in r.iter_mut().zip(&p).zip(&p_before) {
            *r -= alpha * p + beta * before;
        }
        diagonal.push(alpha);
        let last = squared;
        squared = highest_eigenvalue(&diagonal, &beside, 0.1 * precision);
        if (squared - last).abs() <= precision * squared.abs() {
            break;
        }
        for (coordinate, r) in free.iter().zip(&r) {
            force[*coordinate] = *r;
        }
        inertia.solve(&force, &mut x);
        v = of_free(&x, 1.0);
        beta = dot(&v, &r).max(0.0).sqrt();
        if beta <= f64::EPSILON * squared.abs() {
            break;
        }
        beside.push(beta);
        v.iter_mut().for_each(|v| *v /= beta);
        r.iter_mut().for_each(|r| *r /= beta);
        p_before = std::mem::replace(&mut p, r);
    }
    squared.max(0.0).sqrt()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The highest eigenvalue of a symmetric tridiagonal matrix to a relative precision, by bisection: above it all pivots are
/// negative.
///
/// # Source
///
/// Golub and Van Loan, Matrix Computations (2013), 8.4.1.
fn highest_eigenvalue(diagonal: &[f64], beside: &[f64], precision: f64) -> f64 {
    let side = |i: usize| beside.get(i).map_or(0.0, |b| b.abs());
    let row = |i: usize| diagonal[i] + side(i) + if i > 0 { side(i - 1) } else { 0.0 };
    let mut low = diagonal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut high = (0..diagonal.len()).map(row).fold(low, f64::max);
    while high - low > precision * high.abs() {
        let middle = 0.5 * (low + high);
        let mut pivot = f64::NEG_INFINITY;
        let above = diagonal.iter().enumerate().all(|(i, d)| {
            let b = if i > 0 { side(i - 1) } else { 0.0 };
            pivot = d - middle - b * b / pivot;
            pivot < 0.0
        });
        if above { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The matrix of a chain of equal springs has eigenvalues in closed form.
    #[test]
    fn the_highest_eigenvalue_of_a_chain_is_known() {
        for n in [1, 2, 7, 50] {
            let angle = std::f64::consts::PI / (n + 1) as f64;
            let found = highest_eigenvalue(&vec![2.0; n], &vec![-1.0; n - 1], 1e-7);
            assert!((found / (2.0 + 2.0 * angle.cos()) - 1.0).abs() < 1e-6, "{n}: {found}");
        }
    }
}
