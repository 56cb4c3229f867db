//! Time of one element: its force, and its force with its tangent, for each membrane variant.
//!
//! 64 x 64 elements on one thread, strained and turned at random, the sum into the global arrays included.

use std::hint::black_box;
use std::sync::Arc;

use ancf_core::Material;
use ancf_core::assembly::System;
use ancf_core::element::{Kind, Membrane, Want};
use ancf_core::mesh::Surface;
use ancf_core::model::{Model, Plate};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const DIVISIONS: [usize; 2] = [64, 64];

fn system(membrane: Membrane) -> System {
    let material = Material::new(1e5, 0.3, 7810.0).unwrap();
    let plate = Plate { material, thickness: 0.01, element: Kind::Thin36, membrane: Some(membrane), curvature: None };
    let mut model = Model::new();
    model.add_body("plate", &Surface::rectangle([0.3, 0.3]).unwrap(), DIVISIONS, plate).unwrap();
    System::new(Arc::new(model)).unwrap()
}

/// A wave in every component: no element is at rest and none is like its neighbour.
fn waves(q: &[f64], amplitude: f64) -> Vec<f64> {
    q.iter().enumerate().map(|(i, x)| x + amplitude * (0.37 * i as f64).sin()).collect()
}

fn elements(criterion: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
    for membrane in Membrane::ALL {
        let mut group = criterion.benchmark_group(membrane.name());
        group.throughput(Throughput::Elements((DIVISIONS[0] * DIVISIONS[1]) as u64));
        let mut system = system(membrane);
        let q = waves(system.model().reference(), 1e-4);
        let previous = waves(system.model().reference(), 0.9e-4);
        let mut force = vec![0.0; q.len()];
        group.bench_function("force", |bencher| {
            bencher.iter(|| system.internal_force(black_box(&q), &mut force));
        });
        group.bench_function("force and tangent", |bencher| {
            let want = Want { mass: 1.0, stiffness: 1.0, previous: None };
            bencher.iter(|| system.assemble(black_box(&q), 0.0, want, &mut force));
        });
        group.bench_function("force and mixed-integration-point tangent", |bencher| {
            let want = Want { mass: 1.0, stiffness: 1.0, previous: Some(&previous) };
            bencher.iter(|| system.assemble(black_box(&q), 0.0, want, &mut force));
        });
        group.finish();
    }
}

criterion_group!(benches, elements);
criterion_main!(benches);
