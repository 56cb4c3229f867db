//! What tells the elements apart.
//!
//! Reference: an independent prototype (the solid cantilever), plane waves across the thickness, the input rules.
//! Goal: the slow convergence and the stiff equations of fully parametrised elements; what each element refuses.
//! Mesh: n x 1 elements.

use nalgebra::DMatrix;

use ancf_core::Material;
use ancf_core::assembly::System;
use ancf_core::element::{Kind, Membrane};
use ancf_core::mesh::Surface;
use ancf_core::model::{Model, Plate};
use ancf_core::report::Outcome;
use ancf_core::statics::{Options, solve};
use ancf_core::strain::CurvatureLaw;

use crate::common::{add_ramp, line, rectangle, system, tangent};

fn steel(element: Kind, thickness: f64) -> Plate {
    let material = Material::new(2.07e11, 0.3, 7810.0).unwrap();
    Plate { material, thickness, element, membrane: None, curvature: None }
}

/// Corner deflection of the steel cantilever of Dufva and Shabana (2005), 0.5 x 0.15 x 0.001 m under 30 N.
fn deflection(element: Kind, n: usize) -> f64 {
    let (mut model, body) = rectangle([0.5, 0.15], [n, 1], steel(element, 0.001));
    model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
    add_ramp(&mut model, line(body, "edge:x1", [0.0, 0.0, -200.0]));
    let corner = 3 * model.body(body).vector(n, 0);
    let mut states = Vec::new();
    let run = solve(&mut system(model), &Options::default(), &mut states).unwrap();
    assert_eq!(run.outcome, Outcome::Ok, "{element:?}, n = {n}");
    states.last().unwrap().q[corner + 2]
}

/// The paper's finding: fully parametrised elements are far too stiff when bent by few elements.
#[test]
fn solid_elements_bend_slowly() {
    for (n, expected) in [(1, -0.010_43), (2, -0.027_66), (4, -0.072_23)] {
        let found = deflection(Kind::Full48a, n);
        assert!((found - expected).abs() < 5e-6, "n = {n}: {found}, expected {expected}");
    }
}

/// Both thin elements agree on the limit of the refinement along the strip.
#[test]
fn thin_elements_bend_alike() {
    let (coarse, fine) = (deflection(Kind::Thin48, 4), deflection(Kind::Thin48, 8));
    println!("thin48: {coarse} {fine}, thin36: {}", deflection(Kind::Thin36, 8));
    assert!((fine / deflection(Kind::Thin36, 8) - 1.0).abs() < 3e-3);
    assert!((coarse / fine - 1.0).abs() < 3e-3);
}

/// The highest circular frequency of one free element, rad/s.
fn highest_frequency(element: Kind, thickness: f64) -> f64 {
    let mut system: System = system(rectangle([0.1, 0.1], [1, 1], steel(element, thickness)).0);
    let rest = system.model().reference().to_vec();
    let stiffness = tangent(&mut system, &rest, 0.0);
    let (pattern, values) = (system.mass().pattern(), system.mass().values());
    let free = system.free();
    let mass = DMatrix::from_fn(free.len(), free.len(), |i, j| {
        let (i, j) = (free[i].max(free[j]), free[i].min(free[j]));
        if i % 3 == j % 3 { pattern.slot(i / 3, j / 3).map_or(0.0, |slot| values[slot]) } else { 0.0 }
    });
    let inverse = mass.cholesky().unwrap().l().try_inverse().unwrap();
    (&inverse * stiffness * inverse.transpose()).symmetric_eigenvalues().max().sqrt()
}

/// A fully parametrised element vibrates across its thickness: with `u_z = z` the stiffness is that of a bar held at its
/// sides, `lambda + 2 mu`, the mass `rho h^2 / 12`, so `omega = sqrt(12 (lambda + 2 mu) / rho) / h` at least: time steps
/// shrink with the thickness. A thin element has nothing across.
#[test]
fn solid_elements_have_a_frequency_that_grows_as_one_over_thickness() {
    let modulus = 2.07e11 * (1.0 - 0.3) / ((1.0 + 0.3) * (1.0 - 2.0 * 0.3));
    for thickness in [1e-3, 1e-4] {
        let across = (12.0_f64 * modulus / 7810.0).sqrt() / thickness;
        for element in [Kind::Full48a, Kind::Full48b] {
            let ratio = highest_frequency(element, thickness) / across;
            assert!((ratio - 1.0).abs() < 1e-3, "{element:?}, h = {thickness}: {ratio}");
        }
        assert!(highest_frequency(Kind::Thin48, thickness) < 0.1 * across);
    }
}

#[test]
fn variants_that_an_element_does_not_have_are_refused() {
    let add = |plate: Plate| {
        let surface = Surface::rectangle([1.0, 1.0]).unwrap();
        Model::new().add_body("plate", &surface, [1, 1], plate).unwrap_err()
    };
    let membrane = |element, membrane| add(Plate { membrane: Some(membrane), ..steel(element, 0.1) });
    assert_eq!(membrane(Kind::Thin48, Membrane::Lobatto).argument, "membrane");
    for element in [Kind::Full48a, Kind::Full48b] {
        assert_eq!(membrane(element, Membrane::Projected).argument, "membrane");
        let error = add(Plate { curvature: Some(CurvatureLaw::Paper), ..steel(element, 0.1) });
        assert_eq!((error.argument.as_str(), error.value.as_str()), ("curvature", "\"paper\""));
        assert!(error.allowed.contains("solid"), "{error}");
    }
}
