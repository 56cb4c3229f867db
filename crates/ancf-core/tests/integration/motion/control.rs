//! Error control, and independent methods that agree.

use super::common::{distance, end, hang, options, pendulum, pendulum_of, plate_of, rubber, simulate, tip};
use ancf_core::Material;
use ancf_core::dynamics::{Method, Steps};
use ancf_core::element::Kind;
use ancf_core::report::Outcome;

/// Every method, refined, brings the tip of the pendulum to the same place.
#[test]
fn independent_methods_agree() {
    let meshes = [
        // The check values of an independent prototype; the first came out of two implementations.
        (2, 1.25e-4, [0.22634, 0.22634, -0.44155], 2e-6),
        (4, 1.25e-4, [0.22844, 0.22844, -0.44649], 2e-6),
        // The NumPy path at a step of 1e-3 s.
        (8, 2.5e-4, [0.232723, 0.232723, -0.437612], 1e-5),
    ];
    for (divisions, step, expected, tolerance) in meshes {
        let model = pendulum(divisions);
        let tips = Method::ALL.map(|method| {
            let step = match method {
                Method::Esdirk => 4.0 * step,
                // Below its limit all the way.
                Method::Rk => 0.5 * step,
                _ => step,
            };
            let mut options = options(method, Steps::fixed(step), 0.3);
            options.newton.reuse = true;
            tip(&model, &end(model.clone(), &options))
        });
        for (method, tip) in Method::ALL.iter().zip(tips) {
            for c in 0..3 {
                assert!((tip[c] - tips[7][c]).abs() < tolerance, "{}: {tip:?} {:?}", method.name(), tips[7]);
                assert!((tip[c] - expected[c]).abs() < 2e-5, "{}: {tip:?}", method.name());
            }
        }
    }
}

/// Rubber and steel, thick and thin: each method keeps the tolerance with the steps it chooses.
/// `benchmarks/motion.py tolerances` prints the errors on all meshes.
#[test]
fn tolerances_are_kept() {
    let plates = [(0.01, 1e5), (0.0005, 1e5), (0.01, 2e11), (0.0005, 2e11)];
    for (divisions, plates) in [(1, &plates[..]), (2, &plates[..]), (4, &plates[3..])] {
        for &(thickness, young) in plates {
            let model = pendulum_of(divisions, thickness, Material::new(young, 0.3, 7810.0).unwrap());
            let reference = end(model.clone(), &options(Method::Esdirk, Steps::controlled(3e-6), 0.3));
            for method in Method::ALL.into_iter().filter(|method| method.is_implicit() || young < 1e6) {
                for rtol in [1e-3, 1e-4] {
                    let mut options = options(method, Steps::controlled(rtol), 0.3);
                    options.outputs = vec![0.1, 0.2, 0.3];
                    options.newton.reuse = true;
                    let (states, run) = simulate(model.clone(), &options);
                    assert_eq!(run.outcome, Outcome::Ok);
                    assert_eq!(states.iter().map(|state| state.t).collect::<Vec<_>>(), options.outputs);
                    let error = distance(&model, &states[2], &reference) / (0.3 * 2.0_f64.sqrt());
                    let name = method.name();
                    assert!(error < 10.0 * rtol, "{divisions} {thickness} {young:e} {name} {rtol}: {error}");
                }
            }
        }
    }
}

/// A thick plate of steel hardly deforms and swings in few long steps, in which the order of Runge-Kutta methods falls.
/// Their tolerances are kept there too, whatever they are. `benchmarks/motion.py sweep` prints this for all methods.
#[test]
fn tolerances_are_kept_where_a_body_is_nearly_rigid() {
    let model = pendulum_of(1, 0.01, Material::new(2e11, 0.3, 7810.0).unwrap());
    // Another method, without elasticity.
    let reference = end(model.clone(), &options(Method::Rigid, Steps::controlled(1e-9), 0.3));
    for method in [Method::Esdirk, Method::TrBdf2] {
        for k in 0..20 {
            let rtol = 10.0_f64.powf(-2.0 - 0.1 * f64::from(k));
            let found = end(model.clone(), &options(method, Steps::controlled(rtol), 0.3));
            let error = distance(&model, &found, &reference) / (0.3 * 2.0_f64.sqrt());
            assert!(error < 3.0 * rtol, "{} {rtol:.1e}: {error:.1e}", method.name());
        }
    }
}

/// However loose the tolerance, explicit steps stay stable: what grows in the gradients, which error control does not
/// see, never comes to move positions. The thick solid has its highest frequencies there.
#[test]
fn loose_tolerances_do_not_hide_unstable_explicit_steps() {
    for divisions in [2, 8] {
        let model = hang(plate_of(Kind::Full48a, divisions, 0.3, 0.01, rubber()));
        let reference = end(model.clone(), &options(Method::Esdirk, Steps::controlled(1e-5), 0.3));
        for method in [Method::Verlet { lumped: false }, Method::Rk] {
            for rtol in [0.3, 0.1] {
                let found = end(model.clone(), &options(method, Steps::controlled(rtol), 0.3));
                let error = distance(&model, &found, &reference) / (0.3 * 2.0_f64.sqrt());
                assert!(error < 1e-3, "{divisions} {} {rtol}: {error}", method.name());
            }
        }
    }
}
