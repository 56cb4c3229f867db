//! Loads and moved supports that live for less than a step.

use super::common::{distance, end, options, plate, tip};
use ancf_core::Material;
use ancf_core::dynamics::{Method, Steps};
use ancf_core::model::{BodyId, Course, Fix, History, Load, LoadKind, Model, SupportMotion};

const SIDE: f64 = 0.3;
const THICKNESS: f64 = 0.003;
const DENSITY: f64 = 7850.0;
const START: f64 = 0.33;

fn light_plate(young: f64) -> (Model, BodyId) {
    plate(1, SIDE, THICKNESS, Material::new(young, 0.3, DENSITY).unwrap())
}

/// A free plate in a field that acts as a triangle over time, of the length `duration`.
fn pushed(acceleration: f64, duration: f64) -> Model {
    let (mut model, _) = light_plate(1e7);
    let rows = vec![[0.0, 0.0], [START, 0.0], [START + 0.5 * duration, 1.0], [START + duration, 0.0]];
    let history = History::table(rows).unwrap();
    model.add_load(Load { kind: LoadKind::Gravity([0.0, 0.0, acceleration]), history }).unwrap();
    model
}

/// The velocity after the pulse is its impulse over the mass, the way that of a uniform motion since its middle.
#[test]
fn a_short_pulse_is_not_stepped_over() {
    for method in [&Method::ALL[..], &[Method::Rigid]].concat() {
        for duration in [2e-3, 1e-2] {
            let (acceleration, rtol) = (1000.0, 1e-4);
            let model = pushed(acceleration, duration);
            let state = end(model.clone(), &options(method, Steps::controlled(rtol), 1.0));
            let speed = 0.5 * duration * acceleration;
            let expected = speed * (1.0 - START - 0.5 * duration);
            let found = tip(&model, &state)[2];
            let allowed = 2.0 * rtol * SIDE * 2.0_f64.sqrt();
            assert!((found - expected).abs() < allowed, "{} {duration}: {found} {expected}", method.name());
            assert!((state.v[2] - speed).abs() < 1e-3 * speed, "{} {duration}: {}", method.name(), state.v[2]);
        }
    }
}

/// A plate on moved supports that leave their place for a hundredth of a second only: the plate swings on.
#[test]
fn a_short_motion_of_a_support_is_not_stepped_over() {
    let rows: Vec<[f64; 2]> = (0..=20).map(|k| 0.05 * f64::from(k)).map(|t| [t, 0.0]).collect();
    let pulse = [[0.325, 0.0], [0.33, 1e-2], [0.335, 0.0], [0.34, 0.0], [0.345, 0.0]];
    let mut rows = [&rows[..], &pulse].concat();
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut model, body) = light_plate(1e7);
    let course = Course::table("translation", rows).unwrap();
    let motion = SupportMotion { translation: vec![([0.0, 0.0, 1.0], course)], ..Default::default() };
    let fixes: Vec<Fix> = ["r", "r_x", "r_y"].map(|name| name.parse().unwrap()).to_vec();
    model.move_support(body, "edge:x0".parse().unwrap(), &fixes, motion).unwrap();
    let reference = end(model.clone(), &options(Method::Esdirk, Steps::fixed(1e-4), 0.4));
    for method in [Method::Esdirk, Method::TrBdf2, Method::Hht { alpha: -0.05 }] {
        let rtol = 1e-4;
        let state = end(model.clone(), &options(method, Steps::controlled(rtol), 0.4));
        let error = distance(&model, &state, &reference) / (SIDE * 2.0_f64.sqrt());
        assert!(error < 10.0 * rtol, "{}: {error} of {:?}", method.name(), tip(&model, &reference));
    }
}

/// Rows of a smooth record do not cost a step each.
#[test]
fn a_dense_smooth_record_does_not_set_the_steps() {
    let (mut model, _) = light_plate(1e7);
    let rows = (0..=10_000).map(|k| 1e-4 * f64::from(k)).map(|t| [t, (10.0 * t).sin()]).collect();
    let history = History::table(rows).unwrap();
    model.add_load(Load { kind: LoadKind::Gravity([0.0, 0.0, 1.0]), history }).unwrap();
    let (states, run) = super::common::simulate(model, &options(Method::Esdirk, Steps::controlled(1e-3), 1.0));
    // The double integral of the sine.
    let expected = 0.1 - 0.01 * 10.0_f64.sin();
    assert!((states[0].q[2] - expected).abs() < 1e-3 * SIDE, "{} {expected}", states[0].q[2]);
    assert!(run.counts.steps < 200, "{}", run.counts.steps);
}
