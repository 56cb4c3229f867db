//! Frequencies of a thin square plate.
//!
//! Reference: Kirchhoff's plate theory, nu 0.3; FFFF 1-3: A. L. Schwab, J. Gerstmayr, J. P. Meijaard,
//! DETC2007-34754; the rest of FFFF and CFFF: Rayleigh-Ritz with 22 x 22 products of Legendre polynomials.
//! Goal: the first six flexural frequencies within 0.5 % with thin36, 0.1 % with thin48, after six rigid motions of the free plate.
//! Mesh: 16 x 16 elements.

use nalgebra::DMatrix;

use ancf_core::assembly::System;
use ancf_core::element::{Kind, Membrane, Want};
use ancf_core::model::{Model, Plate};

use crate::common::{Random, dot, moved, plate, rectangle, system};

/// `omega a^2 sqrt(rho h / D)`.
const FREE: [f64; 6] = [13.46820, 19.59614, 24.27020, 34.80089, 34.80089, 61.09323];
/// The same with one edge clamped.
const CANTILEVER: [f64; 6] = [3.4710, 8.5063, 21.2841, 27.1987, 30.9547, 54.1845];

/// A square of side 1 m with `D = rho h = 1`, so that circular frequencies are the dimensionless ones.
fn square(element: Kind, membrane: Membrane) -> Model {
    let thickness: f64 = 0.01;
    let young = 12.0 * (1.0 - 0.09) / thickness.powi(3);
    let plate = Plate { element, ..plate(young, 0.3, 1.0 / thickness, thickness, membrane) };
    rectangle([1.0, 1.0], [16, 16], plate).0
}

/// The lowest `count` values of `omega^2` in `K x = omega^2 M x` about rest, by subspace iteration with `K + shift M`.
///
/// # Source
///
/// Bathe, Finite Element Procedures (1996), 11.6.
fn lowest(system: &mut System, count: usize, shift: f64) -> Vec<f64> {
    let rest = system.model().reference().to_vec();
    let n = rest.len();
    system.assemble(&rest, 0.0, Want { mass: shift, stiffness: 1.0, previous: None }, &mut vec![0.0; n]);
    assert!(system.factorize().unwrap().is_positive_definite());

    let size = count + 8;
    let mut random = Random(21);
    let start = |random: &mut Random| {
        let x = random.vector(n);
        x.iter().zip(system.model().fixed()).map(|(x, fixed)| if *fixed { 0.0 } else { *x }).collect::<Vec<_>>()
    };
    let mut basis: Vec<Vec<f64>> = (0..size).map(|_| start(&mut random)).collect();
    let mut last = vec![0.0; count];
    for _ in 0..60 {
        let inertia: Vec<Vec<f64>> = basis.iter().map(|x| mass_times(system, x)).collect();
        for (x, load) in basis.iter_mut().zip(&inertia) {
            system.solve(load, x);
        }
        // Rayleigh-Ritz in the new basis: x_i (K + shift M) x_j = x_i . load_j.
        let stiffness =
            DMatrix::from_fn(size, size, |i, j| 0.5 * (dot(&basis[i], &inertia[j]) + dot(&basis[j], &inertia[i])));
        let moved: Vec<Vec<f64>> = basis.iter().map(|x| mass_times(system, x)).collect();
        let mass = DMatrix::from_fn(size, size, |i, j| 0.5 * (dot(&basis[i], &moved[j]) + dot(&basis[j], &moved[i])));
        let inverse = stiffness.cholesky().unwrap().l().try_inverse().unwrap();
        let eigen = (&inverse * mass * inverse.transpose()).symmetric_eigen();
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let weights = inverse.transpose() * &eigen.eigenvectors;
        basis = order
            .iter()
            .map(|&mode| combine(&basis, weights.column(mode).as_slice(), 1.0 / eigen.eigenvalues[mode].sqrt()))
            .collect();
        let values: Vec<f64> = order[..count].iter().map(|&mode| 1.0 / eigen.eigenvalues[mode] - shift).collect();
        let change = values.iter().zip(&last).map(|(a, b)| (a - b).abs() / (a + shift)).fold(0.0, f64::max);
        if change < 1e-9 {
            return values;
        }
        last = values;
    }
    panic!("no convergence: {last:?}");
}

fn mass_times(system: &System, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    system.add_mass_times(x, &mut y);
    y
}

fn combine(basis: &[Vec<f64>], weights: &[f64], factor: f64) -> Vec<f64> {
    let zero = vec![0.0; basis[0].len()];
    basis.iter().zip(weights).fold(zero, |sum, (x, weight)| moved(&sum, factor * weight, x))
}

fn check(found: &[f64], expected: &[f64], tolerance: f64, name: &str) {
    for (mode, (square, lambda)) in found.iter().zip(expected).enumerate() {
        let error = square.sqrt() / lambda - 1.0;
        println!("{name}, mode {}: {:.4}, {:.2e} off", mode + 1, square.sqrt(), error);
        assert!(error.abs() < tolerance, "{name}, mode {}: {}, expected {lambda}", mode + 1, square.sqrt());
    }
}

/// The thin elements, and what their frequencies may be off by.
fn cases() -> impl Iterator<Item = (Kind, Membrane, f64)> {
    let thin36 = Membrane::ALL.map(|membrane| (Kind::Thin36, membrane, 5e-3));
    thin36.into_iter().chain([Membrane::Projected, Membrane::Full].map(|membrane| (Kind::Thin48, membrane, 1e-3)))
}

#[test]
fn a_free_square_has_the_frequencies_of_kirchhoff() {
    for (element, membrane, tolerance) in cases() {
        let found = lowest(&mut system(square(element, membrane)), 12, 100.0);
        for rigid in &found[..6] {
            assert!(rigid.abs() < 1e-5 * FREE[0].powi(2), "{membrane:?}: omega^2 = {rigid:e}");
        }
        check(&found[6..], &FREE, tolerance, &format!("FFFF {element:?} {membrane:?}"));
    }
}

#[test]
fn a_cantilever_square_has_the_frequencies_of_kirchhoff() {
    for (element, membrane, tolerance) in cases() {
        let mut model = square(element, membrane);
        model.clamp(model.find("plate").unwrap(), "edge:x0".parse().unwrap()).unwrap();
        let found = lowest(&mut system(model), 6, 0.0);
        check(&found, &CANTILEVER, tolerance, &format!("CFFF {element:?} {membrane:?}"));
    }
}
