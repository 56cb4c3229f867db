//! A motion that is stopped anywhere, even within a step, goes on to the same states with the same effort.

use std::cell::Cell;
use std::sync::Arc;

use super::common::{options, pendulum_of, rubber};
use ancf_core::assembly::System;
use ancf_core::dynamics::{self, Checkpoint, Method, Options, Steps, Tolerances};
use ancf_core::model::{History, Load, LoadKind, Model};
use ancf_core::observe::{Observer, State};
use ancf_core::report::{Outcome, Run};
use ancf_core::{Damping, Material};

/// Stops the solve when it is asked for the given time, and keeps its last checkpoint.
struct Stopping {
    states: Vec<State>,
    questions: Cell<usize>,
    checkpoint: Vec<u8>,
}

impl Observer for Stopping {
    fn state(&mut self, state: State) {
        self.states.push(state);
    }

    fn wants_checkpoints(&self) -> bool {
        true
    }

    fn checkpoint(&mut self, make: &dyn Fn(&[State]) -> Vec<u8>, last: bool) {
        if last {
            self.checkpoint = make(&self.states);
        }
    }

    fn stop(&self) -> bool {
        let left = self.questions.get().saturating_sub(1);
        self.questions.set(left);
        left == 0
    }
}

/// Runs up to the question with the given number, from the bytes of a checkpoint if there are any.
fn run(model: &Model, options: &Options, questions: usize, from: &[u8]) -> (Stopping, Run) {
    let (checkpoint, states) = match Checkpoint::from_bytes(from) {
        Ok((checkpoint, states)) => (Some(checkpoint), states),
        Err(_) => (None, Vec::new()),
    };
    let mut observer = Stopping { states, questions: Cell::new(questions), checkpoint: Vec::new() };
    let mut system = System::new(Arc::new(model.clone())).unwrap();
    let run = dynamics::simulate(&mut system, options, checkpoint, &mut observer).unwrap();
    (observer, run)
}

#[test]
fn a_run_that_is_stopped_anywhere_goes_on_to_the_same_bits() {
    let steel = || pendulum_of(2, 0.0005, Material::new(2e11, 0.3, 7810.0).unwrap());
    let viscous = rubber().with_damping(Damping { mass: 0.1, viscosity: 1e-4 }).unwrap();
    let mut struck = pendulum_of(2, 0.01, rubber());
    let blow = History::table((0..40).map(|k| [0.005 * f64::from(k), f64::from(k % 2)]).collect()).unwrap();
    struck.add_load(Load { kind: LoadKind::Gravity([20.0, 0.0, 0.0]), history: blow }).unwrap();
    let cases = [
        (struck, Method::EnergyMomentum, Steps::controlled(1e-3)),
        (steel(), Method::Esdirk, Steps::controlled(1e-3)),
        (steel(), Method::TrBdf2, Steps::controlled(3e-3)),
        (steel(), Method::Hht { alpha: -0.05 }, Steps::controlled(1e-3)),
        (pendulum_of(2, 0.01, viscous), Method::EnergyMomentum, Steps::fixed(2e-3)),
        (pendulum_of(2, 0.01, rubber()), Method::Rk, Steps::fixed(4e-4)),
    ];
    for (model, method, steps) in cases {
        let mut options = options(method, steps, 0.2);
        options.outputs = (0..=20).map(|k| 0.01 * f64::from(k)).collect();
        options.newton.reuse = true;
        let (whole, expected) = run(&model, &options, usize::MAX, &[]);
        assert_eq!(expected.outcome, Outcome::Ok);
        assert_eq!(whole.states.len(), 21);
        let (mut checkpoint, mut stops) = (Vec::new(), 0);
        let (found, counts) = loop {
            // Never the same place in a step, and always further than one step.
            let (found, run) = run(&model, &options, 100 + 37 * stops % 83, &checkpoint);
            if run.outcome == Outcome::Ok {
                break (found.states, run.counts);
            }
            // All outputs so far, and perhaps the last good state.
            let outputs = found.states.iter().filter(|state| options.outputs.contains(&state.t));
            assert!(outputs.eq(whole.states.iter().take_while(|state| state.t <= run.reached)));
            (checkpoint, stops) = (found.checkpoint, stops + 1);
        };
        assert!(stops > 2, "{} {stops}", method.name());
        assert_eq!(found, whole.states, "{}", method.name());
        assert_eq!(counts, expected.counts, "{}", method.name());
    }
}

/// What a rejected step has changed is not in the checkpoint: it is tried again.
#[test]
fn a_run_that_is_stopped_after_a_rejected_step_tries_it_again() {
    let model = pendulum_of(1, 0.01, rubber());
    let too_long = Tolerances { rtol: 1e-3, first_step: Some(0.1), ..Tolerances::default() };
    let mut options = options(Method::Hht { alpha: -0.05 }, Steps::Controlled(too_long), 0.1);
    options.newton.reuse = true;
    let (whole, expected) = run(&model, &options, usize::MAX, &[]);
    assert!(expected.counts.rejected.inaccurate > 1);
    for question in 2..30 {
        let (stopped, end) = run(&model, &options, question, &[]);
        assert_eq!(end.outcome, Outcome::Interrupted);
        let (found, end) = run(&model, &options, usize::MAX, &stopped.checkpoint);
        assert_eq!((found.states.last(), end.counts), (whole.states.last(), expected.counts), "{question}");
    }
}
