//! Observed orders of convergence against declared ones. `cargo test --test integration orders -- --nocapture` prints the table.

use super::common::{distance, end, gravity, options, pendulum, plate, rubber};
use ancf_core::dynamics::{Method, Options, Steps};
use ancf_core::model::Model;

/// A clamped plate of one element that bends so little, 1e-4 of its side, that it is linear.
fn linear() -> Model {
    let (mut model, body) = plate(1, 0.3, 0.1, rubber());
    model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
    gravity(&mut model, -0.1);
    model
}

/// Velocities across the plate that no single mode has.
fn struck(model: &Model) -> Vec<f64> {
    let speed = |i: usize| if i % 3 == 2 && !model.fixed()[i] { 1e-2 * (i as f64).sin() } else { 0.0 };
    (0..model.reference().len()).map(speed).collect()
}

fn fixed(model: &Model, method: Method, step: f64, until: f64) -> Options {
    let mut options = options(method, Steps::fixed(step), until);
    options.velocity = Some(struck(model));
    options.newton.tolerance = 1e-13;
    options
}

/// Errors at steps that are halved, and the orders they show.
fn table(name: &str, model: &Model, until: f64, coarsest: impl Fn(Method) -> f64) -> Vec<(Method, f64)> {
    // As accurate as rounding allows, by a method that shares nothing with the implicit ones.
    let reference = end(model.clone(), &fixed(model, Method::Rk, until / 4000.0, until));
    println!("{name}\n{:18} declared  {:>9}  errors in m, observed orders", "method", "step/s");
    let mut observed = Vec::new();
    for method in Method::ALL {
        let step = coarsest(method);
        let errors: Vec<f64> = (0..4)
            .map(|k| {
                distance(model, &end(model.clone(), &fixed(model, method, step / f64::from(1 << k), until)), &reference)
            })
            .collect();
        let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
        print!("{:18} {:8}  {step:9.1e}  {:8.1e}", method.name(), method.order(), errors[0]);
        for (error, order) in errors[1..].iter().zip(&orders) {
            print!("  {error:8.1e} ({order:4.2})");
        }
        println!();
        observed.push((method, orders[2]));
    }
    observed
}

fn check(observed: Vec<(Method, f64)>) {
    for (method, order) in observed {
        let declared = method.order() as f64;
        // Above it where the next term of the error is still as large, as for `rk` in the linear problem.
        let expected = declared - 0.25..declared + 0.5;
        assert!(expected.contains(&order), "{}: order {order}, declared {declared}", method.name());
    }
}

#[test]
fn linear_vibration() {
    check(table("clamped plate, small vibration", &linear(), 0.5, |method| match method {
        Method::Esdirk => 0.01,
        Method::Rk => 0.005,
        _ => 0.0025,
    }));
}

#[test]
fn strongly_nonlinear_motion() {
    check(table("rubber pendulum, 2 x 2 elements", &pendulum(2), 0.3, |method| match method {
        Method::Esdirk => 4e-3,
        Method::Rk => 2e-3,
        _ => 1e-3,
    }));
}
