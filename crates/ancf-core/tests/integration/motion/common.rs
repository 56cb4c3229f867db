//! Models that several tests move.
use std::sync::Arc;

use ancf_core::Material;
use ancf_core::assembly::System;
use ancf_core::dynamics::{self, Method, Options, Steps};
use ancf_core::element::{Kind, Membrane};
use ancf_core::mesh::Surface;
use ancf_core::model::{BodyId, Fix, History, Load, LoadKind, Model, Plate};
use ancf_core::nonlinear;
use ancf_core::observe::State;
use ancf_core::report::{Outcome, Run};

/// A square plate, flat and at rest.
pub fn plate(divisions: usize, side: f64, thickness: f64, material: Material) -> (Model, BodyId) {
    plate_of(Kind::Thin36, divisions, side, thickness, material)
}

/// The same of another element.
pub fn plate_of(element: Kind, divisions: usize, side: f64, thickness: f64, material: Material) -> (Model, BodyId) {
    let membrane = (element == Kind::Thin36).then_some(Membrane::Full);
    let plate = Plate { material, thickness, element, membrane, curvature: None };
    let mut model = Model::new();
    let surface = Surface::rectangle([side, side]).unwrap();
    let body = model.add_body("plate", &surface, [divisions, divisions], plate).unwrap();
    (model, body)
}

/// The pendulum of Dufva and Shabana (2005): a square plate, pinned at a corner, falls from rest.
pub fn pendulum_of(divisions: usize, thickness: f64, material: Material) -> Model {
    hang(plate(divisions, 0.3, thickness, material))
}

/// Pins a plate at a corner and lets it fall.
pub fn hang((mut model, body): (Model, BodyId)) -> Model {
    let fix = Fix { vector: ancf_core::element::NodalVector::R, component: None };
    model.fix(body, "corner:x0y0".parse().unwrap(), &[fix]).unwrap();
    gravity(&mut model, -9.81);
    model
}

/// The same of rubber, 10 mm thick.
pub fn pendulum(divisions: usize) -> Model {
    pendulum_of(divisions, 0.01, rubber())
}

pub fn rubber() -> Material {
    Material::new(1e5, 0.3, 7810.0).unwrap()
}

pub fn gravity(model: &mut Model, g: f64) {
    let load = Load { kind: LoadKind::Gravity([0.0, 0.0, g]), history: History::Constant };
    model.add_load(load).unwrap();
}

/// Options with tight Newton iterations.
pub fn options(method: Method, steps: Steps, until: f64) -> Options {
    let newton = nonlinear::Options { tolerance: 1e-11, ..Default::default() };
    Options { until, steps, method, outputs: vec![until], velocity: None, newton }
}

/// Runs a motion; the states and how it ended.
pub fn simulate(model: Model, options: &Options) -> (Vec<State>, Run) {
    let mut system = System::new(Arc::new(model)).unwrap();
    let mut states = Vec::new();
    let run = dynamics::simulate(&mut system, options, None, &mut states).unwrap();
    (states, run)
}

/// The last state of a motion that reaches its end.
pub fn end(model: Model, options: &Options) -> State {
    let (mut states, run) = simulate(model, options);
    assert_eq!(run.outcome, Outcome::Ok, "{options:?}");
    states.pop().unwrap()
}

/// The position of the last node of the first body.
pub fn tip(model: &Model, state: &State) -> [f64; 3] {
    let body = &model.bodies()[0];
    let vector = body.vector(body.grid().nodes() - 1, 0);
    [0, 1, 2].map(|c| state.q[3 * vector + c])
}

/// Largest difference of two states in position.
pub fn distance(model: &Model, a: &State, b: &State) -> f64 {
    let body = &model.bodies()[0];
    let vectors = (0..body.grid().nodes()).map(|node| body.vector(node, 0));
    vectors.flat_map(|v| 3 * v..3 * v + 3).map(|c| (a.q[c] - b.q[c]).abs()).fold(0.0, f64::max)
}
