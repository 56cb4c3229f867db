//! Results do not depend on units, on where the load points, or on which side of the plate is held.
//!
//! Reference: the same scene in SI units, unmirrored.
//! Goal: equality to the tolerance of the solver.
//! Mesh: 4 x 3 elements.

use ancf_core::dynamics::Method;
use ancf_core::element::Membrane;
use ancf_core::model::{LoadKind, Model};
use ancf_core::observe::State;
use ancf_core::report::Outcome;
use ancf_core::statics::{self, Options};

use crate::common::{add_constant, add_ramp, distance, line, motion, plate, rectangle, simulate, system};

/// How many units of mass, length and time make up a kilogram, a metre and a second.
#[derive(Clone, Copy)]
struct Units {
    mass: f64,
    length: f64,
    time: f64,
}

const SI: Units = Units { mass: 1.0, length: 1.0, time: 1.0 };
/// Tonne, millimetre, second: the units of forces in N and stresses in MPa.
const TONNE_MILLIMETRE: Units = Units { mass: 1e-3, length: 1e3, time: 1.0 };
/// Gram, centimetre, microsecond.
const GRAM_CENTIMETRE_MICROSECOND: Units = Units { mass: 1e3, length: 1e2, time: 1e6 };

impl Units {
    /// A quantity given in SI units, of the dimension `mass^m length^l time^t`.
    fn of(self, value: f64, [m, l, t]: [i32; 3]) -> f64 {
        value * self.mass.powi(m) * self.length.powi(l) * self.time.powi(t)
    }
}

/// A plate under its weight and a pressure; its material depends on whether it bends statically or swings.
fn scene(units: Units, young: f64, thickness: f64) -> Model {
    let acceleration = |a: f64| units.of(a, [0, 1, -2]);
    let stress = |s: f64| units.of(s, [1, -1, -2]);
    let length = |l: f64| units.of(l, [0, 1, 0]);
    let section = plate(stress(young), 0.3, units.of(1000.0, [1, -3, 0]), length(thickness), Membrane::Projected);
    let (mut model, body) = rectangle([length(0.4), length(0.3)], [4, 3], section);
    model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
    add_constant(&mut model, LoadKind::Gravity([0.0, acceleration(1.0), acceleration(-9.81)]));
    add_constant(&mut model, LoadKind::Pressure { body, pressure: stress(20.0) });
    model
}

/// Positions of all nodes in metres.
fn positions(model: &Model, state: &State, units: Units) -> Vec<f64> {
    let body = &model.bodies()[0];
    let nodes = (0..body.grid().nodes()).map(|node| 3 * body.vector(node, 0));
    nodes.flat_map(|first| state.q[first..first + 3].to_vec()).map(|x| x / units.length).collect()
}

fn solve(model: &Model) -> State {
    let mut states = Vec::new();
    let run = statics::solve(&mut system(model.clone()), &Options::default(), &mut states).unwrap();
    assert_eq!(run.outcome, Outcome::Ok);
    states.pop().unwrap()
}

fn assert_equal(found: &[f64], expected: &[f64], rest: &[f64], tolerance: f64, name: &str) {
    let moved = distance(expected, rest);
    let error = distance(found, expected);
    assert!(moved > 0.01, "{name}: the plate moves by {moved} m only");
    assert!(error < tolerance, "{name}: {error:e} m");
}

#[test]
fn equilibria_do_not_depend_on_units() {
    let solution = |units: Units| {
        let mut model = scene(units, 2e9, 0.004);
        let edge = line(model.find("plate").unwrap(), "edge:x1", [0.0, 0.0, units.of(-5.0, [1, 0, -2])]);
        add_constant(&mut model, edge);
        positions(&model, &solve(&model), units)
    };
    let rest = scene(SI, 2e9, 0.004);
    let reference = State { q: rest.reference().to_vec(), ..solve(&rest) };
    let rest = positions(&rest, &reference, SI);
    for (units, name) in [(TONNE_MILLIMETRE, "t mm s"), (GRAM_CENTIMETRE_MICROSECOND, "g cm us")] {
        assert_equal(&solution(units), &solution(SI), &rest, 1e-10, name);
    }
}

#[test]
fn motions_do_not_depend_on_units() {
    let solution = |units: Units| {
        let model = scene(units, 1e6, 0.01);
        let [until, step] = [0.1, 0.002].map(|t| units.of(t, [0, 0, 1]));
        let mut system = system(model.clone());
        let end = simulate(&mut system, &motion(Method::Hht { alpha: -0.05 }, until, step, vec![0.0, until]));
        [0, 1].map(|i| positions(&model, &end[i], units))
    };
    let [rest, expected] = solution(SI);
    for (units, name) in [(TONNE_MILLIMETRE, "t mm s"), (GRAM_CENTIMETRE_MICROSECOND, "g cm us")] {
        assert_equal(&solution(units)[1], &expected, &rest, 1e-10, name);
    }
}

/// A strip held at one edge and loaded at the opposite one, `along` the axis that the load is far along.
fn cantilever(along: usize, from_low: bool, force: [f64; 3]) -> (Vec<f64>, Vec<f64>, usize) {
    let (mut size, mut divisions) = ([0.5, 0.3], [4, 3]);
    if along == 1 {
        size.reverse();
        divisions.reverse();
    }
    let (mut model, body) = rectangle(size, divisions, plate(2e11, 0.3, 7800.0, 0.001, Membrane::Projected));
    let axis = ["x", "y"][along];
    let (held, loaded) = if from_low { (0, 1) } else { (1, 0) };
    model.clamp(body, format!("edge:{axis}{held}").parse().unwrap()).unwrap();
    add_ramp(&mut model, line(body, &format!("edge:{axis}{loaded}"), force));
    let state = solve(&model);
    let found = positions(&model, &state, SI);
    let rest = positions(&model, &State { q: model.reference().to_vec(), ..state }, SI);
    (found, rest, divisions[0] + 1)
}

/// Where a mirror takes a node and a position.
type Image<'a> = dyn Fn(usize, &[f64]) -> (usize, [f64; 3]) + 'a;

/// Mirrored at the plane of the plate, at its middle, and at the diagonal of the axes.
#[test]
fn mirror_images_deform_alike() {
    let (expected, rest, columns) = cantilever(0, true, [0.0, 3.0, -20.0]);
    let nodes = expected.len() / 3;
    let compare = |found: &[f64], image: &Image, name: &str| {
        let mut mirrored = vec![0.0; found.len()];
        for (node, r) in found.chunks(3).enumerate() {
            let (to, r) = image(node, r);
            mirrored[3 * to..3 * to + 3].copy_from_slice(&r);
        }
        assert_equal(&mirrored, &expected, &rest, 1e-10, name);
    };

    let (up, ..) = cantilever(0, true, [0.0, 3.0, 20.0]);
    compare(&up, &|node, r| (node, [r[0], r[1], -r[2]]), "z");

    let (right, ..) = cantilever(0, false, [0.0, 3.0, -20.0]);
    let across = |node: usize| node / columns * columns + (columns - 1 - node % columns);
    compare(&right, &|node, r| (across(node), [0.5 - r[0], r[1], r[2]]), "x");

    let (side, _, other) = cantilever(1, true, [3.0, 0.0, -20.0]);
    assert_eq!(nodes % other, 0);
    compare(&side, &|node, r| (node % other * columns + node / other, [r[1], r[0], r[2]]), "diagonal");
}
