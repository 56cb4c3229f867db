//! The highest frequency of a model, which limits explicit steps.

use crate::assembly::System;
use crate::element::Want;

use super::inertia::Inertia;

/// Iterations after which the estimate is taken as it is.
const MOST: usize = 300;
/// Relative change of the estimate of the squared frequency at which it is taken as found.
const PRECISION: f64 = 1e-6;

/// The highest frequency (rad/s) of small oscillations about a state, by power iteration with `M^-1 K`, from below to
/// about 0.1 %.
///
/// # Source
///
/// Golub and Van Loan, Matrix Computations (2013), 8.2.
pub(super) fn highest_frequency(system: &mut System, inertia: &mut Inertia, t: f64, q: &[f64]) -> f64 {
    let mut force = vec![0.0; q.len()];
    let want = Want { mass: 0.0, stiffness: 1.0, previous: None };
    system.assemble(q, t, want, &mut force);
    let stiffness = system.tangent_matrix();
    // Numbers without a pattern, so that no mode is missed; a linear congruential generator with Knuth's constants.
    let mut seed = 1_u64;
    let mut x = vec![0.0; q.len()];
    for &coordinate in system.free() {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        x[coordinate] = (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
    }
    let mut squared = 0.0;
    for _ in 0..MOST {
        let mut momentum = vec![0.0; q.len()];
        inertia.add_product(&x, &mut momentum);
        let norm = x.iter().zip(&momentum).map(|(x, p)| x * p).sum::<f64>().sqrt();
        let free: Vec<f64> = system.free().iter().map(|coordinate| x[*coordinate] / norm).collect();
        let mut product = vec![0.0; free.len()];
        stiffness.multiply_add::<1>(&free, &mut product);
        let last = squared;
        squared = free.iter().zip(&product).map(|(x, f)| x * f).sum::<f64>();
        if (squared - last).abs() <= PRECISION * squared.abs() {
            break;
        }
        for (coordinate, product) in system.free().iter().zip(product) {
            force[*coordinate] = product;
        }
        inertia.solve(&force, &mut x);
    }
    squared.max(0.0).sqrt()
}
