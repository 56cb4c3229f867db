//! Loads: their work, and how followers change with the state.
//!
//! Reference: integrals of polynomials; the enclosed volume; the turn of an edge, both from positions.
//! Goal: the same work on any mesh, with and without supports; forces and stiffness of followers by differences.
//! Mesh: 1 x 1 to 4 x 3 elements.

use nalgebra::{DMatrix, DVector, Vector3};

use ancf_core::assembly::System;
use ancf_core::element::{Kind, Membrane, NodalVector};
use ancf_core::evaluate::{MaterialPoint, Quantity};
use ancf_core::model::{BodyId, Fix, LoadKind, Model, Plate};

use crate::common::{
    GAUSS, Random, add_constant, add_ramp, derivative, dot, field, largest, line, monomial, moved, pin, plate,
    random_state, rectangle, system, tangent,
};

const SIZE: [f64; 2] = [1.2, 0.8];

/// A soft plate, so that differences show what the loads add to the tangent.
fn soft(divisions: [usize; 2]) -> (Model, BodyId) {
    rectangle(SIZE, divisions, plate(1e-3, 0.3, 50.0, 0.02, Membrane::Full))
}

/// The work on displacements `x^i y^j` that vanish at a clamped edge.
#[test]
fn work_does_not_depend_on_the_mesh() {
    let ([a, b], g, f, per_length) = (SIZE, [0.3, -0.2, -9.81], [2.0, -1.0, 0.5], [0.1, 0.2, -0.7]);
    let point = [0.7, 0.3];
    let integral = |power: i32, side: f64| side.powi(power + 1) / f64::from(power + 1);
    for [i, j] in [[2, 0], [3, 0], [2, 1], [3, 1]] {
        for divisions in [[1, 1], [2, 1], [4, 3]] {
            for clamped in [false, true] {
                for (kind, vector, expected) in [
                    (0, g, 50.0 * 0.02 * integral(i, a) * integral(j, b)),
                    (1, f, monomial([i, j], (0, 0), point)),
                    (2, per_length, a.powi(i) * integral(j, b)),
                    (3, per_length, b.powi(j) * integral(i, a)),
                ] {
                    let (mut model, body) = soft(divisions);
                    if clamped {
                        model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
                    }
                    let load = match kind {
                        0 => LoadKind::Gravity(vector),
                        1 => LoadKind::Force { body, point, force: vector },
                        2 => line(body, "edge:x1", vector),
                        _ => line(body, "edge:y1", vector),
                    };
                    add_constant(&mut model, load);
                    let direction = [0.4, -1.1, 0.9];
                    let displacement =
                        field(&model, body, |orders, at| direction.map(|d| d * monomial([i, j], orders, at)));
                    let mut force = vec![0.0; displacement.len()];
                    let system = system(model);
                    system.external_force(system.model().reference(), 0.0, &mut force);
                    let work = dot(&force, &displacement);
                    let expected = expected * dot(&direction, &vector);
                    let name = format!("load {kind}, x^{i} y^{j}, {divisions:?}, clamped {clamped}");
                    assert!((work / expected - 1.0).abs() < 1e-13, "{name}: {work}, expected {expected}");
                }
            }
        }
    }
}

/// The position at a point of the body.
fn position(system: &System, body: BodyId, at: [f64; 2], q: &[f64]) -> Vector3<f64> {
    MaterialPoint::new(system.model(), body, at, Quantity::Position).unwrap().evaluate(q, q).into()
}

/// The volume between the plate and the origin, `1/3 integral of r . (r_x x r_y)`, with gradients from differences of
/// positions, which are cubic along x and along y in an element. Five Gauss points make the integral exact.
struct Volume {
    weights: Vec<f64>,
    /// The point and two neighbours on both sides along x and along y.
    points: Vec<[MaterialPoint; 9]>,
    step: [f64; 2],
}

impl Volume {
    fn new(system: &System, body: BodyId) -> Self {
        // Abramowitz and Stegun (1964), table 25.4.
        let (u, v, root) = (10.0_f64 / 7.0, 70.0_f64.sqrt(), 1.0 / 3.0);
        let (inner, outer) = (root * (5.0 - 2.0 * u.sqrt()).sqrt(), root * (5.0 + 2.0 * u.sqrt()).sqrt());
        let (heavy, light) = ((322.0 + 13.0 * v) / 900.0, (322.0 - 13.0 * v) / 900.0);
        let rule = [(-outer, light), (-inner, heavy), (0.0, 128.0 / 225.0), (inner, heavy), (outer, light)];
        let grid = system.model().body(body).grid();
        let [l, w] = grid.element_sides();
        let step = [0.02 * l, 0.02 * w];
        let (mut weights, mut points) = (Vec::new(), Vec::new());
        for cell in 0..grid.elements() {
            let corner = grid.parameters(grid.cell(cell)[0]);
            for (xi, wx) in rule {
                for (eta, wy) in rule {
                    let [x, y] = [corner[0] + 0.5 * (1.0 + xi) * l, corner[1] + 0.5 * (1.0 + eta) * w];
                    let shifts = [[0, 0], [1, 0], [-1, 0], [2, 0], [-2, 0], [0, 1], [0, -1], [0, 2], [0, -2]]
                        .map(|s| s.map(f64::from));
                    points.push(shifts.map(|[i, j]| {
                        MaterialPoint::new(system.model(), body, [x + i * step[0], y + j * step[1]], Quantity::Position)
                            .unwrap()
                    }));
                    weights.push(0.25 * l * w * wx * wy);
                }
            }
        }
        Self { weights, points, step }
    }

    fn evaluate(&self, q: &[f64]) -> f64 {
        let part = |points: &[MaterialPoint; 9]| {
            let r: Vec<Vector3<f64>> = points.iter().map(|p| p.evaluate(q, q).into()).collect();
            let along = |k: usize, step: f64| (8.0 * (r[k] - r[k + 1]) - (r[k + 2] - r[k + 3])) / (12.0 * step);
            r[0].dot(&along(1, self.step[0]).cross(&along(5, self.step[1]))) / 3.0
        };
        self.points.iter().zip(&self.weights).map(|(points, weight)| weight * part(points)).sum()
    }
}

/// On a plate whose edges cannot move, the force of the pressure is its derivative of the volume.
#[test]
fn pressure_does_the_work_of_the_volume() {
    let (mut model, body) = soft([2, 2]);
    for (edge, along) in
        [("x0", NodalVector::RY), ("x1", NodalVector::RY), ("y0", NodalVector::RX), ("y1", NodalVector::RX)]
    {
        let place = format!("edge:{edge}").parse().unwrap();
        pin(&mut model, body, &format!("edge:{edge}"));
        model.fix(body, place, &[Fix { vector: along, component: None }]).unwrap();
    }
    let pressure = 3.0;
    add_constant(&mut model, LoadKind::Pressure { body, pressure });
    let system = system(model);
    let q = random_state(system.model(), 0.3, &mut Random(11));
    let mut force = vec![0.0; q.len()];
    system.external_force(&q, 0.0, &mut force);
    let volume = Volume::new(&system, body);
    for &i in system.free() {
        let at = |step: f64| {
            let mut q = q.clone();
            q[i] += step;
            vec![volume.evaluate(&q)]
        };
        let expected = pressure * derivative(0.01, at)[0];
        assert!((force[i] - expected).abs() < 1e-10 * largest(&force), "coordinate {i}: {} and {expected}", force[i]);
    }
}

/// The unit outward conormal of an edge and the unit normal there.
fn edge_frame(system: &System, body: BodyId, edge: &str, at: [f64; 2], q: &[f64]) -> [Vector3<f64>; 2] {
    let axis = if edge.starts_with('x') { 1 } else { 0 };
    let step = 0.02 * system.model().body(body).grid().element_sides()[axis];
    let shifted = |k: f64| {
        let mut point = at;
        point[axis] += k * step;
        position(system, body, point, q)
    };
    let along = 8.0 * (shifted(1.0) - shifted(-1.0)) - (shifted(2.0) - shifted(-2.0));
    let normal: Vector3<f64> =
        MaterialPoint::new(system.model(), body, at, Quantity::Normal).unwrap().evaluate(q, q).into();
    // Counter-clockwise around the plate the outward direction is tangent x normal.
    let sign = if edge == "x1" || edge == "y0" { 1.0 } else { -1.0 };
    [sign * along.normalize().cross(&normal), normal]
}

/// The moment does the work of the turn of its edge: of the conormal towards the normal, where the surface is smooth.
#[test]
fn moment_does_the_work_of_the_turn() {
    let per_length = 0.8;
    for edge in ["x0", "x1", "y0", "y1"] {
        let smooth = Plate { element: Kind::Thin48, ..plate(1e-3, 0.3, 50.0, 0.02, Membrane::Full) };
        let (mut model, body) = rectangle(SIZE, [2, 2], smooth);
        let loaded = Model::edge_at(format!("edge:{edge}").parse().unwrap()).unwrap();
        add_constant(&mut model, LoadKind::Moment { body, edge: loaded, per_length });
        let system = system(model);
        let mut random = Random(12);
        let q = random_state(system.model(), 0.2, &mut random);
        let mut force = vec![0.0; q.len()];
        system.external_force(&q, 0.0, &mut force);

        let (fixed, along) = if edge.starts_with('x') { (0, 1) } else { (1, 0) };
        let side = system.model().body(body).grid().element_sides()[along];
        let mut points = Vec::new();
        for cell in 0..2 {
            for (s, weight) in GAUSS {
                let mut at = [0.0; 2];
                at[fixed] = if edge.ends_with('1') { SIZE[fixed] } else { 0.0 };
                at[along] = (f64::from(cell) + s) * side;
                points.push((at, per_length * weight * side));
            }
        }
        for _ in 0..5 {
            let direction = random.vector(q.len());
            let expected: f64 = points
                .iter()
                .map(|&(at, weight)| {
                    let normal = edge_frame(&system, body, edge, at, &q)[1];
                    let conormal = |step: f64| {
                        let moved = moved(&q, step, &direction);
                        edge_frame(&system, body, edge, at, &moved)[0].as_slice().to_vec()
                    };
                    weight * dot(normal.as_slice(), &derivative(1e-4, conormal))
                })
                .sum();
            let work = dot(&force, &direction);
            let scale = largest(&force);
            assert!((work - expected).abs() < 1e-9 * scale, "{edge}: {work}, expected {expected}");
        }
    }
}

/// Moments `M` on the edges across x and `M_y` on the others hold the cylinder `w = kappa x^2 / 2` exactly, to first
/// order: `M = D kappa`, `M_y = nu M`. In a solid fibres keep their length, which makes it plane strain.
#[test]
fn constant_moments_hold_a_cylinder() {
    let (young, poisson, thickness, kappa) = (1e3, 0.3, 0.02_f64, 1e-3);
    for element in Kind::ALL {
        let variant = Plate { element, membrane: None, ..plate(young, poisson, 50.0, thickness, Membrane::Full) };
        let (mut model, body) = rectangle(SIZE, [3, 2], variant);
        let ratio = if element.is_solid() { poisson / (1.0 - poisson) } else { poisson };
        let shear = 0.5 * young / (1.0 + poisson);
        // lambda + 2 mu with the lambda that belongs to the ratio of stresses across and along, lambda / (lambda + 2 mu).
        let moment = kappa * thickness.powi(3) / 12.0 * 2.0 * shear / (1.0 - ratio);
        for (edge, per_length) in [("x0", moment), ("x1", moment), ("y0", ratio * moment), ("y1", ratio * moment)] {
            let edge = Model::edge_at(format!("edge:{edge}").parse().unwrap()).unwrap();
            add_ramp(&mut model, LoadKind::Moment { body, edge, per_length });
        }
        let mut bend = field(&model, body, |orders, at| [0.0, 0.0, 0.5 * kappa * monomial([2, 0], orders, at)]);
        if element.is_solid() {
            let plate = model.body(body);
            for node in 0..plate.grid().nodes() {
                bend[3 * plate.vector(node, 3)] = -kappa * plate.grid().parameters(node)[0];
            }
        }
        let mut system = system(model);
        let rest = system.model().reference().to_vec();
        let stiffness = tangent(&mut system, &rest, 0.0);
        let mut force = vec![0.0; rest.len()];
        system.external_force(&rest, 1.0, &mut force);
        let ordered = |x: &[f64]| DVector::from_iterator(x.len(), system.free().iter().map(|&i| x[i]));
        let (bend, force) = (ordered(&bend), ordered(&force));
        // Relative to the forces of the elements, which cancel inside.
        let scale = (stiffness.abs() * bend.abs()).amax();
        let error = (stiffness * bend - &force).amax() / scale;
        assert!(error < 1e-14 && force.amax() > 1e-7 * scale, "{element:?}: {error:e}");
    }
}

/// Derivatives of the loads with respect to the free coordinates.
fn load_stiffness(system: &System, q: &[f64], t: f64) -> DMatrix<f64> {
    let free = system.free();
    let columns = free.iter().map(|&j| {
        let force = |step: f64| {
            let (mut at, mut force) = (q.to_vec(), vec![0.0; q.len()]);
            at[j] += step;
            system.external_force(&at, t, &mut force);
            free.iter().map(|&i| force[i]).collect()
        };
        DVector::from_vec(derivative(1e-3, force))
    });
    DMatrix::from_columns(&columns.collect::<Vec<_>>())
}

/// What a follower adds to the tangent is the symmetric part of its derivative.
#[test]
fn followers_add_the_symmetric_part_of_their_derivative() {
    type Make = fn(BodyId, &str) -> LoadKind;
    let pressure: Make = |body, _| LoadKind::Pressure { body, pressure: 3.0 };
    let moment: Make = |body, edge| {
        let edge = Model::edge_at(edge.parse().unwrap()).unwrap();
        LoadKind::Moment { body, edge, per_length: 0.8 }
    };
    let cases = [(pressure, ""), (moment, "edge:x0"), (moment, "edge:x1"), (moment, "edge:y0"), (moment, "edge:y1")];
    for (element, (make, edge)) in Kind::ALL.into_iter().flat_map(|element| cases.map(|case| (element, case))) {
        let variant = Plate { element, membrane: None, ..plate(1e-3, 0.3, 50.0, 0.02, Membrane::Full) };
        let (mut model, body) = rectangle(SIZE, [2, 1], variant);
        add_ramp(&mut model, make(body, edge));
        let mut system = system(model);
        let q = random_state(system.model(), 0.2, &mut Random(13));
        // A negative load factor, to see that it is used.
        let t = -0.5;
        let added = tangent(&mut system, &q, t) - tangent(&mut system, &q, 0.0);
        let derivatives = load_stiffness(&system, &q, t);
        let expected = -0.5 * (&derivatives + derivatives.transpose());
        let error = (&added - &expected).amax() / expected.amax();
        assert!(error < 1e-8, "{element:?}, {edge}: {error:e}");
    }
}

/// Solutions are those of the whole tangent: the skew part of the derivative of followers is in them.
#[test]
fn solutions_are_those_of_the_whole_tangent() {
    for element in Kind::ALL {
        for edge in [None, Some("edge:x1"), Some("edge:y0"), Some("edge:y1")] {
            let variant = Plate { element, membrane: None, ..plate(1e3, 0.3, 50.0, 0.1, Membrane::Full) };
            let (mut model, body) = rectangle(SIZE, [2, 1], variant);
            model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
            let load = match edge {
                None => LoadKind::Pressure { body, pressure: 0.1 },
                Some(edge) => {
                    let edge = Model::edge_at(edge.parse().unwrap()).unwrap();
                    LoadKind::Moment { body, edge, per_length: 0.003 }
                }
            };
            add_ramp(&mut model, load);
            let mut system = system(model);
            let q = random_state(system.model(), 1e-2, &mut Random(13));
            let derivatives = load_stiffness(&system, &q, 1.0);
            let skew = -0.5 * (&derivatives - derivatives.transpose());
            let whole = tangent(&mut system, &q, 1.0) + &skew;
            system.factorize().unwrap();
            let right = Random(14).vector(q.len());
            let mut solution = vec![0.0; right.len()];
            system.solve(&right, &mut solution);
            let free = |x: &[f64]| DVector::from_iterator(system.free().len(), system.free().iter().map(|&i| x[i]));
            let (right, solution) = (free(&right), free(&solution));
            let missing = (&whole * &solution - &right).amax() / right.amax();
            let part = (&skew * &solution).amax() / right.amax();
            // GMRES stops at 1e-8 of the solution, which a stiff membrane multiplies.
            assert!(part > 1e-3 && missing < 1e-3 * part, "{element:?}, {edge:?}: {missing:e} of {part:e}");
        }
    }
}

/// Under a pressure the symmetric half of the tangent of a plate with free edges has negative pivots where the whole tangent
/// still has a positive determinant: the plate is stable there, and is told to be.
#[test]
fn stability_is_that_of_the_whole_tangent() {
    let (mut model, body) = soft([2, 2]);
    model.clamp(body, "edge:x0".parse().unwrap()).unwrap();
    add_ramp(&mut model, LoadKind::Pressure { body, pressure: 1e-6 });
    let mut system = system(model);
    let (mut held, mut left) = (0, 0);
    for seed in 0..20 {
        let q = random_state(system.model(), 1e-4, &mut Random(seed));
        for t in [0.03, 0.1, 0.3, 1.0, 3.0] {
            let symmetric = tangent(&mut system, &q, t);
            let inertia = system.factorize().unwrap();
            let derivatives = load_stiffness(&system, &q, t);
            let whole = symmetric - 0.5 * (&derivatives - derivatives.transpose());
            let count = system.instabilities(inertia);
            let negative = whole.complex_eigenvalues().iter().filter(|value| value.re < 0.0).count();
            // Each zero of the determinant changes both by one.
            let same = count % 2 == negative % 2 && (count == 0) == (negative == 0);
            assert!(same, "{seed}, {t}: {count} of {} pivots, {negative} eigenvalues", inertia.negative);
            held += usize::from(inertia.negative > 0 && count == 0);
            left += usize::from(count > 0);
        }
    }
    assert!(held > 5 && left > 5, "{held}, {left}");
}
