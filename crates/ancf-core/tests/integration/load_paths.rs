//! Load paths: whatever the first step, the solution is the one that the path leads to, through limit points as well.
//!
//! Reference: an independent implementation of the same element, closed forms, and K. Y. Sze, X. H. Liu, S. H. Lo, Popular
//! benchmark problems for geometric nonlinear analysis of shells, Finite Elem. Anal. Des. 40 (2004) 1551-1569.
//! Goal: no other branch by a giant step; a full turn by an end moment; kinks of histories; hinged roofs past their limit
//! points.
//! Mesh: n x 1 elements; 8 x 8 for a quarter of the roofs.

use std::f64::consts::{FRAC_PI_2, PI};

use ancf_core::element::{Membrane, NodalVector};
use ancf_core::mesh::{Edge, Surface};
use ancf_core::model::{BodyId, Fix, History, Load, LoadKind, Model};
use ancf_core::observe::State;
use ancf_core::report::{Outcome, Run};
use ancf_core::statics::{Control, Options, solve};

use crate::common::{add_ramp, line, plate, rectangle, system};

/// A strip clamped at x0.
struct Strip {
    size: [f64; 2],
    elements: usize,
    e: f64,
    nu: f64,
    thickness: f64,
    membrane: Membrane,
}

impl Strip {
    /// Solves with a load on x1.
    fn solve(
        &self,
        load: impl Fn(BodyId, Edge) -> LoadKind,
        history: History,
        load_factors: Vec<f64>,
    ) -> (Run, Vec<State>) {
        let plate = plate(self.e, self.nu, 1.0, self.thickness, self.membrane);
        let (mut model, body) = rectangle(self.size, [self.elements, 1], plate);
        model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
        let edge = Model::edge_at("edge:x1".parse().unwrap()).unwrap();
        model.add_load(Load { kind: load(body, edge), history }).unwrap();
        path(model, &Options { load_factors, ..Options::default() })
    }

    /// Position of the corner x1, y0.
    fn corner(&self, state: &State) -> [f64; 3] {
        state.q[9 * self.elements..][..3].try_into().unwrap()
    }
}

/// The states of a path that must reach its end.
fn path(model: Model, options: &Options) -> (Run, Vec<State>) {
    let mut states = Vec::new();
    let run = solve(&mut system(model), options, &mut states).unwrap();
    assert_eq!(run.outcome, Outcome::Ok, "at {}", run.reached);
    (run, states)
}

/// The steel cantilever whose membrane locks: with `Full` quadrature and few elements it has stable equilibria beside
/// the path, to which Newton's method jumps in one step.
#[test]
fn a_giant_step_does_not_land_on_another_branch() {
    let strip = |elements, thickness| Strip {
        size: [0.5, 0.15],
        elements,
        e: 2.07e11,
        nu: 0.3,
        thickness,
        membrane: Membrane::Full,
    };
    // The NumPy path, in ten load steps: -0.183114.
    for (elements, thickness, total, expected) in [(1, 1e-3, 30.0, Some(-0.183114)), (2, 3e-4, 1.35, None)] {
        let strip = strip(elements, thickness);
        let load = |body, edge| LoadKind::Line { body, edge, per_length: [0.0, 0.0, -total / 0.15] };
        let (run, states) = strip.solve(load, History::Ramp, vec![1.0]);
        let (fine, gentle) = strip.solve(load, History::Ramp, (1..=40).map(|k| f64::from(k) / 40.0).collect());
        let [z, reference] = [&states, &gentle].map(|states| strip.corner(states.last().unwrap())[2]);
        println!("{elements} elements: {} steps to {z:.6}, {} to {reference:.6}", run.counts.steps, fine.counts.steps);
        assert!((z - reference).abs() < 1e-7, "{z} after {} steps, {reference}", run.counts.steps);
        assert!(expected.is_none_or(|expected| (z - expected).abs() < 1e-6), "{z}");
        assert!(run.counts.steps <= 4, "{:?}", run.counts);
    }
}

/// M = 2 pi E I / L rolls a strip into a circle: its end comes back to the clamped edge.
#[test]
fn an_end_moment_rolls_a_strip_into_a_circle() {
    for membrane in Membrane::ALL {
        let strip = Strip { size: [1.0, 0.1], elements: 16, e: 2e11, nu: 0.0, thickness: 1e-3, membrane };
        let per_length = 2.0 * PI * strip.e * strip.thickness.powi(3) / 12.0;
        let moment = |body, edge| LoadKind::Moment { body, edge, per_length };
        let (run, states) = strip.solve(moment, History::Ramp, vec![0.5, 1.0]);
        // Half a turn: -U = L - R sin(L/R), W = R (1 - cos(L/R)), R = L / pi; then the circle.
        for (state, expected) in states[1..].iter().zip([[0.0, 0.0, 2.0 / PI], [0.0; 3]]) {
            let corner = strip.corner(state);
            let error = corner.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < 1e-3, "{membrane:?}: {corner:?} at {}", state.t);
        }
        // Energy of a bent strip: M theta / 2.
        let energy = 0.5 * per_length * 0.1 * 2.0 * PI;
        let State { work, strain, .. } = states.last().unwrap();
        assert!((strain.total() - energy).abs() < 1e-3 * energy, "{membrane:?}: {} {energy}", strain.total());
        assert!((work - energy).abs() < 1e-3 * energy, "{membrane:?}: {work} {energy}");
        println!("{membrane:?}: {:?}", run.counts);
        assert!(run.counts.steps < 12, "{membrane:?}: {:?}", run.counts);
    }
}

/// A load that goes up and comes back within one load factor leaves the strip at rest, through the kink at its top.
#[test]
fn a_load_is_followed_through_the_kinks_of_its_history() {
    let strip =
        Strip { size: [1.0, 0.1], elements: 4, e: 2e11, nu: 0.0, thickness: 1e-3, membrane: Membrane::Projected };
    let line = |body, edge| LoadKind::Line { body, edge, per_length: [0.0, 0.0, -100.0] };
    let history = History::table(vec![[0.0, 0.0], [0.3, 1.0], [0.7, 1.0], [1.0, 0.0]]).unwrap();
    let (_, states) = strip.solve(line, history, vec![0.5, 1.0]);
    let (_, ramp) = strip.solve(line, History::Ramp, vec![1.0]);
    let z = |state: &State| strip.corner(state)[2];
    assert!((z(&states[1]) - z(&ramp[1])).abs() < 1e-7 && z(&ramp[1]) < -0.3, "{} {}", z(&states[1]), z(&ramp[1]));
    assert!(z(&states[2]).abs() < 1e-7, "{}", z(&states[2]));
    assert!(states[2].work.abs() < 1e-9 * states[1].work, "{} {}", states[2].work, states[1].work);
}

/// A hinged cylindrical roof under a central force, a quarter of it: R 2540, length 508, half angle 0.1 rad, E 3102.75,
/// nu 0.3, force 3000 at load factor 1 (mm, N). Returns load factors, deflections and negative pivots along its path.
fn hinged_roof(thickness: f64, control: Control) -> (Run, Vec<[f64; 2]>, Vec<usize>) {
    let mut model = Model::new();
    let surface = Surface::cylinder(2540.0, [FRAC_PI_2 - 0.1, FRAC_PI_2], [0.0, 254.0]).unwrap();
    let plate = plate(3102.75, 0.3, 1.0, thickness, Membrane::Projected);
    let body = model.add_body("roof", &surface, [8, 8], plate).unwrap();
    let mut fix = |place: &str, vector, components: &[usize]| {
        for component in components {
            model.fix(body, place.parse().unwrap(), &[Fix { vector, component: Some(*component) }]).unwrap();
        }
    };
    use NodalVector::{R, RX, RY};
    // The hinge; the planes of symmetry X = 0 and Z = 0.
    for (vector, components) in [(R, [0, 1, 2]), (RY, [0, 1, 2])] {
        fix("edge:x0", vector, &components);
    }
    for (place, normal, along, across) in [("edge:x1", 0, RY, RX), ("edge:y0", 2, RX, RY)] {
        fix(place, R, &[normal]);
        fix(place, along, &[normal]);
        fix(place, across, &[(normal + 1) % 3, (normal + 2) % 3]);
    }
    add_ramp(&mut model, LoadKind::Force { body, point: [FRAC_PI_2, 0.0], force: [0.0, -750.0, 0.0] });
    let first = 3 * model.body(body).vector(8, 0) + 1;
    let options = Options { control, ..Options::default() };
    let (run, states) = path(model, &options);
    let points = states.iter().map(|state| [state.t, 2540.0 - state.q[first]]).collect();
    (run, points, states.iter().map(|state| state.negative_pivots.unwrap()).collect())
}

/// Limit points and the last deflection of the table within 1 %.
#[test]
fn hinged_roofs_snap_through_and_back() {
    // Deflections at load factor 1 are interpolated in the table.
    let cases = [(12.7, [0.7421, 0.1729], 28.876), (6.35, [0.1953, -0.1288], 38.190)];
    for (thickness, limits, deflection) in cases {
        let (run, points, negative) = hinged_roof(thickness, Control::Arc);
        let stable = negative.iter().take_while(|negative| **negative == 0).count();
        let top = points[..=stable].iter().map(|[t, _]| *t).fold(0.0, f64::max);
        let bottom = points[stable..].iter().map(|[t, _]| *t).fold(f64::INFINITY, f64::min);
        for (found, expected) in [top, bottom].into_iter().zip(limits) {
            assert!((found / expected - 1.0).abs() < 0.01, "{thickness}: limit point {found}, expected {expected}");
        }
        let [_, found] = points[points.len() - 1];
        assert!((found / deflection - 1.0).abs() < 0.01, "{thickness}: {found}, expected {deflection}");
        assert_eq!(negative.last(), Some(&0));
        println!("{thickness}: limit points {top:.4}, {bottom:.4}; {:?}", run.counts);
    }
}

/// Under a load that only grows the roofs jump once, at the upper limit point, to the branch that arc length comes to, and
/// set energy free.
#[test]
fn hinged_roofs_jump_under_a_growing_load() {
    for (thickness, limit) in [(12.7, 0.7421), (6.35, 0.1953)] {
        let (run, points, negative) = hinged_roof(thickness, Control::Load);
        let (_, whole, _) = hinged_roof(thickness, Control::Arc);
        println!("{thickness}: jumps at {:?}; {:?}", run.jumps, run.counts);
        assert!(matches!(run.jumps[..], [t] if (t / limit - 1.0).abs() < 0.01), "{thickness}: {:?}", run.jumps);
        let [found, expected] = [&points, &whole].map(|points| points[points.len() - 1][1]);
        assert!((found - expected).abs() < 1e-6 * expected, "{thickness}: {found}, {expected}");
        assert_eq!(negative, [0, 0]);
        assert!(run.counts.steps < 12, "{thickness}: {:?}", run.counts);
    }
}

/// A strip that is held at both ends and pushed together buckles: a bifurcation, where no load pushes it aside. Its half
/// wave is that of Euler's column with clamped ends, whose load is `4 pi^2 E I / L^2`.
#[test]
fn a_compressed_strip_buckles_at_eulers_load() {
    let ([length, width], thickness, young) = ([1.0, 0.1], 0.01, 2e11);
    let (mut model, body) = rectangle([length, width], [8, 1], plate(young, 0.0, 0.0, thickness, Membrane::Projected));
    model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
    let held = [(NodalVector::R, 1), (NodalVector::R, 2), (NodalVector::RX, 1), (NodalVector::RX, 2)];
    for (vector, component) in held {
        model.fix(body, "edge:x1".parse().unwrap(), &[Fix { vector, component: Some(component) }]).unwrap();
    }
    let critical = 4.0 * PI * PI * young * thickness.powi(3) / 12.0 / (length * length);
    add_ramp(&mut model, line(body, "edge:x1", [-1.05 * critical, 0.0, 0.0]));
    let middle = 3 * model.body(body).vector(4, 0) + 2;
    let (run, states) = path(model, &Options::default());
    let deflection = states.last().unwrap().q[middle].abs();
    println!("buckled at {:?} to {deflection:.3}: {:?}", run.jumps, run.counts);
    // The inextensible elastica: K(k) = pi / 2 sqrt(P / P_c), w = L k / K; k = 0.3058 at P / P_c = 1.05.
    let expected = length * 0.3058 / (0.5 * PI * 1.05_f64.sqrt());
    assert!((deflection / expected - 1.0).abs() < 0.01, "{deflection}, expected {expected}");
    assert!(matches!(run.jumps[..], [t] if (1.05 * t - 1.0).abs() < 0.01), "{:?}", run.jumps);
}
