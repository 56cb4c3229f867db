//! What the tests share: scenes, random states, rigid motions, differences.

use std::sync::Arc;

use ancf_core::Material;
use ancf_core::assembly::System;
use ancf_core::dynamics::{self, Method, Steps};
use ancf_core::element::{Kind, Membrane, NodalVector, Want};
use ancf_core::mesh::Surface;
use ancf_core::model::{BodyId, Fix, History, Load, LoadKind, Model, Plate};
use ancf_core::observe::State;
use ancf_core::report::Outcome;
use ancf_core::strain::CurvatureLaw;
use nalgebra::{DMatrix, Rotation3, Vector3};

/// Every way a plate can be modelled: the thin elements with each membrane and curvature they have, the solid ones.
pub fn variants() -> impl Iterator<Item = (Kind, Option<Membrane>, Option<CurvatureLaw>)> {
    let thin = [Kind::Thin36, Kind::Thin48].into_iter().flat_map(|element| {
        let membranes = Membrane::ALL.into_iter().filter(move |m| element == Kind::Thin36 || *m != Membrane::Lobatto);
        membranes.flat_map(move |m| CurvatureLaw::ALL.map(|law| (element, Some(m), Some(law))))
    });
    let solid = Kind::ALL.into_iter().filter(|element| element.is_solid()).map(|element| (element, None, None));
    thin.chain(solid)
}

/// A plate with Young's modulus (Pa), Poisson's ratio, density (kg/m3) and thickness (m), and the paper's curvature.
pub fn plate(young: f64, poisson: f64, density: f64, thickness: f64, membrane: Membrane) -> Plate {
    let material = Material::new(young, poisson, density).unwrap();
    Plate { material, thickness, element: Kind::Thin36, membrane: Some(membrane), curvature: None }
}

/// A model of one rectangle.
pub fn rectangle(size: [f64; 2], divisions: [usize; 2], plate: Plate) -> (Model, BodyId) {
    let mut model = Model::new();
    let body = model.add_body("plate", &Surface::rectangle(size).unwrap(), divisions, plate).unwrap();
    (model, body)
}

/// The system of a model.
pub fn system(model: Model) -> System {
    System::new(Arc::new(model)).unwrap()
}

/// Fixes the positions, but not the gradients, at a place.
pub fn pin(model: &mut Model, body: BodyId, place: &str) {
    model.fix(body, place.parse().unwrap(), &[Fix { vector: NodalVector::R, component: None }]).unwrap();
}

/// A line load on an edge, N/m.
pub fn line(body: BodyId, edge: &str, per_length: [f64; 3]) -> LoadKind {
    LoadKind::Line { body, edge: Model::edge_at(edge.parse().unwrap()).unwrap(), per_length }
}

/// Adds a load that does not vary.
pub fn add_constant(model: &mut Model, kind: LoadKind) {
    model.add_load(Load { kind, history: History::Constant }).unwrap();
}

/// Adds a load that grows with the load factor.
pub fn add_ramp(model: &mut Model, kind: LoadKind) {
    model.add_load(Load { kind, history: History::Ramp }).unwrap();
}

/// The rubber pendulum of Dufva and Shabana (2005): 0.3 x 0.3 x 0.01 m, a corner pinned, under gravity.
pub fn pendulum(divisions: [usize; 2], membrane: Membrane) -> System {
    let (mut model, body) = rectangle([0.3, 0.3], divisions, plate(1e5, 0.3, 7810.0, 0.01, membrane));
    pin(&mut model, body, "corner:x0y0");
    add_constant(&mut model, LoadKind::Gravity([0.0, 0.0, -9.81]));
    system(model)
}

/// A motion with fixed steps, started at rest.
pub fn motion(method: Method, until: f64, step: f64, outputs: Vec<f64>) -> dynamics::Options {
    dynamics::Options { until, steps: Steps::fixed(step), method, outputs, velocity: None, newton: Default::default() }
}

/// The states of a motion that must reach its end.
pub fn simulate(system: &mut System, options: &dynamics::Options) -> Vec<State> {
    let mut states = Vec::new();
    let run = dynamics::simulate(system, options, None, &mut states).unwrap();
    assert_eq!(run.outcome, Outcome::Ok, "at t = {}", run.reached);
    states
}

/// Uniform numbers in [-1, 1); a linear congruential generator with Knuth's MMIX constants.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }

    /// A rotation by up to a full turn.
    pub fn rotation(&mut self) -> Rotation3<f64> {
        Rotation3::new(Vector3::from_fn(|_, _| std::f64::consts::PI * self.next()))
    }
}

/// A state far from rest: every nodal vector changed at random and the whole rotated. Gradients change by up to
/// `amplitude`, positions by up to `amplitude` times the shorter element side.
pub fn random_state(model: &Model, amplitude: f64, random: &mut Random) -> Vec<f64> {
    let mut q = model.reference().to_vec();
    for body in model.bodies() {
        let [l, w] = body.grid().element_sides();
        for node in 0..body.grid().nodes() {
            for (index, vector) in body.nodal_vectors().iter().enumerate() {
                let size = if *vector == NodalVector::R { amplitude * l.min(w) } else { amplitude };
                let first = 3 * body.vector(node, index);
                q[first..first + 3].iter_mut().for_each(|x| *x += size * random.next());
            }
        }
    }
    rotated(&random.rotation(), &q)
}

/// Every nodal vector turned: a rotation about the origin.
pub fn rotated(rotation: &Rotation3<f64>, q: &[f64]) -> Vec<f64> {
    q.chunks(3).flat_map(|r| <[f64; 3]>::from(rotation * Vector3::from_column_slice(r))).collect()
}

/// The nodal coordinates of a field on a body: `derivative` gives its derivative of some orders at a point.
pub fn field(model: &Model, body: BodyId, derivative: impl Fn((i32, i32), [f64; 2]) -> [f64; 3]) -> Vec<f64> {
    let mut q = vec![0.0; model.reference().len()];
    let body = model.body(body);
    for node in 0..body.grid().nodes() {
        for (index, vector) in body.nodal_vectors().iter().enumerate() {
            // A field is one of the middle surface: it says nothing of vectors through the thickness.
            let Some(orders) = vector.orders() else { continue };
            let first = 3 * body.vector(node, index);
            q[first..first + 3].copy_from_slice(&derivative(orders, body.grid().parameters(node)));
        }
    }
    q
}

/// The derivative of `x^i y^j` of the given orders, none higher than the first.
pub fn monomial([i, j]: [i32; 2], orders: (i32, i32), [x, y]: [f64; 2]) -> f64 {
    let part = |power: i32, order: i32, at: f64| match order {
        0 => at.powi(power),
        _ if power == 0 => 0.0,
        _ => f64::from(power) * at.powi(power - 1),
    };
    part(i, orders.0, x) * part(j, orders.1, y)
}

/// The tangent at `q` and time `t` over the free coordinates, both triangles.
pub fn tangent(system: &mut System, q: &[f64], t: f64) -> DMatrix<f64> {
    let want = Want { mass: 0.0, stiffness: 1.0, previous: None };
    system.assemble(q, t, want, &mut vec![0.0; q.len()]);
    let (pattern, values) = system.tangent();
    DMatrix::from_fn(pattern.n(), pattern.n(), |i, j| pattern.slot(i, j).map_or(0.0, |slot| values[slot]))
}

/// The derivative of `f` at 0 by central differences of fourth order: exact for polynomials of degree four.
pub fn derivative(step: f64, mut f: impl FnMut(f64) -> Vec<f64>) -> Vec<f64> {
    let parts = [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)];
    let values = parts.map(|(at, weight)| (f(at * step), weight / (12.0 * step)));
    (0..values[0].0.len()).map(|i| values.iter().map(|(value, weight)| weight * value[i]).sum()).collect()
}

/// `q + factor d`.
pub fn moved(q: &[f64], factor: f64, d: &[f64]) -> Vec<f64> {
    q.iter().zip(d).map(|(q, d)| q + factor * d).collect()
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The largest magnitude.
pub fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| if x.abs() > m || x.is_nan() { x.abs() } else { m })
}

/// The largest difference.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    largest(&moved(a, -1.0, b))
}

/// Points and weights of the Gauss rule of four points on [0, 1].
///
/// # Source
///
/// Abramowitz and Stegun (1964), table 25.4.
pub const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];
