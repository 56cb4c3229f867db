//! Frequencies of a thin square plate.
//!
//! Reference: Kirchhoff's plate theory, nu 0.3; FFFF 1-3: A. L. Schwab, J. Gerstmayr, J. P. Meijaard,
//! DETC2007-34754; the rest of FFFF and CFFF: Rayleigh-Ritz with 22 x 22 products of Legendre polynomials.
//! Goal: the first six flexural frequencies within 0.5 % with thin36, 0.1 % with thin48, after six rigid motions of the free plate.
//! Mesh: 16 x 16 elements.

use ancf_core::assembly::System;
use ancf_core::element::{Kind, Membrane};
use ancf_core::model::{Model, Plate};
use ancf_core::modes;
use ancf_core::report::Outcome;

use crate::common::{plate, rectangle, system};

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

/// The lowest `count` squared circular frequencies about rest.
fn lowest(system: &mut System, count: usize) -> Vec<f64> {
    let options = modes::Options { count, q: system.model().reference().to_vec(), t: 0.0 };
    let (found, run) = modes::solve(system, &options, &mut Vec::new()).unwrap();
    assert_eq!(run.outcome, Outcome::Ok);
    found.iter().map(|mode| mode.eigenvalue).collect()
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
        let found = lowest(&mut system(square(element, membrane)), 12);
        for rigid in &found[..6] {
            assert_eq!(*rigid, 0.0, "{membrane:?}");
        }
        check(&found[6..], &FREE, tolerance, &format!("FFFF {element:?} {membrane:?}"));
    }
}

#[test]
fn a_cantilever_square_has_the_frequencies_of_kirchhoff() {
    for (element, membrane, tolerance) in cases() {
        let mut model = square(element, membrane);
        model.clamp(model.find("plate").unwrap(), "edge:x0".parse().unwrap()).unwrap();
        let found = lowest(&mut system(model), 6);
        check(&found, &CANTILEVER, tolerance, &format!("CFFF {element:?} {membrane:?}"));
    }
}
