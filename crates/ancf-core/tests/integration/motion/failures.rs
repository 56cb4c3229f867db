//! What cannot go on says so, and keeps what it had.

use super::common::{end, options, pendulum, plate, rubber, simulate};
use ancf_core::Material;
use ancf_core::dynamics::{Method, Steps, Tolerances};
use ancf_core::element::NodalVector;
use ancf_core::model::{Course, Fix, History, Load, LoadKind, SupportMotion};
use ancf_core::nonlinear::Failure;
use ancf_core::report::Outcome;

fn failure(outcome: Outcome) -> Failure {
    match outcome {
        Outcome::Failed(failure) => failure,
        other => panic!("{other:?}"),
    }
}

/// The limit that is reported is the limit: just below it a motion is stable, above it is refused, and forced it blows up.
#[test]
fn explicit_steps_above_the_limit_are_refused() {
    let model = pendulum(2);
    let (_, run) = simulate(model.clone(), &options(Method::Verlet { lumped: false }, Steps::fixed(0.1), 0.3));
    let Failure::StepAboveLimit { step, limit, .. } = failure(run.outcome) else { panic!() };
    assert_eq!(step, 0.1);
    // As the plate is drawn out it stiffens, and the limit falls: 0.8 of that at rest is refused on the way, 0.7 holds.
    let (states, run) =
        simulate(model.clone(), &options(Method::Verlet { lumped: false }, Steps::fixed(0.8 * limit), 0.3));
    let Failure::StepAboveLimit { t, limit: later, .. } = failure(run.outcome) else { panic!() };
    // That of the first such state, from which on nothing is kept.
    assert!(t > 0.2 && (0.79..0.8).contains(&(later / limit)), "{t} {later} {limit}");
    assert_eq!((states.last().unwrap().t, run.reached), (t, t));
    assert!(states.is_sorted_by(|a, b| a.t < b.t));
    end(model.clone(), &options(Method::Verlet { lumped: false }, Steps::fixed(0.7 * limit), 0.3));
    let forced = Steps::Fixed { step: 1.5 * limit, force: true };
    let (_, run) = simulate(model.clone(), &options(Method::Verlet { lumped: false }, forced, 3.0));
    assert!(matches!(failure(run.outcome), Failure::Overflow { .. }));
    let message = Failure::StepAboveLimit { t: 0.0, step, limit }.to_string();
    assert!(message.contains(&format!("{limit:.4e}")), "{message}");
}

/// A plate that is pressed into itself faster than it can resist: its energy stays finite, so that every method could go on
/// through no area at all and out on the other side. None does, whatever its steps, and states are kept.
#[test]
fn a_collapsing_element_ends_a_run() {
    let (mut model, body) = plate(2, 0.3, 0.01, rubber());
    model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
    let kind = LoadKind::Line {
        body,
        edge: ancf_core::model::Model::edge_at("edge:x1".parse().unwrap()).unwrap(),
        per_length: [-1e9, 0.0, 0.0],
    };
    model.add_load(Load { kind, history: History::table(vec![[0.1, 0.0], [0.2, 1.0]]).unwrap() }).unwrap();
    let controlled = Steps::Controlled(Tolerances { rtol: 1e-3, min_step: 1e-4, ..Tolerances::default() });
    for method in Method::ALL {
        for steps in [controlled, Steps::fixed(1e-3)] {
            let mut options = options(method, steps, 0.3);
            options.outputs = vec![0.05, 0.1, 0.3];
            let (states, run) = simulate(model.clone(), &options);
            let failure = failure(run.outcome);
            assert!(states.len() >= 2 && (0.1..0.11).contains(&run.reached), "{} {}", method.name(), run.reached);
            match (&failure, steps) {
                (Failure::Collapsed { place, .. }, Steps::Fixed { .. }) => {
                    assert!(place.ends_with("of body \"plate\""), "{place}");
                }
                // What is pressed together is so stiff that before it collapses explicit steps are not stable any more.
                (Failure::StepAboveLimit { limit, .. }, Steps::Fixed { .. }) if !method.is_implicit() => {
                    assert!(*limit < 1e-4);
                }
                (Failure::StepTooSmall { .. }, Steps::Controlled(_)) => (),
                _ => panic!("{} {steps:?}: {failure}", method.name()),
            }
            assert!(states.iter().all(|state| state.q.iter().all(|x| x.is_finite())));
        }
    }
}

/// The same load at a fixed step: the step that cannot be made is a failure, not accepted.
#[test]
fn a_load_that_cannot_be_carried_ends_a_fixed_run() {
    let (mut model, body) = plate(1, 0.3, 0.0005, rubber());
    model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
    let history = History::table(vec![[0.1, 0.0], [0.11, 1.0]]).unwrap();
    model.add_load(Load { kind: LoadKind::Pressure { body, pressure: 1e9 }, history }).unwrap();
    let mut options = options(Method::Hht { alpha: -0.05 }, Steps::fixed(0.01), 0.3);
    options.outputs = vec![0.1, 0.3];
    let (states, run) = simulate(model, &options);
    assert_eq!(states.len(), 1);
    assert!((run.reached - 0.1).abs() < 1e-12 && run.counts.rejected.total() == 1);
    let failure = failure(run.outcome);
    assert!(
        matches!(failure, Failure::NotConverged { .. } | Failure::Diverged { .. } | Failure::NotFinite { .. }),
        "{failure}"
    );
}

#[test]
fn a_plate_without_mass_cannot_move() {
    let (model, _) = plate(1, 0.3, 0.01, Material::new(1e5, 0.3, 0.0).unwrap());
    for method in Method::ALL {
        let (_, run) = simulate(model.clone(), &options(method, Steps::fixed(0.01), 0.1));
        assert_eq!(failure(run.outcome), Failure::Massless { body: "plate".into() });
    }
}

#[test]
fn contradictory_motions_are_refused() {
    let (mut model, body) = plate(2, 0.3, 0.01, rubber());
    let shaken = |frequency| SupportMotion {
        translation: vec![([0.0, 0.0, 1.0], Course::Sine { amplitude: 0.01, frequency })],
        ..SupportMotion::default()
    };
    let r = [Fix { vector: NodalVector::R, component: None }];
    model.move_support(body, "edge:x0".parse().unwrap(), &r, shaken(2.0)).unwrap();
    // The corner belongs to both edges.
    let before = model.clone();
    let error = model.move_support(body, "edge:y0".parse().unwrap(), &r, shaken(3.0)).unwrap_err();
    assert_eq!(error.argument, "at");
    assert!(model.fix(body, "corner:x0y1".parse().unwrap(), &[r[0]]).is_err());
    assert_eq!((model.fixed(), model.moved()), (before.fixed(), before.moved()), "nothing is changed by an error");
    model.move_support(body, "edge:y0".parse().unwrap(), &r, shaken(2.0)).unwrap();
    let late = SupportMotion {
        translation: vec![([1.0; 3], Course::table("translation", vec![[0.0, 1.0], [1.0, 2.0]]).unwrap())],
        ..SupportMotion::default()
    };
    assert!(model.move_support(body, "edge:x1".parse().unwrap(), &r, late).is_err());
}

#[test]
fn a_tolerance_below_rounding_says_so() {
    let mut options = options(Method::Hht { alpha: -0.05 }, Steps::fixed(1e-3), 0.3);
    options.newton.tolerance = 1e-15;
    let model = super::common::pendulum_of(4, 0.0005, Material::new(2e11, 0.3, 7810.0).unwrap());
    let (_, run) = simulate(model, &options);
    let failure = failure(run.outcome);
    assert!(matches!(failure, Failure::BelowRounding { tolerance: 1e-15, .. }), "{failure}");
    assert!(Steps::controlled(1e-15).validate().is_err());
}
