//! Time of whole solves, the making of the system included, and of the linear algebra of a large plate.

use std::hint::black_box;
use std::sync::Arc;

use ancf_core::Material;
use ancf_core::assembly::System;
use ancf_core::dynamics::{self, Method, Steps};
use ancf_core::element::{Kind, Membrane, NodalVector, Want};
use ancf_core::mesh::Surface;
use ancf_core::model::{Fix, History, Load, LoadKind, Model, Plate};
use ancf_core::report::Outcome;
use ancf_core::statics;
use criterion::{Criterion, criterion_group, criterion_main};

fn plate(young: f64, thickness: f64, membrane: Membrane) -> Plate {
    let material = Material::new(young, 0.3, 7810.0).unwrap();
    Plate { material, thickness, element: Kind::Thin36, membrane: Some(membrane), curvature: None }
}

/// The rubber pendulum of Dufva and Shabana (2005), 0.3 x 0.3 x 0.01 m, a corner pinned, under gravity.
fn pendulum() -> Arc<Model> {
    let mut model = Model::new();
    let surface = Surface::rectangle([0.3, 0.3]).unwrap();
    let body = model.add_body("plate", &surface, [8, 8], plate(1e5, 0.01, Membrane::Full)).unwrap();
    model.fix(body, "corner:x0y0".parse().unwrap(), &[Fix { vector: NodalVector::R, component: None }]).unwrap();
    let kind = LoadKind::Gravity([0.0, 0.0, -9.81]);
    model.add_load(Load { kind, history: History::Constant }).unwrap();
    Arc::new(model)
}

/// The steel cantilever of the same paper, 30 N on its end.
fn cantilever(divisions: [usize; 2]) -> Arc<Model> {
    let mut model = Model::new();
    let surface = Surface::rectangle([0.5, 0.15]).unwrap();
    let body = model.add_body("plate", &surface, divisions, plate(2.07e11, 0.001, Membrane::Projected)).unwrap();
    model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
    let edge = Model::edge_at("edge:x1".parse().unwrap()).unwrap();
    let kind = LoadKind::Line { body, edge, per_length: [0.0, 0.0, -200.0] };
    model.add_load(Load { kind, history: History::Ramp }).unwrap();
    Arc::new(model)
}

fn motion(criterion: &mut Criterion) {
    let model = pendulum();
    let options = dynamics::Options {
        until: 0.02,
        steps: Steps::fixed(1e-3),
        method: Method::Hht { alpha: -0.05 },
        outputs: vec![0.02],
        velocity: None,
        newton: Default::default(),
    };
    criterion.bench_function("8 x 8 pendulum, 20 steps", |bencher| {
        bencher.iter(|| {
            let mut system = System::new(Arc::clone(&model)).unwrap();
            let run = dynamics::simulate(&mut system, &options, None, &mut Vec::new()).unwrap();
            assert_eq!(run.outcome, Outcome::Ok);
        });
    });
}

fn equilibrium(criterion: &mut Criterion) {
    let model = cantilever([32, 8]);
    criterion.bench_function("32 x 8 cantilever", |bencher| {
        bencher.iter(|| {
            let mut system = System::new(Arc::clone(&model)).unwrap();
            let run = statics::solve(&mut system, &statics::Options::default(), &mut Vec::new()).unwrap();
            assert_eq!(run.outcome, Outcome::Ok);
        });
    });
}

fn linear_algebra(criterion: &mut Criterion) {
    let mut system = System::new(cantilever([64, 64])).unwrap();
    let rest = system.model().reference().to_vec();
    let (mut force, mut solution) = (vec![0.0; rest.len()], vec![0.0; rest.len()]);
    system.assemble(&rest, 1.0, Want { mass: 0.0, stiffness: 1.0, previous: None }, &mut force);
    system.external_force(&rest, 1.0, &mut force);
    criterion.bench_function("64 x 64 plate, factorise", |bencher| bencher.iter(|| system.factorize().unwrap()));
    system.factorize().unwrap();
    criterion.bench_function("64 x 64 plate, solve", |bencher| {
        bencher.iter(|| system.solve(black_box(&force), &mut solution));
    });
}

criterion_group!(benches, motion, equilibrium, linear_algebra);
criterion_main!(benches);
