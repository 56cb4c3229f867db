//! What a motion keeps: energy and momenta, damping and moved supports in the balance, bits after a restart.

use std::sync::Arc;

use super::common::{end, options, pendulum_of, plate, rubber, simulate};
use ancf_core::assembly::System;
use ancf_core::dynamics::{self, Checkpoint, Method, Options, Steps};
use ancf_core::element::{Kind, NodalVector};
use ancf_core::mesh::Surface;
use ancf_core::model::{Course, Fix, History, Load, LoadKind, Model, Plate, SupportMotion};
use ancf_core::observe::{Observer, State};
use ancf_core::report::{Outcome, Run};
use ancf_core::{Damping, Material};

/// A free plate that turns and strongly bends.
fn flight(model: &Model) -> Vec<f64> {
    let mut v = vec![0.0; model.reference().len()];
    for (node, v) in v.chunks_mut(9).enumerate() {
        let (x, y) = (model.reference()[9 * node] - 0.15, model.reference()[9 * node + 1] - 0.15);
        let bend = 120.0;
        let position = [1.0 - 5.0 * y, 5.0 * x, 3.0 * x + bend * (x * x - y * y + x * y)];
        let along_x = [0.0, 5.0, 3.0 + bend * (2.0 * x + y)];
        let along_y = [-5.0, 0.0, bend * (x - 2.0 * y)];
        v.copy_from_slice(&[position, along_x, along_y].concat());
    }
    v
}

fn drift(states: &[State]) -> [f64; 3] {
    let size = |x: [f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let change = |a: [f64; 3], b: [f64; 3]| size([0, 1, 2].map(|i| a[i] - b[i])) / size(a);
    let energy = |state: &State| state.kinetic + state.strain.total();
    let first = &states[0];
    states.iter().fold([0.0; 3], |worst: [f64; 3], state| {
        let now = [
            (energy(state) / energy(first) - 1.0).abs(),
            change(first.momentum, state.momentum),
            change(first.angular_momentum, state.angular_momentum),
        ];
        [0, 1, 2].map(|i| worst[i].max(now[i]))
    })
}

/// Energy and momenta stay to rounding at a step at which the trapezoidal rule gains energy until it fails.
/// `benchmarks/motion.py conservation` prints the same over 1e5 steps.
#[test]
fn free_flight_keeps_energy_and_momenta() {
    let (model, _) = plate(2, 0.3, 0.01, Material::new(1e7, 0.3, 7810.0).unwrap());
    let run = |method, reuse| {
        let mut options = options(method, Steps::fixed(1.5e-3), 3.0);
        options.velocity = Some(flight(&model));
        options.outputs = (0..=20).map(|k| 0.15 * f64::from(k)).collect();
        options.newton.tolerance = 1e-12;
        options.newton.reuse = reuse;
        simulate(model.clone(), &options)
    };
    for reuse in [false, true] {
        let (states, ended) = run(Method::EnergyMomentum, reuse);
        assert_eq!(ended.outcome, Outcome::Ok);
        assert!(states.iter().any(|state| state.strain.total() > 0.2 * state.kinetic), "strongly deforming");
        let [energy, momentum, angular] = drift(&states);
        assert!(energy < 5e-11 && momentum < 1e-13 && angular < 1e-12, "{energy:e} {momentum:e} {angular:e}");
    }
    let (states, ended) = run(Method::Newmark, false);
    assert!(matches!(ended.outcome, Outcome::Failed(_)) && drift(&states)[0] > 1e-2);
}

/// However far a body has moved, momentum is kept to its last digits: accelerations do not come from rounded positions.
/// At 100 m those would change it by 1e-11.
#[test]
fn momentum_does_not_suffer_from_distance() {
    let (model, _) = plate(2, 0.3, 0.01, rubber());
    let mut velocity = flight(&model);
    velocity.iter_mut().step_by(9).for_each(|x| *x += 100.0);
    for method in [Method::Hht { alpha: -0.05 }, Method::TrBdf2, Method::EnergyMomentum] {
        let mut options = options(method, Steps::fixed(1e-3), 1.0);
        options.velocity = Some(velocity.clone());
        options.outputs = vec![0.0, 1.0];
        let (states, run) = simulate(model.clone(), &options);
        assert_eq!(run.outcome, Outcome::Ok);
        let change = (states[1].momentum[0] / states[0].momentum[0] - 1.0).abs();
        assert!(change < 2e-14, "{}: {change:e}", method.name());
    }
}

/// What damping takes is what the balance of the others leaves, for every method and both kinds of damping.
#[test]
fn damping_is_in_the_balance() {
    for damping in [Damping { mass: 3.0, viscosity: 0.0 }, Damping { mass: 0.0, viscosity: 5e-3 }] {
        let model = pendulum_of(2, 0.01, rubber().with_damping(damping).unwrap());
        let mut tips = Vec::new();
        for method in Method::ALL {
            let state = end(model.clone(), &options(method, Steps::fixed(2.5e-4), 0.3));
            let missing = state.kinetic + state.strain.total() + state.dissipated - state.work;
            assert!(state.dissipated > 0.02 * state.work, "{} {} of {}", method.name(), state.dissipated, state.work);
            assert!(missing.abs() < 2e-5 * state.work, "{}: {missing:e} of {}", method.name(), state.work);
            tips.push(super::common::tip(&model, &state));
        }
        for (method, tip) in Method::ALL.iter().zip(&tips) {
            for c in 0..3 {
                assert!((tip[c] - tips[7][c]).abs() < 1e-5, "{}: {tip:?} {:?}", method.name(), tips[7]);
            }
        }
    }
}

/// The same for the other elements: what Kelvin-Voigt and mass damping take is in the balance, and an independent
/// explicit method loses as much.
#[test]
fn every_element_is_damped() {
    let damping = Damping { mass: 1.0, viscosity: 5e-3 };
    let material = Material::new(1e5, 0.3, 1000.0).unwrap().with_damping(damping).unwrap();
    for element in [Kind::Thin48, Kind::Full48a, Kind::Full48b] {
        let section = Plate { material, thickness: 0.03, element, membrane: None, curvature: None };
        let mut model = Model::new();
        let body = model.add_body("plate", &Surface::rectangle([0.3, 0.2]).unwrap(), [2, 1], section).unwrap();
        model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
        super::common::gravity(&mut model, -9.81);
        let states = [Method::EnergyMomentum, Method::Hht { alpha: 0.0 }, Method::Esdirk, Method::Rk].map(|method| {
            // The solids' thickness stretches fast: explicit steps are limited to 1e-4 s.
            let steps = if method.is_implicit() { Steps::fixed(2e-4) } else { Steps::controlled(1e-6) };
            let mut options = options(method, steps, 0.2);
            options.newton.reuse = true;
            end(model.clone(), &options)
        });
        for state in &states {
            let missing = state.kinetic + state.strain.total() + state.dissipated - state.work;
            let name = element.name();
            assert!(state.dissipated > 0.02 * state.work, "{name}: {} of {}", state.dissipated, state.work);
            assert!(missing.abs() < 1e-4 * state.work, "{name}: {missing:e} of {}", state.work);
            let error = super::common::distance(&model, state, &states[3]);
            assert!(error < 2e-5, "{name}: {error:e}");
        }
    }
}

/// A free rigid body in a viscous medium slows down as exp(-c t), whatever it is made of.
#[test]
fn mass_damping_slows_a_rigid_body_exponentially() {
    let material = rubber().with_damping(Damping { mass: 2.0, viscosity: 1e-3 }).unwrap();
    let (model, _) = plate(1, 0.3, 0.01, material);
    let velocity: Vec<f64> = (0..4).flat_map(|_| [1.0, 2.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
    for method in Method::ALL {
        let mut options = options(method, Steps::fixed(1e-3), 0.5);
        options.velocity = Some(velocity.clone());
        let state = end(model.clone(), &options);
        assert!((state.v[1] - 2.0 * (-1.0_f64).exp()).abs() < 1e-6, "{}: {}", method.name(), state.v[1]);
    }
}

/// A shaken edge: methods agree, and the work of the support closes the balance.
#[test]
fn moved_supports_do_work() {
    let (mut model, body) = plate(2, 0.3, 0.01, Material::new(1e6, 0.3, 1000.0).unwrap());
    let all = [NodalVector::R, NodalVector::RX, NodalVector::RY].map(|vector| Fix { vector, component: None });
    let motion = SupportMotion {
        translation: vec![(
            [0.0, 0.0, 1.0],
            Course::table("translation", vec![[0.0, 0.0], [0.1, 0.01], [0.2, -0.01], [0.3, 0.02]]).unwrap(),
        )],
        rotation: Some((
            [0.0; 3],
            [0.0, 1.0, 0.0],
            Course::table("rotation.angle", vec![[0.0, 0.0], [0.2, 0.3], [0.3, 0.7]]).unwrap(),
        )),
    };
    model.move_support(body, "edge:x0".parse().unwrap(), &all, motion).unwrap();
    let states = Method::ALL.map(|method| end(model.clone(), &options(method, Steps::fixed(2e-4), 0.3)));
    for (method, state) in Method::ALL.iter().zip(&states) {
        let missing = state.kinetic + state.strain.total() - state.work;
        assert!(missing.abs() < 2e-3 * state.work, "{}: {missing:e} of {}", method.name(), state.work);
        let error = super::common::distance(&model, state, &states[7]);
        assert!(error < 2e-5, "{}: {error:e}", method.name());
        for moved in model.moved() {
            let [q, v, _] = model.prescribed(moved, 0.3);
            assert!((state.q[moved.coordinate] - q).abs() < 1e-14 && (state.v[moved.coordinate] - v).abs() < 1e-14);
        }
    }
}

/// Keeps states, and the checkpoint after a number of steps, where it stops.
struct Stops {
    states: Vec<State>,
    left: usize,
    checkpoint: Vec<u8>,
}

impl Observer for Stops {
    fn state(&mut self, state: State) {
        self.states.push(state);
    }

    fn wants_checkpoints(&self) -> bool {
        true
    }

    fn checkpoint(&mut self, make: &dyn Fn(&[State]) -> Vec<u8>, last: bool) {
        self.left = self.left.saturating_sub(usize::from(!last));
        self.checkpoint = make(&self.states);
    }

    fn stop(&self) -> bool {
        self.left == 0
    }
}

fn run(model: &Model, options: &Options, from: Option<Checkpoint>, steps: usize) -> (Stops, Run) {
    let mut system = System::new(Arc::new(model.clone())).unwrap();
    let mut stops = Stops { states: Vec::new(), left: steps, checkpoint: Vec::new() };
    let run = dynamics::simulate(&mut system, options, from, &mut stops).unwrap();
    (stops, run)
}

/// Stopped anywhere, written, read and resumed: the same bits and the same counts.
#[test]
fn a_resumed_run_has_the_same_bits() {
    let model = super::common::pendulum(2);
    for method in Method::ALL {
        for (steps, reuse) in [(Steps::fixed(3e-3), true), (Steps::controlled(1e-3), true), (Steps::fixed(3e-3), false)]
        {
            let mut options = options(method, steps, 0.15);
            options.outputs = vec![0.01, 0.05, 0.1, 0.15];
            options.newton.reuse = reuse;
            let (whole, ended) = run(&model, &options, None, usize::MAX);
            assert_eq!(ended.outcome, Outcome::Ok);
            for stop in [1, 2, 7, ended.counts.steps - 1].into_iter().filter(|stop| *stop < ended.counts.steps) {
                let (first, stopped) = run(&model, &options, None, stop);
                assert_eq!(stopped.outcome, Outcome::Interrupted);
                let bytes = first.checkpoint;
                assert!(Checkpoint::from_bytes(&bytes[..bytes.len() - 1]).is_err());
                let mut flipped = bytes.clone();
                flipped[stop * 997 % bytes.len()] ^= 1;
                assert!(Checkpoint::from_bytes(&flipped).is_err());
                let (checkpoint, before) = Checkpoint::from_bytes(&bytes).unwrap();
                assert_eq!(checkpoint.t(), stopped.reached);
                let (second, resumed) = run(&model, &options, Some(checkpoint), usize::MAX);
                let states = [before, second.states].concat();
                assert!(states == whole.states, "{} {steps:?} reuse {reuse} stopped after {stop}", method.name());
                assert_eq!((resumed.outcome, resumed.counts), (Outcome::Ok, ended.counts), "{}", method.name());
            }
        }
    }
}

/// A checkpoint is refused by every other run, and the message says what differs.
#[test]
fn a_checkpoint_of_another_run_is_refused() {
    let model = super::common::pendulum(2);
    let options = options(Method::Hht { alpha: -0.05 }, Steps::fixed(3e-3), 0.15);
    let (stopped, _) = run(&model, &options, None, 3);
    let (checkpoint, _) = Checkpoint::from_bytes(&stopped.checkpoint).unwrap();
    let refused = |model: Model, options: &Options| {
        let mut system = System::new(Arc::new(model)).unwrap();
        let refused = dynamics::simulate(&mut system, options, Some(checkpoint.clone()), &mut Vec::new());
        refused.expect_err("another run").to_string()
    };
    let softer = pendulum_of(2, 0.01, Material::new(0.9e5, 0.3, 7810.0).unwrap());
    assert!(refused(softer, &options).contains("other bodies"));
    assert!(refused(pendulum_of(2, 0.011, rubber()), &options).contains("other bodies"));
    let mut heavier = model.clone();
    super::common::gravity(&mut heavier, -1e-3);
    assert!(refused(heavier, &options).contains("other loads"));
    let mut held = model.clone();
    let body = held.find("plate").unwrap();
    held.clamp(body, "corner:x1y1".parse().unwrap()).unwrap();
    assert!(refused(held, &options).contains("other supports"));
    let mut others = vec![options.clone(), options.clone(), options.clone()];
    others[0].method = Method::Hht { alpha: -0.1 };
    others[1].steps = Steps::fixed(2e-3);
    others[2].newton.tolerance = 1e-9;
    for other in &others {
        assert!(refused(model.clone(), other).contains("other options"));
    }
    let mut system = System::new(Arc::new(model)).unwrap();
    assert!(dynamics::simulate(&mut system, &options, Some(checkpoint), &mut Vec::new()).is_ok());
}

/// A kept factorisation leads to the same motion with far fewer factorisations.
#[test]
fn reuse_saves_factorisations() {
    let model = super::common::pendulum(4);
    let run = |reuse| {
        let mut options = options(Method::Hht { alpha: -0.05 }, Steps::fixed(5e-4), 0.15);
        options.newton.reuse = reuse;
        let (mut states, run) = simulate(model.clone(), &options);
        assert_eq!(run.outcome, Outcome::Ok);
        (states.pop().unwrap(), run.counts)
    };
    let ((every, counts), (kept, fewer)) = (run(false), run(true));
    assert!(super::common::distance(&model, &every, &kept) < 1e-9);
    println!("{counts:?}\n{fewer:?}");
    assert!(3 * fewer.factorizations < counts.factorizations, "{fewer:?} {counts:?}");
}

/// A free body with a lumped mass falls as it is: every node by `g t^2 / 2`, its gradients stay, nothing is strained, and
/// its momentum is that of its whole mass.
#[test]
fn a_body_of_lumped_mass_falls_rigidly() {
    let (g, until) = ([1.0, 2.0, -9.81], 0.05);
    for kind in Kind::ALL {
        let shapes = [Surface::rectangle([0.3, 0.2]).unwrap(), Surface::cylinder(0.3, [0.0, 1.0], [0.0, 0.2]).unwrap()];
        for surface in shapes {
            let mut model = Model::new();
            let plate = Plate { material: rubber(), thickness: 0.01, element: kind, membrane: None, curvature: None };
            model.add_body("body", &surface, [6, 4], plate).unwrap();
            let system = System::new(Arc::new(model.clone())).unwrap();
            let mass: f64 = system.positions().map(|a| system.weight()[a]).sum();
            model.add_load(Load { kind: LoadKind::Gravity(g), history: History::Constant }).unwrap();
            let fall = options(Method::Verlet { lumped: true }, Steps::fixed(5e-4), until);
            let state = end(model.clone(), &fall);
            let vectors = model.bodies()[0].nodal_vectors().len();
            for (i, (q, rest)) in state.q.iter().zip(model.reference()).enumerate() {
                let expected = if i / 3 % vectors == 0 { 0.5 * g[i % 3] * until * until } else { 0.0 };
                assert!((q - rest - expected).abs() < 1e-12, "{kind:?} coordinate {i}: {q} from {rest}");
            }
            assert!(state.strain.total() < 1e-20 * state.kinetic, "{kind:?}: {:?}", state.strain);
            for (momentum, g) in state.momentum.iter().zip(g) {
                assert!((momentum / (mass * g * until) - 1.0).abs() < 1e-12);
            }
        }
    }
}
