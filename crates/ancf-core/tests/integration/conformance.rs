//! What every element must satisfy, for every membrane variant and curvature law.
//!
//! Reference: differences of the energy, rigid-body mechanics, closed forms of homogeneous states.
//! Goal: energy, force and tangent belong together; no spurious stiffness and no spurious softness.
//! Mesh: a few rectangles that are not square.

use nalgebra::{DVector, Matrix3, Vector3};

use ancf_core::Material;
use ancf_core::assembly::System;
use ancf_core::element::Kind;
use ancf_core::model::{LoadKind, Plate};

use crate::common::{
    Random, add_constant, derivative, distance, dot, field, largest, monomial, moved, random_state, rectangle, rotated,
    system, tangent, variants,
};

const SIZE: [f64; 2] = [1.1, 0.45];
const THICKNESS: f64 = 0.05;
const YOUNG: f64 = 1e3;
const POISSON: f64 = 0.3;
const DENSITY: f64 = 20.0;

/// Runs a check on the plate in every variant: 2 x 3 elements of 0.55 x 0.15 m.
fn for_each_variant(check: impl Fn(&mut System, &str)) {
    for (element, membrane, curvature) in variants() {
        let material = Material::new(YOUNG, POISSON, DENSITY).unwrap();
        let plate = Plate { material, thickness: THICKNESS, element, membrane, curvature };
        let (mut model, _) = rectangle(SIZE, [2, 3], plate);
        add_constant(&mut model, LoadKind::Gravity([1.0, -2.0, -9.81]));
        check(&mut system(model), &format!("{element:?} {membrane:?} {curvature:?}"));
    }
}

#[test]
fn force_is_the_derivative_of_the_energy() {
    for_each_variant(|system, name| {
        let q = random_state(system.model(), 0.2, &mut Random(1));
        let mut force = vec![0.0; q.len()];
        system.internal_force(&q, &mut force);
        for i in 0..q.len() {
            let energy = |step: f64| {
                let mut at = q.clone();
                at[i] += step;
                vec![system.internal_force(&at, &mut vec![0.0; q.len()]).total()]
            };
            let error = (derivative(1e-4, energy)[0] - force[i]).abs() / largest(&force);
            assert!(error < 1e-6, "{name}, coordinate {i}: {error:e}");
        }
    });
}

/// The differences give both triangles, so this says as well that the tangent is symmetric.
#[test]
fn tangent_is_the_derivative_of_the_force() {
    for_each_variant(|system, name| {
        let q = random_state(system.model(), 0.2, &mut Random(2));
        let tangent = tangent(system, &q, 0.0);
        let free = system.free().to_vec();
        for (column, &j) in free.iter().enumerate() {
            let force = |step: f64| {
                let (mut at, mut force) = (q.clone(), vec![0.0; q.len()]);
                at[j] += step;
                system.internal_force(&at, &mut force);
                free.iter().map(|&i| force[i]).collect()
            };
            let error = distance(&derivative(1e-4, force), tangent.column(column).as_slice()) / tangent.amax();
            assert!(error < 1e-6, "{name}, column {column}: {error:e}");
        }
    });
}

#[test]
fn forces_and_energies_turn_with_the_body() {
    for_each_variant(|system, name| {
        let mut random = Random(3);
        let q = random_state(system.model(), 0.2, &mut random);
        let rotation = random.rotation();
        let (mut force, mut turned) = (vec![0.0; q.len()], vec![0.0; q.len()]);
        let energy = system.internal_force(&q, &mut force).total();
        let same = system.internal_force(&rotated(&rotation, &q), &mut turned).total();
        assert!((same / energy - 1.0).abs() < 1e-13, "{name}");
        assert!(distance(&rotated(&rotation, &force), &turned) < 1e-12 * largest(&force), "{name}");
    });
}

#[test]
fn rigid_motions_strain_nothing() {
    for_each_variant(|system, name| {
        let mut random = Random(4);
        let mut q = rotated(&random.rotation(), system.model().reference());
        let positions: Vec<_> = {
            let body = &system.model().bodies()[0];
            (0..body.grid().nodes()).map(|node| 3 * body.vector(node, 0)).collect()
        };
        for (first, (c, shift)) in
            positions.iter().flat_map(|p| [0.7, -1.3, 2.9].into_iter().enumerate().map(move |s| (p, s)))
        {
            q[first + c] += shift;
        }
        let mut force = vec![0.0; q.len()];
        let energy = system.internal_force(&q, &mut force).total();
        // Against a strain of one: the force E h a, the energy E h a^2.
        assert!(largest(&force) < 1e-13 * YOUNG * THICKNESS * SIZE[0], "{name}: {:e}", largest(&force));
        assert!(energy < 1e-26 * YOUNG * THICKNESS * SIZE[0] * SIZE[1], "{name}: {energy:e}");
    });
}

/// At thickness / side 0.3, so that rounding of the membrane does not hide soft modes.
#[test]
fn six_motions_cost_no_energy_and_no_seventh() {
    for (element, membrane, curvature) in variants() {
        for (size, divisions) in [([1.0, 1.0], [1, 1]), ([1.0, 0.6], [1, 1]), ([1.0, 0.6], [2, 2])] {
            let material = Material::new(1.0, POISSON, 1.0).unwrap();
            let thickness = 0.3 * size[1] / divisions[1] as f64;
            let (model, _) = rectangle(size, divisions, Plate { material, thickness, element, membrane, curvature });
            let mut system = system(model);
            let rest = system.model().reference().to_vec();
            // In units of the diagonal, so that positions and gradients of any order can be compared.
            let mut tangent = tangent(&mut system, &rest, 0.0);
            let units = tangent.diagonal().map(f64::sqrt);
            tangent.component_div_assign(&(&units * units.transpose()));
            let mut eigenvalues: Vec<f64> = tangent.symmetric_eigenvalues().iter().copied().collect();
            eigenvalues.sort_by(f64::total_cmp);
            let largest = eigenvalues[eigenvalues.len() - 1];
            let name = format!("{element:?} {membrane:?} {curvature:?}, {divisions:?} on {size:?}");
            assert!(
                eigenvalues[5].abs() < 1e-14 * largest && eigenvalues[0] > -1e-14 * largest,
                "{name}: {eigenvalues:?}"
            );
            assert!(eigenvalues[6] > 1e-6 * largest, "{name}: {:?}", &eigenvalues[..8]);
        }
    }
}

/// A homogeneous deformation `r = F R`: a surface has the energy `h A E : D : E / 2` of plane stress, a solid that of
/// its strain in all directions; no force on inner nodes (membrane patch test).
#[test]
fn homogeneous_strain_has_its_energy() {
    let f = Matrix3::new(1.2, 0.3, 0.1, -0.1, 0.9, 0.2, 0.25, -0.4, 1.1);
    let strain: Matrix3<f64> = 0.5 * (f.transpose() * f - Matrix3::identity());
    let volume = THICKNESS * SIZE[0] * SIZE[1];
    let shear = 0.5 * YOUNG / (1.0 + POISSON);
    let solid = 0.5 * volume * (lame() * strain.trace().powi(2) + 2.0 * shear * strain.norm_squared());
    let strain = strain.fixed_view::<2, 2>(0, 0);
    let plane = 2.0 * shear * POISSON / (1.0 - POISSON);
    let surface = 0.5 * volume * (plane * strain.trace().powi(2) + 2.0 * shear * strain.norm_squared());
    for_each_variant(|system, name| {
        let body = &system.model().bodies()[0];
        let expected = if body.plate().element.is_solid() { solid } else { surface };
        let inner = [4, 7].map(|node| 3 * body.vector(node, 0));
        let q: Vec<f64> = system
            .model()
            .reference()
            .chunks(3)
            .flat_map(|r| <[f64; 3]>::from(f * Vector3::from_column_slice(r)))
            .collect();
        let mut force = vec![0.0; q.len()];
        let energy = system.internal_force(&q, &mut force);
        assert!((energy.membrane / expected - 1.0).abs() < 1e-13, "{name}: {energy:?}, expected {expected}");
        assert!(energy.bending < 1e-24 * expected, "{name}: {energy:?}");
        for first in inner {
            assert!(largest(&force[first..first + 9]) < 1e-13 * largest(&force), "{name}, coordinate {first}");
        }
    });
}

/// Lame's first constant.
fn lame() -> f64 {
    YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
}

/// Small constant curvatures `w = kappa_xx x^2 / 2 + kappa_yy y^2 / 2 + kappa_xy x y`: the bending energy
/// `h^3 / 12 A kappa : D : kappa / 2`, and no force on inner nodes (bending patch test).
///
/// In a solid `r_z` is constant through the thickness, so that the fibres cannot grow and shrink across it: `D` is that
/// of plane strain there and not of plane stress, the thickness locking of fully parametrised elements. `full48b` has
/// no twist.
#[test]
fn constant_curvature_has_its_energy() {
    let shear = 0.5 * YOUNG / (1.0 + POISSON);
    for_each_variant(|system, name| {
        let body = system.model().find("plate").unwrap();
        let element = system.model().body(body).plate().element;
        let [xx, yy, xy]: [f64; 3] = if element == Kind::Full48b { [1e-6, -3e-6, 0.0] } else { [1e-6, -3e-6, 2e-6] };
        let lambda = if element.is_solid() { lame() } else { 2.0 * shear * POISSON / (1.0 - POISSON) };
        let square = xx * xx + yy * yy + 2.0 * xy * xy;
        let density = 0.5 * (lambda * (xx + yy).powi(2) + 2.0 * shear * square);
        let expected = SIZE[0] * SIZE[1] * THICKNESS.powi(3) / 12.0 * density;

        let bend = |orders, at| {
            let part = |powers| monomial(powers, orders, at);
            [0.0, 0.0, 0.5 * xx * part([2, 0]) + 0.5 * yy * part([0, 2]) + xy * part([1, 1])]
        };
        let mut q = moved(system.model().reference(), 1.0, &field(system.model(), body, bend));
        let plate = system.model().body(body);
        for node in 0..plate.grid().nodes() {
            if element.is_solid() {
                let [x, y] = plate.grid().parameters(node);
                let first = 3 * plate.vector(node, 3);
                q[first] -= xx * x + xy * y;
                q[first + 1] -= yy * y + xy * x;
            }
        }
        let inner = [4, 7].map(|node| 3 * plate.vector(node, 0));
        let energy = system.internal_force(&q, &mut vec![0.0; q.len()]);
        let tolerance = if element.is_solid() { 1e-7 } else { 1e-10 };
        assert!((energy.bending / expected - 1.0).abs() < tolerance, "{name}: {energy:?}, expected {expected:e}");
        // Membrane strains are of the order of the square of the curvature.
        assert!(energy.membrane.abs() < 1e-7 * expected, "{name}: {energy:?}");

        // The forces to first order, where a solid's rounding and the products of curvatures do not cover them.
        let rest = system.model().reference().to_vec();
        let tangent = tangent(system, &rest, 0.0);
        let change = DVector::from_iterator(q.len(), system.free().iter().map(|&i| q[i] - rest[i]));
        let linear = tangent * change;
        let mut force = vec![0.0; q.len()];
        for (&i, f) in system.free().iter().zip(&linear) {
            force[i] = *f;
        }
        for first in inner {
            let left = largest(&force[first..first + 9]) / largest(&force);
            assert!(left < 1e-9, "{name}, coordinate {first}: {left:e}");
        }
    });
}

/// Mass, centre and moments of inertia of the middle surface, seen through the kinetic energy and the momenta of a
/// rigid motion; the weight through the work of gravity.
#[test]
fn mass_and_its_moments_are_exact() {
    let mass = DENSITY * THICKNESS * SIZE[0] * SIZE[1];
    let [a, b] = SIZE;
    let centre = Vector3::new(0.5 * a, 0.5 * b, 0.0);
    let inertia = mass
        * Matrix3::new(b * b / 3.0, -a * b / 4.0, 0.0, -a * b / 4.0, a * a / 3.0, 0.0, 0.0, 0.0, (a * a + b * b) / 3.0);
    let (translation, spin) = (Vector3::new(0.3, -1.2, 0.7), Vector3::new(-2.0, 0.4, 1.5));
    for_each_variant(|system, name| {
        let body = system.model().find("plate").unwrap();
        let v = field(system.model(), body, |orders, at| {
            let part = |powers| monomial(powers, orders, at);
            let position = Vector3::new(part([1, 0]), part([0, 1]), 0.0);
            (part([0, 0]) * translation + spin.cross(&position)).into()
        });
        let (kinetic, momentum, angular) = system.motion(system.mass(), system.model().reference(), &v);
        let expected = mass * (translation + spin.cross(&centre));
        assert!((Vector3::from(momentum) - expected).amax() < 1e-14 * mass, "{name}: {momentum:?}");
        let expected_angular = mass * centre.cross(&translation) + inertia * spin;
        assert!((Vector3::from(angular) - expected_angular).amax() < 1e-14 * mass, "{name}: {angular:?}");
        let energy = 0.5 * (translation.dot(&expected) + spin.dot(&expected_angular));
        assert!((kinetic / energy - 1.0).abs() < 1e-13, "{name}: {kinetic}");

        let mut weight = vec![0.0; v.len()];
        system.external_force(system.model().reference(), 0.0, &mut weight);
        let power = Vector3::new(1.0, -2.0, -9.81).dot(&expected);
        assert!((dot(&weight, &v) / power - 1.0).abs() < 1e-13, "{name}");
    });
}
