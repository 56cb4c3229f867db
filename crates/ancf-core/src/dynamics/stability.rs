//! The highest frequency of a model, which limits explicit steps.

use crate::linear::dot;

use super::equations::Equations;

/// Iterations after which the estimate is taken as it is.
const MOST: usize = 300;

/// How far a state is moved for a difference of forces, relative to the size of the body: between what their curvature
/// makes of longer ways and rounding of shorter ones.
const DISTANCE: f64 = 1e-8;

/// The highest frequency (rad/s) of small oscillations about a state, by Lanczos's iteration with `M^-1 K`, from below,
/// taken as found when an iteration changes its square by less than `precision`, relative to it.
///
/// Products with the tangent `K` are differences of forces: few are needed, and they cost less than the tangent.
///
/// # Source
///
/// Golub and Van Loan, Matrix Computations (2013), 10.1, in the inner product of the mass matrix.
pub(super) fn highest_frequency(equations: &mut Equations<'_>, t: f64, q: &[f64], precision: f64) -> f64 {
    let n = q.len();
    let mut force = vec![0.0; n];
    equations.force_at_rest(t, q, &mut force);
    // Numbers without a pattern, so that no mode is missed; a linear congruential generator with Knuth's constants.
    let mut seed = 1_u64;
    let mut v = vec![0.0; n];
    for &coordinate in equations.system.free() {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        v[coordinate] = (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
    }
    // Fixed coordinates rest: what forces and momenta have there is multiplied by zero.
    let mut p = vec![0.0; n];
    equations.inertia.add_product(&v, &mut p);
    let mut beta = dot(&v, &p).sqrt();
    let (mut p_before, mut r, mut moved) = (vec![0.0; n], p.clone(), vec![0.0; n]);
    let (mut diagonal, mut beside, mut squared) = (Vec::new(), Vec::new(), 0.0);
    for _ in 0..MOST.min(equations.system.free().len()) {
        for ((v, p), r) in v.iter_mut().zip(&mut p).zip(&r) {
            (*v, *p) = (*v / beta, r / beta);
        }
        let sizes = v.iter().zip(equations.newton.scale()).map(|(v, scale)| v.abs() / scale);
        let distance = DISTANCE / sizes.fold(0.0, f64::max);
        for ((moved, q), v) in moved.iter_mut().zip(q).zip(&v) {
            *moved = q + distance * v;
        }
        equations.force_at_rest(t, &moved, &mut r);
        for (r, force) in r.iter_mut().zip(&force) {
            *r = (*r - force) / distance;
        }
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
        equations.inertia.solve(&r, &mut v);
        beta = dot(&v, &r).max(0.0).sqrt();
        if beta <= f64::EPSILON * squared.abs() {
            break;
        }
        beside.push(beta);
        p_before.copy_from_slice(&p);
    }
    squared.max(0.0).sqrt()
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
