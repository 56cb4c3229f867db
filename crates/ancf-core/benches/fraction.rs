//! How near the element kernels come to the core's limit: time of one element, and its floating-point operations a second
//! as a share of what a loop of fused multiply-adds reaches in the same run.
//!
//! One thread, elements strained and turned at random, without the sum into global arrays. Operations are counted from
//! tables and formulas ([`ancf_core::element::Operations`]). Each row is the median over repetitions in which the loop is
//! timed just before the element, so that both see the same clock; the machine should do nothing else.

use std::hint::black_box;
use std::time::Instant;

use ancf_core::Material;
use ancf_core::element::{At, Kind, Membrane, Want};
use ancf_core::mesh::{Surface, SurfacePoint};
use ancf_core::model::{Model, Plate};

mod loops;

/// Side of the square plate, m.
const SIZE: f64 = 0.3;
/// Least time of a repetition, s.
const SPAN: f64 = 2e-4;
const REPETITIONS: usize = 60;

/// Floating-point operations a second.
fn peak() -> f64 {
    let start = Instant::now();
    loops::multiply_add(4000) / start.elapsed().as_secs_f64()
}

/// Seconds of a call, mean over so many.
fn seconds(calls: usize, mut work: impl FnMut()) -> f64 {
    let start = Instant::now();
    for _ in 0..calls {
        work();
    }
    start.elapsed().as_secs_f64() / calls as f64
}

/// A square plate, flat or bent so that no two elements are congruent.
fn model(element: Kind, membrane: Option<Membrane>, n: usize, curved: bool) -> Model {
    let material = Material::new(1e5, 0.3, 7810.0).unwrap();
    let plate = Plate { material, thickness: 0.01, element, membrane, curvature: None };
    let mut surface = Surface::rectangle([SIZE; 2]).unwrap();
    if curved {
        let at = |i: usize| SIZE * (i % (n + 1)) as f64 / n as f64;
        let points = (0..(n + 1) * (n + 1)).map(|node| {
            let (x, y) = (at(node), at(node / (n + 1)));
            let z = x * x + 0.5 * x * y * y;
            let r_x = [1.0, 0.0, 2.0 * x + 0.5 * y * y];
            SurfacePoint { r: [x, y, z], r_x, r_y: [0.0, 1.0, x * y], r_xy: [0.0, 0.0, y] }
        });
        surface = Surface::from_nodes([[0.0, SIZE]; 2], [n, n], points.collect()).unwrap();
    }
    let mut model = Model::new();
    model.add_body("plate", &surface, [n, n], plate).unwrap();
    model
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn row(element: Kind, membrane: Option<Membrane>, n: usize, curved: bool) {
    let model = model(element, membrane, n, curved);
    let elements = model.bodies()[0].elements(model.reference());
    let q: Vec<f64> = model.reference().iter().enumerate().map(|(i, x)| x + 1e-3 * (0.37 * i as f64).sin()).collect();
    let tangent = Want { mass: 1.0, stiffness: 1.0, previous: None };
    let operations = elements.operations();
    let all: Vec<u32> = (0..(n * n) as u32).collect();
    let mut cells = String::new();
    for (want, operations) in [(None, operations.force), (Some(tangent), operations.tangent)] {
        let mut work = || {
            elements.evaluate(&all, At::rest(black_box(&q)), want, &mut |portion| {
                black_box(&portion);
            });
        };
        let once = seconds(1, &mut work);
        let calls = (SPAN / once).ceil() as usize;
        let pairs = (0..REPETITIONS).map(|_| {
            let peak = peak();
            let time = seconds(calls, &mut work) / (n * n) as f64;
            (time, operations as f64 / time / peak)
        });
        let (times, shares): (Vec<_>, Vec<_>) = pairs.unzip();
        let (time, share) = (median(times) * 1e6, median(shares) * 100.0);
        cells += &format!(" {:.1} | {time:.3} | {share:.0} |", operations as f64 / 1e3);
    }
    let membrane = membrane.map_or("", Membrane::name);
    let shape = if curved { "curved" } else { "flat" };
    println!("| `{}` | {membrane} | {shape} | {} |{cells}", element.name(), n * n);
}

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
    let (name, lanes) = ancf_core::simd();
    let fastest = (0..REPETITIONS).map(|_| peak()).fold(0.0, f64::max);
    println!("{name}, {lanes} elements side by side; fused multiply-adds: {:.1} GFlop/s.\n", fastest / 1e9);
    println!(
        "| element | membrane | shape | elements | force: kFlop | us | % of peak | tangent: kFlop | us | % of peak |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for membrane in Membrane::ALL {
        for n in [1, 2, 4, 8, 64] {
            row(Kind::Thin36, Some(membrane), n, false);
        }
        row(Kind::Thin36, Some(membrane), 64, true);
    }
    for membrane in [Membrane::Projected, Membrane::Full] {
        row(Kind::Thin48, Some(membrane), 64, false);
    }
    for solid in [Kind::Full48a, Kind::Full48b] {
        row(solid, None, 64, false);
    }
}
