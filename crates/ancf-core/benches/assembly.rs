//! Assembly on several threads: time of force and tangent of the whole system, how much of it is the sum at the nodes, and
//! the parallel efficiency, `time on one thread / (threads x time on so many)`.
//!
//! What the machine allows is timed in the same turns:
//!
//! * rows "apart": as many bodies as threads, each with its share of the elements and summed on a thread of its own at the
//!   same time, until the last is done. They share nothing but clock, caches and memory;
//! * "memory": a loop that adds to as many numbers as the tangent has, once, on as many threads, as a share of the time for
//!   the tangent: the sum cannot take less;
//! * "of registers": the efficiency of as long a loop of fused multiply-adds in registers, which share nothing at all.
//!
//! The table shows the fastest of many repetitions.

use std::hint::black_box;
use std::sync::{Arc, Barrier};
use std::thread::{self, available_parallelism};
use std::time::{Duration, Instant};

use ancf_core::Material;
use ancf_core::assembly::System;
use ancf_core::element::{Kind, Membrane, Want};
use ancf_core::mesh::Surface;
use ancf_core::model::{Model, Plate};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

mod loops;

/// The time for the repetitions of each body.
const SPAN: Duration = Duration::from_secs(5);

/// Times of an assembly, s.
#[derive(Clone, Copy)]
struct Times {
    force: f64,
    tangent: f64,
    /// Of `tangent`, the sum at the nodes.
    scatter: f64,
}

/// A strained body and its equations.
struct Case {
    system: System,
    q: Vec<f64>,
    force: Vec<f64>,
}

impl Case {
    /// So many elements, squares all of one size.
    fn new(membrane: Membrane, divisions: [usize; 2]) -> Self {
        let material = Material::new(1e5, 0.3, 7810.0).unwrap();
        let plate =
            Plate { material, thickness: 0.01, element: Kind::Thin36, membrane: Some(membrane), curvature: None };
        let sides = divisions.map(|n| 0.3 * n as f64 / divisions[0] as f64);
        let mut model = Model::new();
        model.add_body("plate", &Surface::rectangle(sides).unwrap(), divisions, plate).unwrap();
        let system = System::new(Arc::new(model)).unwrap();
        let q = system.model().reference().iter().enumerate();
        let q: Vec<f64> = q.map(|(i, x)| x + 1e-4 * (0.37 * i as f64).sin()).collect();
        let force = vec![0.0; q.len()];
        Self { system, q, force }
    }

    fn measure(&mut self, pool: &ThreadPool) -> Times {
        let Self { system, q, force } = self;
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
}

/// Times of bodies, each on a thread of its own at the same time: those of the one that takes longest.
fn apart(cases: &mut [(Case, ThreadPool)]) -> Times {
    let barrier = &Barrier::new(cases.len());
    let times = thread::scope(|scope| {
        let work = |(case, pool): &'_ mut (Case, ThreadPool)| {
            barrier.wait();
            case.measure(pool)
        };
        let threads: Vec<_> = cases.iter_mut().map(|case| scope.spawn(move || work(case))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect::<Vec<_>>()
    });
    times.into_iter().max_by(|a, b| a.tangent.total_cmp(&b.tangent)).expect("at least one thread")
}

/// The least times.
fn least(best: &mut Option<Times>, times: Times) {
    let least = best.get_or_insert(times);
    let force = least.force.min(times.force);
    if times.tangent < least.tangent {
        *least = times;
    }
    least.force = force;
}

/// Loops that tell what the machine gives.
struct Loops {
    /// As many as the tangent has.
    numbers: Vec<f64>,
    /// Fused multiply-adds that take as long as the tangent does on one thread.
    rounds: usize,
}

impl Loops {
    fn new(case: &Case, tangent: f64) -> Self {
        const ROUNDS: usize = 20_000;
        let once = (0..10).map(|_| seconds(|| _ = loops::multiply_add(ROUNDS))).fold(f64::MAX, f64::min);
        let rounds = (tangent / once * ROUNDS as f64) as usize;
        Self { numbers: vec![1.0; case.system.tangent().1.len()], rounds }
    }

    /// The time in memory and in registers, s.
    fn measure(&mut self, pool: &ThreadPool) -> [f64; 2] {
        let Self { numbers, rounds } = self;
        let threads = pool.current_num_threads();
        let share = numbers.len().div_ceil(threads);
        let add = |numbers: &mut [f64]| numbers.iter_mut().for_each(|x| *x += 1.0);
        let memory = || black_box(numbers).par_chunks_mut(share).for_each(add);
        let registers = || drop(rayon::broadcast(|_| loops::multiply_add(*rounds / threads)));
        pool.install(|| [seconds(memory), seconds(registers)])
    }
}

/// Seconds that some work takes.
fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn main() {
    let most = available_parallelism().map_or(1, usize::from);
    let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let pools = [1, most].map(pool);
    println!(
        "| membrane | elements | threads | force, ms | tangent, ms | sum at the nodes, % | memory, % | efficiency, % \
         | of registers, % |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for membrane in Membrane::ALL {
        for n in [8, 16, 32, 64, 128] {
            let mut whole = Case::new(membrane, [n, n]);
            let mut shares: Vec<_> =
                (0..most).map(|_| (Case::new(membrane, [n, (n / most).max(1)]), pool(1))).collect();
            let mut best = [None; 3];
            for _ in 0..3 {
                least(&mut best[0], whole.measure(&pools[0]));
            }
            let mut loops = Loops::new(&whole, best[0].expect("times").tangent);
            let mut fastest = [[f64::MAX; 2]; 2];
            let start = Instant::now();
            while start.elapsed() < SPAN {
                for (i, pool) in pools.iter().enumerate() {
                    // As long on all threads as on one: all cores are seldom free at once.
                    for _ in 0..pool.current_num_threads() {
                        least(&mut best[i], whole.measure(pool));
                        for (fastest, time) in fastest[i].iter_mut().zip(loops.measure(pool)) {
                            *fastest = fastest.min(time);
                        }
                    }
                }
                (0..most).for_each(|_| least(&mut best[2], apart(&mut shares)));
            }
            let [one, all, apart] = best.map(|best| best.expect("at least one repetition"));
            let of_registers = 100.0 * fastest[0][1] / (most as f64 * fastest[1][1]);
            let rows = [
                (String::from("1"), 1, one, Some(fastest[0][0]), Some(100.0)),
                (format!("{most}"), most, all, Some(fastest[1][0]), Some(of_registers)),
                (format!("{most} apart"), most, apart, None, None),
            ];
            for (name, threads, times, memory, registers) in rows {
                let percent = |share: Option<f64>| share.map_or(String::new(), |share| format!("{share:.0} "));
                let share = 100.0 * times.scatter / times.tangent;
                let memory = percent(memory.map(|memory| 100.0 * memory / times.tangent));
                let registers = percent(registers);
                let efficiency = 100.0 * one.tangent / (threads as f64 * times.tangent);
                let [force, tangent] = [times.force, times.tangent].map(|t| t * 1e3);
                let membrane = membrane.name();
                println!(
                    "| {membrane} | {n} x {n} | {name} | {force:.3} | {tangent:.3} | {share:.0} | {memory}| {efficiency:.0} \
                     | {registers}|"
                );
            }
        }
    }
}
