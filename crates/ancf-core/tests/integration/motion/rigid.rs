//! Bodies that do not deform, against closed forms and against stiff plates.

use ancf_core::Material;
use ancf_core::dynamics::{Method, Steps};
use ancf_core::element::NodalVector;
use ancf_core::model::{Fix, History, Load, LoadKind, Model};
use nalgebra::{Rotation3, Vector3};

use super::common::{end, gravity, options, plate};

const SIDE: f64 = 0.3;

fn steel() -> Material {
    Material::new(2.07e11, 0.3, 7810.0).unwrap()
}

fn spin(model: &Model, omega: Vector3<f64>) -> Vec<f64> {
    let turned = |x: &[f64]| omega.cross(&Vector3::from_column_slice(x));
    model.reference().chunks(3).flat_map(|x| <[f64; 3]>::from(turned(x))).collect()
}

fn hold(model: &mut Model, place: &str) {
    let body = model.find("plate").unwrap();
    model.fix(body, place.parse().unwrap(), &[Fix { vector: NodalVector::R, component: None }]).unwrap();
}

/// The axis of a free symmetric top turns about the angular momentum with |L| / I_1.
///
/// Reference: Goldstein, Poole and Safko, Classical Mechanics (2002), 5.6; of a thin square plate I_3 = 2 I_1.
#[test]
fn a_free_top_precesses() {
    let (model, _) = plate(2, SIDE, 1e-3, steel());
    let omega = Vector3::new(3.0, 0.0, 20.0);
    for steps in [Steps::fixed(2e-3), Steps::controlled(1e-9)] {
        let mut options = options(Method::Rigid, steps, 1.0);
        options.velocity = Some(spin(&model, omega));
        let state = end(model.clone(), &options);
        let momentum = Vector3::new(omega.x, 0.0, 2.0 * omega.z);
        let axis = Rotation3::from_scaled_axis(momentum) * Vector3::z();
        let [x, y] = [3..6, 6..9].map(|i| Vector3::from_column_slice(&state.q[i]));
        assert!((x.cross(&y) - axis).norm() < 1e-6, "{} {axis}", x.cross(&y));
        assert!(x.dot(&y).abs() < 1e-13 && (x.norm() - 1.0).abs() < 1e-13);
        let mass = 7810.0 * SIDE * SIDE * 1e-3;
        // About the origin, a corner; the centre keeps its velocity.
        let energy = 0.5 * mass * SIDE * SIDE / 12.0 * (omega.x.powi(2) + 2.0 * omega.z.powi(2))
            + 0.5 * mass * omega.cross(&Vector3::new(0.5 * SIDE, 0.5 * SIDE, 0.0)).norm_squared();
        assert!((state.kinetic / energy - 1.0).abs() < 1e-9, "{} {energy}", state.kinetic);
    }
}

/// A plate hinged along an edge falls from the horizontal, hangs down after K(sin 45 deg) / omega_0, omega_0^2 = 3 g / 2 a.
///
/// Reference: Abramowitz and Stegun, Handbook of Mathematical Functions (1964), table 17.1, for K.
#[test]
fn a_hinged_plate_falls_as_a_compound_pendulum() {
    let (mut model, _) = plate(2, SIDE, 1e-3, steel());
    hold(&mut model, "edge:x0");
    gravity(&mut model, -9.81);
    let quarter = 1.854_074_677_301_372 / (1.5 * 9.81 / SIDE).sqrt();
    let state = end(model.clone(), &options(Method::Rigid, Steps::controlled(1e-9), quarter));
    let tip = super::common::tip(&model, &state);
    assert!(tip[0].abs() < 1e-7 && (tip[2] + SIDE).abs() < 1e-7, "{tip:?}");
    assert!((state.kinetic - state.work).abs() < 1e-9 * state.work);
}

/// What hangs by a corner, is thrown by forces, or driven by a moment and a pressure, moves as stiff plates do.
#[test]
fn it_moves_as_a_stiff_plate_does() {
    for case in 0..4 {
        let stiff = Material::new(1e10, 0.3, 7810.0).unwrap();
        let (mut model, body) = plate(1, SIDE, 0.02, stiff);
        let mut load = |kind| model.add_load(Load { kind, history: History::Constant }).unwrap();
        match case {
            0 => load(LoadKind::Gravity([0.0, 1.0, -9.81])),
            1 => load(LoadKind::Force { body, point: [0.1, 0.25], force: [5.0, -3.0, 20.0] }),
            2 => load(LoadKind::Pressure { body, pressure: 200.0 }),
            _ => {
                let edge = Model::edge_at("edge:x1".parse().unwrap()).unwrap();
                load(LoadKind::Moment { body, edge, per_length: 10.0 });
                load(LoadKind::Line { body, edge, per_length: [0.0, 30.0, 0.0] });
            }
        }
        if case == 0 || case == 2 {
            hold(&mut model, "corner:x0y0");
        }
        let [rigid, flexible] = [(Method::Rigid, 1e-7), (Method::Rk, 1e-7)]
            .map(|(method, rtol)| end(model.clone(), &options(method, Steps::controlled(rtol), 0.3)));
        let distance = super::common::distance(&model, &rigid, &flexible);
        let moved = super::common::tip(&model, &rigid)
            .iter()
            .zip([SIDE, SIDE, 0.0])
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(moved > 0.02 && distance < 1e-4 * moved, "{case}: {distance:e} of {moved}");
        assert!((rigid.kinetic - rigid.work).abs() < 1e-6 * rigid.kinetic, "{case}");
    }
}

/// Fifth order.
#[test]
fn errors_shrink_with_the_fifth_power_of_the_step() {
    let (mut model, _) = plate(1, SIDE, 0.01, steel());
    hold(&mut model, "corner:x0y0");
    gravity(&mut model, -9.81);
    let at = |step: f64| end(model.clone(), &options(Method::Rigid, Steps::fixed(step), 0.8));
    let reference = at(0.8 / 640.0);
    let errors = [20.0, 40.0].map(|n| super::common::distance(&model, &at(0.8 / n), &reference));
    let order = (errors[0] / errors[1]).log2();
    assert!((4.5..6.0).contains(&order), "{order} {errors:?}");
}

/// Supports that are neither a point, an axis nor a wall are refused.
#[test]
fn other_supports_are_refused() {
    let (mut model, body) = plate(1, SIDE, 0.01, steel());
    let fix = Fix { vector: NodalVector::R, component: Some(2) };
    model.fix(body, "edge:x0".parse().unwrap(), &[fix]).unwrap();
    let system = ancf_core::assembly::System::new(std::sync::Arc::new(model)).unwrap();
    let refused = options(Method::Rigid, Steps::fixed(1e-3), 1.0).validate(&system).unwrap_err();
    assert_eq!(refused.argument, "method");
}
