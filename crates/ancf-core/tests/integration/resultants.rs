//! Strains, forces and stresses at material points, in the frame of the reference surface.
//!
//! Reference: the cantilever beam (nu = 0), homogeneous states, curves on a sphere.
//! Goal: components in the orthonormal frame whatever the parameters; signs as documented.
//! Mesh: a few elements; curved ones of each shape.

use std::f64::consts::FRAC_PI_2;

use ancf_core::Material;
use ancf_core::element::{Kind, Membrane};
use ancf_core::evaluate::{Layer, MaterialPoint, Quantity};
use ancf_core::mesh::{Surface, SurfacePoint};
use ancf_core::model::{BodyId, Model, Plate};
use ancf_core::nonlinear::Options as NewtonOptions;
use ancf_core::report::Outcome;
use ancf_core::statics::{Options, solve};

use crate::common::{GAUSS, Random, add_ramp, line, random_state, rectangle, system, variants};

const YOUNG: f64 = 2e11;

fn steel(element: Kind, poisson: f64, thickness: f64) -> Plate {
    let material = Material::new(YOUNG, poisson, 7800.0).unwrap();
    Plate { material, thickness, element, membrane: None, curvature: None }
}

fn value(model: &Model, body: BodyId, at: [f64; 2], quantity: Quantity, q: &[f64]) -> [f64; 3] {
    MaterialPoint::new(model, body, at, quantity).unwrap().evaluate(q, q)
}

fn assert_close(found: [f64; 3], expected: [f64; 3], tolerance: f64, name: &str) {
    for i in 0..3 {
        assert!((found[i] - expected[i]).abs() <= tolerance, "{name}: {found:?}, expected {expected:?}");
    }
}

/// A load p per length upwards on the end, nu = 0: the shear force is p, the moment p (L - x), the stress on the faces
/// the moment over h^2 / 6, compression above.
///
/// The bicubic thin48 contains the solution. So does thin36, but its slopes jump between elements: where the moment
/// varies that is an error, which is largest at the free corners and dies out from there.
#[test]
fn a_cantilever_carries_its_load() {
    let (length, h, p) = (1.0, 0.01, 1.0);
    let newton = NewtonOptions { tolerance: 1e-12, ..NewtonOptions::default() };
    let options = Options { newton, ..Options::default() };
    for (element, points, tolerance) in [(Kind::Thin48, [0.05, 0.8], 1e-8), (Kind::Thin36, [0.05, 0.2], 2e-4)] {
        let (mut model, body) = rectangle([length, 0.3], [6, 2], steel(element, 0.0, h));
        model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
        add_ramp(&mut model, line(body, "edge:x1", [0.0, 0.0, p]));
        let mut states = Vec::new();
        let run = solve(&mut system(model.clone()), &options, &mut states).unwrap();
        assert_eq!(run.outcome, Outcome::Ok);
        let q = &states.last().unwrap().q;
        for x in points {
            let at = |quantity| value(&model, body, [x, 0.11], quantity, q);
            let moment = p * (length - x);
            // Of a membrane strain: some hundred times that of one.
            let rounding = 1e-13 * YOUNG;
            let stress = 6.0 * moment / (h * h);
            let name = format!("{element:?}, x = {x}");
            assert_close(at(Quantity::Moment), [moment, 0.0, 0.0], tolerance * p, &name);
            assert_close(at(Quantity::ShearForce), [p, 0.0, 0.0], tolerance * p, &name);
            assert_close(at(Quantity::Stress(Layer::Top)), [-stress, 0.0, 0.0], tolerance * stress + rounding, &name);
            assert_close(at(Quantity::Stress(Layer::Bottom)), [stress, 0.0, 0.0], tolerance * stress + rounding, &name);
        }
    }
}

/// Every shape blown up by the factor s: `E = (s^2 - 1)/2` along both axes, `N = h E / (1 - nu) (s^2 - 1)/2`.
#[test]
fn strains_are_those_of_the_orthonormal_frame() {
    let oblique = |divisions: [usize; 2]| {
        let node = |i: usize, j: usize| {
            let (x, y) = (i as f64 / divisions[0] as f64, j as f64 / divisions[1] as f64);
            let (r_x, r_y) = ([2.0, 0.3, 0.5], [1.0, 0.8, -0.2]);
            SurfacePoint { r: [0, 1, 2].map(|k| x * r_x[k] + y * r_y[k]), r_x, r_y, r_xy: [0.0; 3] }
        };
        let nodes = (0..=divisions[1]).flat_map(|j| (0..=divisions[0]).map(move |i| node(i, j)));
        Surface::from_nodes([[0.0, 1.0], [0.0, 1.0]], divisions, nodes.collect()).unwrap()
    };
    let divisions = [3, 2];
    let shapes = [
        (oblique(divisions), [0.4, 0.7]),
        (Surface::annulus([1.0, 3.0], 1.0).unwrap(), [1.3, 0.2]),
        (Surface::cylinder(2.0, [0.0, 1.0], [0.0, 5.0]).unwrap(), [0.3, 4.0]),
        (Surface::sphere(2.0, [0.0, FRAC_PI_2], [0.0, 1.0]).unwrap(), [0.3, 0.4]),
    ];
    let (stretch, h) = (1.1_f64, 0.02);
    let strain = 0.5 * (stretch * stretch - 1.0);
    let force = h * YOUNG / (1.0 - 0.3) * strain;
    for element in [Kind::Thin36, Kind::Thin48] {
        for (surface, at) in &shapes {
            let mut model = Model::new();
            // The projected strain of curvilinear parameters is constant to the order of the interpolation only.
            let plate = Plate { membrane: Some(Membrane::Full), ..steel(element, 0.3, h) };
            let body = model.add_body("shell", surface, divisions, plate).unwrap();
            let q: Vec<f64> = model.reference().iter().map(|x| stretch * x).collect();
            let name = format!("{element:?}, {surface:?}");
            let found = value(&model, body, *at, Quantity::MembraneStrain, &q);
            assert_close(found, [strain, strain, 0.0], 1e-13, &name);
            let found = value(&model, body, *at, Quantity::MembraneForce, &q);
            assert_close(found, [force, force, 0.0], 1e-12 * force, &name);
        }
    }
}

/// A flat annulus bent to `w = x^2 / 2` in space: at the angle a, `kappa_rr = cos^2 a`, `kappa_tt = sin^2 a`,
/// `2 kappa_rt = -sin 2 a`; thin48 interpolates it with an error of fourth order in position, of second in curvature.
#[test]
fn curvatures_turn_with_the_frame() {
    let surface = Surface::annulus([1.0, 2.0], 1.5).unwrap();
    let mut model = Model::new();
    let body = model.add_body("ring", &surface, [16, 24], steel(Kind::Thin48, 0.3, 0.01)).unwrap();
    let small = 1e-6;
    let mut q = model.reference().to_vec();
    for node in q.chunks_mut(12) {
        // With x and its derivatives at the node: w = x^2 / 2 and its derivatives.
        let (x, x_r, x_t, x_rt) = (node[0], node[3], node[6], node[9]);
        node[2] += small * 0.5 * x * x;
        node[5] += small * x * x_r;
        node[8] += small * x * x_t;
        node[11] += small * (x_r * x_t + x * x_rt);
    }
    for angle in [0.2_f64, 0.7, 1.4] {
        let (sin, cos) = angle.sin_cos();
        let found = value(&model, body, [1.37, angle], Quantity::Curvature, &q).map(|k| k / small);
        assert_close(found, [cos * cos, sin * sin, -2.0 * sin * cos], 2e-3, &format!("at {angle}"));
    }
}

/// Forces and moments of any element integrate to the elastic energy: `1/2 N . (h D)^-1 N` to that of the membrane,
/// `1/2 M . (h^3/12 D)^-1 M` to that of bending, with the points at which the element samples them.
#[test]
fn forces_and_moments_are_those_of_the_energy() {
    let (h, sides) = (1e-3, [0.2, 0.15]);
    let gauss = |n: usize| -> Vec<(f64, f64)> {
        match n {
            2 => [-1.0, 1.0].map(|s: f64| (0.5 + s * 3.0_f64.sqrt() / 6.0, 0.5)).to_vec(),
            3 => [(-1.0, 5.0), (0.0, 8.0), (1.0, 5.0)]
                .map(|(s, w): (f64, f64)| (0.5 + s * 0.15_f64.sqrt(), w / 18.0))
                .to_vec(),
            _ => GAUSS.to_vec(),
        }
    };
    let simpson = vec![(0.0, 1.0 / 6.0), (0.5, 4.0 / 6.0), (1.0, 1.0 / 6.0)];
    for (element, membrane, curvature) in variants().filter(|(element, ..)| !element.is_solid()) {
        let plate = Plate { membrane, curvature, ..steel(element, 0.3, h) };
        let (model, body) = rectangle(sides, [1, 1], plate);
        let q = random_state(&model, 0.05, &mut Random(7));
        let energy = system(model.clone()).internal_force(&q, &mut vec![0.0; q.len()]);
        let integral = |quantity: Quantity, rule: &[(f64, f64)], section: f64| -> f64 {
            let compliance = |n: [f64; 3]| (n[0] * n[0] + n[1] * n[1] - 0.6 * n[0] * n[1] + 2.6 * n[2] * n[2]) / YOUNG;
            let at = |(x, u): &(f64, f64)| {
                let along = rule.iter().map(|(y, w)| {
                    let inside = |s: f64| s.clamp(1e-12, 1.0 - 1e-12);
                    let n = value(&model, body, [sides[0] * inside(*x), sides[1] * inside(*y)], quantity, &q);
                    0.5 * u * w * sides[0] * sides[1] * compliance(n) / section
                });
                along.sum::<f64>()
            };
            rule.iter().map(at).sum()
        };
        let (in_plane, across) = match membrane {
            Some(Membrane::Lobatto) => (simpson.clone(), gauss(2)),
            _ => (gauss(4), gauss(3)),
        };
        let name = format!("{element:?} {membrane:?} {curvature:?}");
        let found = integral(Quantity::MembraneForce, &in_plane, h) / energy.membrane;
        // The share of the projected membrane that is sampled, (h / l)^2, is quadratic in another strain.
        assert!((found - 1.0).abs() < 1e-4, "{name}: membrane {found}");
        let found = integral(Quantity::Moment, &across, h.powi(3) / 12.0) / energy.bending;
        assert!((found - 1.0).abs() < 1e-9, "{name}: bending {found}");
    }
}

/// A square stretched by a along x, by b along y and turned: `S = D E`, and with the stretch c across the thickness, from
/// `E_zz = -nu / (1 - nu) (E_xx + E_yy)`, the Cauchy stress `a S_xx / (b c)` along x, `b S_yy / (a c)` along y. A solid whose
/// thickness is stretched by c, too, has the same.
#[test]
fn a_stretched_plate_has_the_stresses_of_its_stretches() {
    let (a, b, nu) = (1.3_f64, 0.9_f64, 0.3);
    let [xx, yy] = [a, b].map(|s| 0.5 * (s * s - 1.0));
    let c = (1.0 - 2.0 * nu / (1.0 - nu) * (xx + yy)).sqrt();
    let second = [xx + nu * yy, yy + nu * xx].map(|e| YOUNG / (1.0 - nu * nu) * e);
    let [x, y] = [a / (b * c) * second[0], b / (a * c) * second[1]];
    let equivalent = (x * x - x * y + y * y).sqrt();
    let turn = Random(3).rotation();
    for (element, membrane, curvature) in variants() {
        let plate = Plate { membrane, curvature, ..steel(element, nu, 0.01) };
        let (model, body) = rectangle([2.0, 1.0], [2, 2], plate);
        let stretched: Vec<f64> = model.reference().chunks(3).flat_map(|v| [a * v[0], b * v[1], c * v[2]]).collect();
        let q = crate::common::rotated(&turn, &stretched);
        let name = format!("{element:?} {membrane:?}");
        let tolerance = 1e-12 * YOUNG;
        for layer in [Layer::Top, Layer::Middle, Layer::Bottom] {
            let at = |quantity: fn(Layer) -> Quantity| value(&model, body, [0.7, 0.3], quantity(layer), &q);
            assert_close(at(Quantity::Stress), [second[0], second[1], 0.0], tolerance, &name);
            assert_close(at(Quantity::CauchyStress), [x, y, 0.0], tolerance, &name);
            assert_close(at(Quantity::PrincipalStress), [x.max(y), x.min(y), 0.0], tolerance, &name);
            assert_close(at(Quantity::VonMises), [equivalent, 0.0, 0.0], tolerance, &name);
        }
    }
}

/// Simple shear by k: `F = [[1, k], [0, 1]]` is upper triangular, so the frame of the deformed surface is the one at rest.
#[test]
fn a_sheared_plate_has_the_cauchy_stress_of_its_deformation_gradient() {
    let (k, nu) = (0.4_f64, 0.25_f64);
    let (xx, xy, yy) = (0.0, k, 0.5 * k * k);
    let c = (1.0 - 2.0 * nu / (1.0 - nu) * (xx + yy)).sqrt();
    let d = YOUNG / (1.0 - nu * nu);
    let s = [d * (xx + nu * yy), d * (yy + nu * xx), d * 0.5 * (1.0 - nu) * xy];
    let expected = [s[0] + 2.0 * k * s[2] + k * k * s[1], s[1], s[2] + k * s[1]].map(|s| s / c);
    let (model, body) = rectangle([2.0, 1.0], [2, 2], steel(Kind::Thin36, nu, 0.01));
    let q: Vec<f64> = model.reference().chunks(3).flat_map(|v| [v[0] + k * v[1], v[1], v[2]]).collect();
    let found = value(&model, body, [0.7, 0.3], Quantity::CauchyStress(Layer::Top), &q);
    assert_close(found, expected, 1e-12 * YOUNG, "sheared");
}
