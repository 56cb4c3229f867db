//! Assembly on several threads: time of force and tangent of the whole system, how much of it is the sum at the nodes, and
//! the parallel efficiency, `time on one thread / (threads x time on so many)`.
//!
//! Thread counts take turns, the table shows the fastest of several repetitions.

use std::hint::black_box;
use std::sync::Arc;
use std::thread::available_parallelism;
use std::time::Instant;

use ancf_core::Material;
use ancf_core::assembly::System;
use ancf_core::element::{Kind, Membrane, Want};
use ancf_core::mesh::Surface;
use ancf_core::model::{Model, Plate};
use rayon::{ThreadPool, ThreadPoolBuilder};

const REPETITIONS: usize = 15;

/// Times of an assembly, s.
#[derive(Clone, Copy)]
struct Times {
    force: f64,
    tangent: f64,
    /// Of `tangent`, the sum at the nodes.
    scatter: f64,
}

fn measure(pool: &ThreadPool, system: &mut System, q: &[f64], force: &mut [f64]) -> Times {
    pool.install(|| {
        let start = Instant::now();
        system.internal_force(black_box(q), force);
        let middle = Instant::now();
        let before = system.timers().scatter;
        system.assemble(black_box(q), 0.0, Want { mass: 1.0, stiffness: 1.0, previous: None }, force);
        let tangent = middle.elapsed().as_secs_f64();
        let scatter = (system.timers().scatter - before).as_secs_f64();
        Times { force: (middle - start).as_secs_f64(), tangent, scatter }
    })
}

fn main() {
    let most = available_parallelism().map_or(1, usize::from);
    let pools = [1, most].map(|threads| ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    println!("| membrane | elements | threads | force, ms | tangent, ms | sum at the nodes, % | efficiency, % |");
    println!("|---|---|---|---|---|---|---|");
    for membrane in Membrane::ALL {
        for n in [8, 16, 32, 64, 128] {
            let material = Material::new(1e5, 0.3, 7810.0).unwrap();
            let plate =
                Plate { material, thickness: 0.01, element: Kind::Thin36, membrane: Some(membrane), curvature: None };
            let mut model = Model::new();
            model.add_body("plate", &Surface::rectangle([0.3, 0.3]).unwrap(), [n, n], plate).unwrap();
            let mut system = System::new(Arc::new(model)).unwrap();
            let q = system.model().reference().iter().enumerate();
            let q: Vec<f64> = q.map(|(i, x)| x + 1e-4 * (0.37 * i as f64).sin()).collect();
            let mut force = vec![0.0; q.len()];
            let mut best = [None::<Times>; 2];
            for _ in 0..REPETITIONS {
                for (pool, best) in pools.iter().zip(&mut best) {
                    let times = measure(pool, &mut system, &q, &mut force);
                    let least = best.get_or_insert(times);
                    least.force = least.force.min(times.force);
                    if times.tangent < least.tangent {
                        *least = Times { force: least.force, ..times };
                    }
                }
            }
            let [one, all] = best.map(|best| best.expect("at least one repetition"));
            for (threads, times) in [(1, one), (most, all)] {
                let share = 100.0 * times.scatter / times.tangent;
                let efficiency = 100.0 * one.tangent / (threads as f64 * times.tangent);
                let [force, tangent] = [times.force, times.tangent].map(|t| t * 1e3);
                let name = membrane.name();
                println!(
                    "| {name} | {n} x {n} | {threads} | {force:.3} | {tangent:.3} | {share:.0} | {efficiency:.0} |"
                );
            }
        }
    }
}
