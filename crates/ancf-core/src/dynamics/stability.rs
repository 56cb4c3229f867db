//! The highest frequency of a model, which limits explicit steps.

use super::equations::Equations;

/// Iterations after which the estimate is taken as it is.
const MOST: usize = 300;
/// Length of the differences of forces that stand for products with the stiffness, relative to the size of the model.
const DIFFERENCE: f64 = 1e-7;
/// The share without a pattern in a start from the mode that was found last, so that another one is not missed.
const NOISE: f64 = 0.1;
/// Vectors that the mode is made of.
const KEPT: usize = 16;

/// The highest frequency (rad/s) of small oscillations about a state, by Lanczos's iteration with `M^-1 K`, from below,
/// taken as found when an iteration changes its square by less than `precision`, relative to it.
///
/// It begins at the mode of the last state where this was asked, which is `equations.highest_mode`, and replaces it.
///
/// # Source
///
/// Golub and Van Loan, Matrix Computations (2013), 10.1, in the inner product of the mass matrix.
pub(super) fn highest_frequency(equations: &mut Equations<'_>, t: f64, q: &[f64], precision: f64) -> f64 {
    let n = q.len();
    let free = equations.system.free().to_vec();
    let mut v = start(equations, &free);
    let [mut moved, mut p, mut p_before, mut force] = [const { Vec::new() }; 4];
    let mut loads = vec![0.0; n];
    let mut at_rest = vec![0.0; n];
    equations.elastic_force(t, q, &mut at_rest, &mut loads);
    p.resize(n, 0.0);
    equations.inertia.add_product(&v, &mut p);
    p_before.resize(n, 0.0);
    force.resize(n, 0.0);
    let mut basis = Vec::new();
    let (mut diagonal, mut beside, mut beta, mut squared) = (Vec::new(), Vec::new(), 0.0, 0.0);
    for _ in 0..MOST.min(free.len()) {
        let size = equations.newton.size(&v);
        moved.clear();
        moved.extend(q.iter().zip(&v).map(|(q, v)| q + DIFFERENCE / size * v));
        equations.elastic_force(t, &moved, &mut force, &mut loads);
        let mut r = vec![0.0; n];
        for &i in &free {
            r[i] = (force[i] - at_rest[i]) * (size / DIFFERENCE);
        }
        let alpha = dot(&v, &r);
        for &i in &free {
            r[i] -= alpha * p[i] + beta * p_before[i];
        }
        diagonal.push(alpha);
        let last = squared;
        squared = highest_eigenvalue(&diagonal, &beside, 0.1 * precision);
        let mut next = vec![0.0; n];
        if (squared - last).abs() > precision * squared.abs() {
            equations.inertia.solve(&r, &mut next);
            beta = dot(&next, &r).max(0.0).sqrt();
        } else {
            beta = 0.0;
        }
        if basis.len() < KEPT {
            basis.push(v);
        }
        if beta <= f64::EPSILON * squared.abs() {
            break;
        }
        beside.push(beta);
        next.iter_mut().for_each(|v| *v /= beta);
        r.iter_mut().for_each(|r| *r /= beta);
        v = next;
        p_before = std::mem::replace(&mut p, r);
    }
    let mode = &mut equations.highest_mode;
    mode.clear();
    mode.resize(n, 0.0);
    let weights = eigenvector(&diagonal[..basis.len()], &beside, (1.0 + precision) * squared);
    for (weight, vector) in weights.iter().zip(&basis) {
        mode.iter_mut().zip(vector).for_each(|(x, v)| *x += weight * v);
    }
    squared.max(0.0).sqrt()
}

/// The vector that the iteration begins at, of norm one in the mass matrix.
fn start(equations: &Equations<'_>, free: &[usize]) -> Vec<f64> {
    let n = equations.system.coordinates();
    // Numbers without a pattern, so that no mode is missed; a linear congruential generator with Knuth's constants.
    let mut seed = 1_u64;
    let mut x = vec![0.0; n];
    for &coordinate in free {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        x[coordinate] = (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
    }
    let normalize = |x: &mut [f64]| {
        let mut momentum = vec![0.0; n];
        equations.inertia.add_product(x, &mut momentum);
        let norm = dot(x, &momentum).sqrt();
        x.iter_mut().for_each(|x| *x /= norm);
    };
    normalize(&mut x);
    if !equations.highest_mode.is_empty() {
        x.iter_mut().zip(&equations.highest_mode).for_each(|(x, mode)| *x = mode + NOISE * *x);
        normalize(&mut x);
    }
    x
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

/// About the vector of the highest eigenvalue of a symmetric tridiagonal matrix, of norm one: a step of inverse iteration
/// with a number just above that eigenvalue, for which no pivot vanishes.
fn eigenvector(diagonal: &[f64], beside: &[f64], above: f64) -> Vec<f64> {
    let n = diagonal.len();
    let mut x = vec![0.0; n];
    if n == 0 {
        return x;
    }
    let mut pivots = vec![above - diagonal[0]; n];
    x[0] = 1.0;
    for i in 1..n {
        let factor = beside[i - 1] / pivots[i - 1];
        pivots[i] = above - diagonal[i] - factor * beside[i - 1];
        x[i] = factor * x[i - 1];
    }
    for i in (0..n).rev() {
        let later = if i + 1 < n { beside[i] * x[i + 1] } else { 0.0 };
        x[i] = (x[i] + later) / pivots[i];
    }
    let norm = dot(&x, &x).sqrt();
    x.iter_mut().for_each(|x| *x /= norm);
    x
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
