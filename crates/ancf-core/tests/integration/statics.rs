//! Equilibria of a clamped strip.
//!
//! Reference: an independent implementation of the same element (the table), beam theory (closed forms).
//! Goal: the deflections of the paper's steel cantilever; the linear limit; a full turn by an end moment; refusals.
//! Mesh: n x 1 elements.

use std::f64::consts::PI;

use ancf_core::element::{Membrane, NodalVector};
use ancf_core::mesh::Place;
use ancf_core::model::{BodyId, Fix, LoadKind, Model};
use ancf_core::nonlinear::{Failure, Options as NewtonOptions, Variant};
use ancf_core::observe::State;
use ancf_core::report::{Outcome, Run};
use ancf_core::statics::{Options, solve};
use ancf_core::strain::CurvatureLaw;

use crate::common::{add_constant, add_ramp, line, pin, plate, rectangle, system};

/// Solves and returns the run with its last state.
fn run(model: Model, options: &Options) -> (Run, Option<State>) {
    let mut states = Vec::new();
    let run = solve(&mut system(model), options, &mut states).unwrap();
    (run, states.pop())
}

/// Position of a corner at x1.
fn corner(model: &Model, body: BodyId, state: &State) -> [f64; 3] {
    let node = model.body(body).grid().nodes_at("corner:x1y1".parse().unwrap()).unwrap()[0];
    let first = 3 * model.body(body).vector(node, 0);
    [state.q[first], state.q[first + 1], state.q[first + 2]]
}

/// The steel cantilever of Dufva and Shabana (2005), 0.5 x 0.15 x 0.001 m, with 30 N as a dead line load on its end.
fn steel_cantilever(n: usize, membrane: Membrane, curvature: CurvatureLaw) -> (Model, BodyId) {
    let mut plate = plate(2.07e11, 0.3, 7810.0, 0.001, membrane);
    plate.curvature = Some(curvature);
    let (mut model, body) = rectangle([0.5, 0.15], [n, 1], plate);
    model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
    add_ramp(&mut model, line(body, "edge:x1", [0.0, 0.0, -200.0]));
    (model, body)
}

/// Corner deflections that two implementations agree on, to the digits given.
#[test]
fn steel_cantilever_deflects_as_in_the_table() {
    use {CurvatureLaw::*, Membrane::*};
    let table = [
        (Full, Paper, 1, -0.183_114, 1e-6),
        (Full, Paper, 2, -0.261_603, 1e-6),
        (Full, Paper, 4, -0.2817, 5e-5),
        (Lobatto, Koiter, 1, -0.2949, 5e-5),
        (Lobatto, Koiter, 2, -0.2865, 5e-5),
        (Lobatto, Koiter, 4, -0.2850, 5e-5),
        (Projected, Paper, 1, -0.2739, 5e-5),
        (Projected, Paper, 2, -0.2832, 5e-5),
        (Projected, Paper, 4, -0.2847, 5e-5),
    ];
    for (membrane, curvature, n, expected, tolerance) in table {
        let (model, body) = steel_cantilever(n, membrane, curvature);
        let (run, state) = run(model.clone(), &Options { first_step: Some(0.1), ..Options::default() });
        assert_eq!(run.outcome, Outcome::Ok, "{membrane:?}, n = {n}");
        let deflection = corner(&model, body, &state.unwrap())[2];
        assert!((deflection - expected).abs() < tolerance, "{membrane:?}, n = {n}: {deflection}, expected {expected}");
    }
}

/// Mixed integration points need half the iterations of plain Newton or fewer, for the same solution.
#[test]
fn mixed_integration_points_save_iterations() {
    let solve = |variant| {
        let (model, body) = steel_cantilever(4, Membrane::Projected, CurvatureLaw::Paper);
        let newton = NewtonOptions { variant, ..NewtonOptions::default() };
        let (run, state) = run(model.clone(), &Options { newton, ..Options::default() });
        assert_eq!((&run.outcome, run.counts.steps, run.counts.rejected.total()), (&Outcome::Ok, 1, 0), "{variant:?}");
        (run.counts.iterations, corner(&model, body, &state.unwrap())[2])
    };
    let (mixed, deflection) = solve(Variant::MixedIntegrationPoint);
    let (plain, same) = solve(Variant::Plain);
    assert!((deflection - same).abs() < 1e-8, "{deflection}, {same}");
    assert!(mixed <= 10 && plain >= 18, "{mixed} and {plain} iterations");
}

/// The linear limit: `P L^3 / (3 E I)` without Poisson's effect.
#[test]
fn a_small_load_deflects_as_a_beam() {
    let ([length, width], thickness, young) = ([1.0, 0.05], 0.01, 2e11);
    for membrane in Membrane::ALL {
        let (mut model, body) = rectangle([length, width], [8, 1], plate(young, 0.0, 7800.0, thickness, membrane));
        model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
        let inertia = width * thickness.powi(3) / 12.0;
        let deflection = 1e-5 * length;
        let force = deflection * 3.0 * young * inertia / length.powi(3);
        add_ramp(&mut model, line(body, "edge:x1", [0.0, 0.0, force / width]));
        let (_, state) = run(model.clone(), &Options::default());
        let found = corner(&model, body, &state.unwrap())[2];
        assert!((found / deflection - 1.0).abs() < 1e-4, "{membrane:?}: {found}, expected {deflection}");
    }
}

/// An end moment `2 pi E I / L` rolls the strip into a circle, whose end lies on its beginning; half of it lifts the end
/// by `2 L / pi`.
///
/// The strip is kept in a plane: out of it, Newton with the symmetric part of the moment's stiffness no longer converges
/// beyond 0.87 of the circle, where the other part is the larger in two lateral modes.
#[test]
fn an_end_moment_rolls_a_strip_into_a_circle() {
    let ([length, width], thickness, young) = ([1.0, 0.05], 1e-3, 2e11);
    let (mut model, body) =
        rectangle([length, width], [16, 1], plate(young, 0.0, 7800.0, thickness, Membrane::Projected));
    model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
    let out_of_plane = [(NodalVector::R, 1), (NodalVector::RX, 1), (NodalVector::RY, 0), (NodalVector::RY, 2)];
    for (vector, component) in out_of_plane {
        model.fix(body, Place::All, &[Fix { vector, component: Some(component) }]).unwrap();
    }
    let edge = Model::edge_at("edge:x1".parse().unwrap()).unwrap();
    let per_length = 2.0 * PI * young * thickness.powi(3) / 12.0 / length;
    add_ramp(&mut model, LoadKind::Moment { body, edge, per_length });
    let options = Options { first_step: Some(0.1), load_factors: vec![0.5, 1.0], ..Options::default() };
    let mut states = Vec::new();
    let run = solve(&mut system(model.clone()), &options, &mut states).unwrap();
    assert_eq!(run.outcome, Outcome::Ok, "at {}", run.reached);
    for (state, expected) in states[1..].iter().zip([[0.0, 2.0 * length / PI], [0.0, 0.0]]) {
        let [x, _, z] = corner(&model, body, state);
        let error = (x - expected[0]).hypot(z - expected[1]);
        assert!(error < 1e-3 * length, "at {}: {x}, {z}, {error:e} off", state.t);
    }
}

#[test]
fn rigid_motions_are_named() {
    type Support = fn(&mut Model, BodyId);
    let cases: [(Support, &str); 5] = [
        (
            |_, _| (),
            "body \"plate\": translation along x; body \"plate\": translation along y; \
             body \"plate\": translation along z; body \"plate\": rotation about x; \
             body \"plate\": rotation about y; body \"plate\": rotation about z",
        ),
        (
            |model, body| pin(model, body, "corner:x1y1"),
            "body \"plate\": rotation about x; body \"plate\": rotation about y; body \"plate\": rotation about z",
        ),
        (|model, body| pin(model, body, "edge:x0"), "body \"plate\": rotation about y"),
        (|model, body| pin(model, body, "edge:x1"), "body \"plate\": rotation about y"),
        (|model, body| pin(model, body, "edge:y1"), "body \"plate\": rotation about x"),
    ];
    for (support, expected) in cases {
        let (mut model, body) = rectangle([0.5, 0.15], [4, 2], plate(2e11, 0.3, 7800.0, 0.001, Membrane::Projected));
        support(&mut model, body);
        add_constant(&mut model, LoadKind::Gravity([0.0, 0.0, -9.81]));
        let (run, state) = run(model, &Options::default());
        assert_eq!(run.outcome, Outcome::Failed(Failure::Unsupported { motions: expected.to_owned() }));
        assert_eq!((run.reached, run.counts.iterations), (0.0, 0));
        assert!(state.is_none());
    }
}
