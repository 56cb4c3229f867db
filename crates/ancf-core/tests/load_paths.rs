//! Load paths of strips: whatever the first step, the solution is the one that the path leads to.

use std::f64::consts::PI;
use std::sync::Arc;

use ancf_core::assembly::System;
use ancf_core::element::{Kind, Membrane};
use ancf_core::mesh::{Edge, Surface};
use ancf_core::model::{BodyId, History, Load, LoadKind, Model, Plate};
use ancf_core::observe::State;
use ancf_core::report::{Outcome, Run};
use ancf_core::{Material, statics};

const MEMBRANES: [Membrane; 3] = [Membrane::Full, Membrane::Lobatto, Membrane::Projected];

/// A strip clamped at x0 with a load on x1.
struct Strip {
    size: [f64; 2],
    elements: usize,
    e: f64,
    nu: f64,
    thickness: f64,
    membrane: Membrane,
}

impl Strip {
    fn solve(
        &self,
        load: impl Fn(BodyId, Edge) -> LoadKind,
        history: History,
        load_factors: Vec<f64>,
    ) -> (Run, Vec<State>) {
        let plate = Plate {
            material: Material::new(self.e, self.nu, 1.0).unwrap(),
            thickness: self.thickness,
            element: Kind::Thin36,
            membrane: Some(self.membrane),
            curvature: None,
        };
        let mut model = Model::new();
        let surface = Surface::rectangle(self.size).unwrap();
        let body = model.add_body("strip", &surface, [self.elements, 1], plate).unwrap();
        model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
        let edge = Model::edge_at("edge:x1".parse().unwrap()).unwrap();
        model.add_load(Load { kind: load(body, edge), history }).unwrap();
        let mut system = System::new(Arc::new(model)).unwrap();
        let options = statics::Options { load_factors, ..statics::Options::default() };
        let mut states = Vec::new();
        let run = statics::solve(&mut system, &options, &mut states).unwrap();
        assert_eq!(run.outcome, Outcome::Ok);
        (run, states)
    }

    /// Position of the corner x1, y0.
    fn corner(&self, state: &State) -> [f64; 3] {
        state.q[9 * self.elements..][..3].try_into().unwrap()
    }
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
    for membrane in MEMBRANES {
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
