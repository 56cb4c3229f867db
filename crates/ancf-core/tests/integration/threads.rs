//! The same bits on any number of threads.
//!
//! Reference: the run on one thread.
//! Goal: equal bits of all states, not equality to rounding.
//! Mesh: 16 x 16 elements, five parts.

use ancf_core::dynamics::Method;
use ancf_core::element::Membrane;
use ancf_core::model::LoadKind;
use ancf_core::observe::State;
use ancf_core::report::Outcome;
use ancf_core::statics::{self, Options};

use crate::common::{add_constant, add_ramp, line, motion, pendulum, plate, rectangle, simulate, system};

fn with_threads(threads: usize, run: impl Fn() -> Vec<State> + Send + Sync) -> Vec<Vec<u64>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let states = pool.install(run);
    let numbers = |state: State| {
        let energies = [state.strain.membrane, state.strain.bending, state.kinetic, state.work];
        let numbers = state.q.into_iter().chain(state.v).chain(state.a).chain(energies).chain(state.angular_momentum);
        numbers.map(f64::to_bits).collect()
    };
    states.into_iter().map(numbers).collect()
}

fn check(run: impl Fn() -> Vec<State> + Send + Sync) {
    let one = with_threads(1, &run);
    assert!(one.len() > 1);
    for threads in [2, 4] {
        assert!(with_threads(threads, &run) == one, "{threads} threads give other bits");
    }
}

#[test]
fn equilibria_have_the_same_bits() {
    check(|| {
        let (mut model, body) =
            rectangle([0.5, 0.4], [16, 16], plate(2.07e11, 0.3, 7810.0, 0.001, Membrane::Projected));
        model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
        add_ramp(&mut model, line(body, "edge:x1", [0.0, 0.0, -10.0]));
        add_ramp(&mut model, LoadKind::Pressure { body, pressure: 10.0 });
        let mut states = Vec::new();
        let run = statics::solve(&mut system(model), &Options::default(), &mut states).unwrap();
        assert_eq!(run.outcome, Outcome::Ok);
        states
    });
}

#[test]
fn motions_have_the_same_bits() {
    check(|| {
        let mut model = pendulum([16, 16], Membrane::Full).model().clone();
        let body = model.find("plate").unwrap();
        add_constant(&mut model, LoadKind::Pressure { body, pressure: 5.0 });
        simulate(&mut system(model), &motion(Method::Hht { alpha: -0.05 }, 4e-3, 1e-3, vec![1e-3, 4e-3]))
    });
}
