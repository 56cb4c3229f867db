//! Motion: what every member of the generalised-alpha family must keep, and how fast its errors vanish.
//!
//! Reference: rigid-body mechanics; conservation laws; the order of the method.
//! Goal: exact free fall from the first step on, momenta kept, order 2.
//! Mesh: 2 x 2 elements.

use ancf_core::dynamics::Method;
use ancf_core::element::Membrane;
use ancf_core::model::LoadKind;

use crate::common::{
    add_constant, distance, field, largest, line, monomial, motion, moved, pendulum, plate, rectangle, simulate, system,
};

fn methods() -> Vec<(String, Method)> {
    let hht = [0.0, -0.05, -0.3].map(|alpha| (format!("HHT {alpha}"), Method::Hht { alpha }));
    let general =
        [0.0, 0.5, 1.0].map(|rho| (format!("generalised-alpha {rho}"), Method::GeneralizedAlpha { rho_inf: rho }));
    hht.into_iter().chain(general).collect()
}

/// Times `step`, `2 step`, ..., made as the steps are.
fn every(step: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| k as f64 * step).collect()
}

#[test]
fn a_free_plate_falls_as_a_rigid_body() {
    let gravity = [1.5, -0.5, -9.81];
    for membrane in Membrane::ALL {
        for (name, method) in methods() {
            let (mut model, body) = rectangle([0.4, 0.3], [2, 2], plate(2e11, 0.3, 7810.0, 0.002, membrane));
            add_constant(&mut model, LoadKind::Gravity(gravity));
            let uniform = field(&model, body, |orders, at| gravity.map(|g| g * monomial([0, 0], orders, at)));
            let mut system = system(model);
            let states = simulate(&mut system, &motion(method, 0.1, 0.01, every(0.01, 9)));
            assert_eq!(states.len(), 10);
            for state in states {
                let expected = moved(system.model().reference(), 0.5 * state.t * state.t, &uniform);
                let name = format!("{membrane:?}, {name}, t = {}", state.t);
                assert!(distance(&state.q, &expected) < 1e-12, "{name}: {:e}", distance(&state.q, &expected));
            }
        }
    }
}

/// The family keeps momentum to rounding. Angular momentum it does not keep exactly: the trapezoidal rule changes it by
/// `h/4 (q_1 - q_0) x (F_1 - F_0)` a step, which adds up to a multiple of `h^2`: 4e-7 at 1e-3 s, 6e-11 at this step.
#[test]
fn a_spinning_free_plate_keeps_its_momenta() {
    let (model, body) = rectangle([0.4, 0.3], [2, 2], plate(1e8, 0.3, 1000.0, 0.01, Membrane::Projected));
    let spin = nalgebra::Vector3::new(1.0, -0.5, 2.0);
    let velocity = field(&model, body, |orders, at| {
        let part = |powers| monomial(powers, orders, at);
        let position = nalgebra::Vector3::new(part([1, 0]), part([0, 1]), 0.0);
        (nalgebra::Vector3::new(0.5, 0.0, -1.0) * part([0, 0]) + spin.cross(&position)).into()
    });
    for alpha in [0.0, -0.05] {
        let mut options = motion(Method::Hht { alpha }, 0.02, 2e-5, vec![0.0, 0.01, 0.02]);
        options.velocity = Some(velocity.clone());
        let states = simulate(&mut system(model.clone()), &options);
        for state in &states[1..] {
            let momentum = distance(&state.momentum, &states[0].momentum) / largest(&states[0].momentum);
            let angular =
                distance(&state.angular_momentum, &states[0].angular_momentum) / largest(&states[0].angular_momentum);
            assert!(momentum < 1e-10 && angular < 1e-10, "alpha {alpha}, t = {}: {momentum:e}, {angular:e}", state.t);
        }
    }
}

/// The rubber pendulum with full integration: halving the step divides the errors by four.
#[test]
fn errors_vanish_with_the_square_of_the_step() {
    let until = 0.1;
    for (name, method) in methods() {
        let ends: Vec<_> = [1e-3, 5e-4, 2.5e-4]
            .into_iter()
            .map(|step| {
                let mut system = pendulum([2, 2], Membrane::Full);
                simulate(&mut system, &motion(method, until, step, vec![until])).pop().unwrap()
            })
            .collect();
        let position = (distance(&ends[0].q, &ends[1].q) / distance(&ends[1].q, &ends[2].q)).log2();
        let balance: Vec<_> = ends.iter().map(|end| end.kinetic + end.strain.total() - end.work).collect();
        let energy = (balance[1] / balance[2]).abs().log2();
        println!("{name}: order {position:.3} of the position, {energy:.3} of the energy balance");
        assert!((position - 2.0).abs() < 0.1, "{name}: order {position} of the position");
        assert!((energy - 2.0).abs() < 0.1, "{name}: order {energy} of the energy balance");
    }
}

/// The pendulum at t = 0.3 s, on which two implementations agree.
#[test]
fn the_rubber_pendulum_swings_as_known() {
    let mut system = pendulum([2, 2], Membrane::Full);
    let method = Method::Hht { alpha: 0.0 };
    let end = simulate(&mut system, &motion(method, 0.3, 2.5e-4, vec![0.3])).pop().unwrap();
    let node = system.model().bodies()[0].grid().nodes() - 1;
    let first = 3 * system.model().bodies()[0].vector(node, 0);
    let [x, y, z] = [end.q[first], end.q[first + 1], end.q[first + 2]];
    assert!((x - y).abs() < 1e-8, "{x}, {y}");
    assert!((x - 0.22634).abs() < 2e-5 && (z + 0.44155).abs() < 2e-5, "{x}, {z}");
}

/// At the start the free coordinates obey the equations of motion, and what is fixed stays to the last bit.
#[test]
fn supports_hold_from_the_start() {
    let (mut model, body) = rectangle([0.4, 0.3], [3, 2], plate(1e6, 0.3, 1000.0, 0.01, Membrane::Full));
    model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
    add_constant(&mut model, LoadKind::Gravity([0.0, 3.0, -9.81]));
    add_constant(&mut model, line(body, "edge:x1", [1.0, 0.0, 2.0]));
    let mut system = system(model);
    for (name, method) in methods() {
        let states = simulate(&mut system, &motion(method, 0.02, 0.002, every(0.002, 9)));
        let mut force = vec![0.0; system.coordinates()];
        system.external_force(&states[0].q, 0.0, &mut force);
        let scale = largest(&force);
        let inertia: Vec<_> = states[0].a.iter().map(|a| -a).collect();
        system.add_mass_times(&inertia, &mut force);
        for &i in system.free() {
            assert!(force[i].abs() < 1e-12 * scale, "{name}: coordinate {i} starts with {:e}", force[i]);
        }
        for state in &states {
            for i in (0..state.q.len()).filter(|i| system.model().fixed()[*i]) {
                let held = state.q[i] == system.model().reference()[i] && state.v[i] == 0.0 && state.a[i] == 0.0;
                assert!(held, "{name}: coordinate {i} moves at t = {}", state.t);
            }
        }
        assert!(distance(&states[9].q, &states[0].q) > 1e-4, "{name}: the plate moves");
    }
}
