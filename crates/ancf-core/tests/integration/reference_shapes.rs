//! Curved and non-rectangular reference shapes: no stress at rest, exact rigid motion, the right mass, shared constants.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use ancf_core::Material;
use ancf_core::assembly::System;
use ancf_core::element::Kind;
use ancf_core::mesh::{Surface, SurfacePoint};
use ancf_core::model::{Model, Plate};
use ancf_core::strain::CurvatureLaw;
use nalgebra::{Rotation3, Vector3};

#[allow(dead_code, reason = "a program of its own")]
#[path = "../../examples/memory.rs"]
mod memory;

const THICKNESS: f64 = 0.02;
const DENSITY: f64 = 7810.0;

fn system(element: Kind, surface: &Surface, divisions: [usize; 2]) -> System {
    with_law(element, surface, divisions, None)
}

fn with_law(element: Kind, surface: &Surface, divisions: [usize; 2], curvature: Option<CurvatureLaw>) -> System {
    let plate = Plate {
        material: Material::new(2.07e11, 0.3, DENSITY).unwrap(),
        thickness: THICKNESS,
        element,
        membrane: None,
        curvature,
    };
    let mut model = Model::new();
    model.add_body("shell", surface, divisions, plate).unwrap();
    System::new(Arc::new(model)).unwrap()
}

/// Shape, divisions, area and number of different elements.
fn shapes() -> [(Surface, [usize; 2], f64, usize); 4] {
    [
        (Surface::rectangle([2.0, 1.5]).unwrap(), [7, 5], 3.0, 1),
        (Surface::annulus([0.5, 2.0], TAU).unwrap(), [4, 60], 3.75 * PI, 4),
        (Surface::cylinder(2.5, [-1.0, 2.0], [-3.0, 1.0]).unwrap(), [30, 4], 30.0, 1),
        (
            Surface::sphere(1.5, [0.0, FRAC_PI_2], [-0.4, 1.0]).unwrap(),
            [20, 12],
            1.5 * 1.5 * FRAC_PI_2 * (0.4_f64.sin() + 1.0_f64.sin()),
            12,
        ),
    ]
}

#[test]
fn congruent_elements_share_their_constants() {
    for (surface, divisions, _, classes) in shapes() {
        for element in Kind::ALL {
            assert_eq!(system(element, &surface, divisions).classes(), classes, "{element:?}, {surface:?}");
        }
    }
}

/// Where elements are congruent, each takes little more than the numbers of its nodal vectors and of its class; the
/// documentation shows what this prints.
#[test]
fn memory_is_as_documented() {
    let table = memory::table().unwrap();
    let page = include_str!("../../../../docs/elements/README.md");
    assert!(page.contains(&format!("<!-- memory -->\n{table}<!-- /memory -->")), "{table}");
    let row = table.lines().find_map(|line| line.strip_prefix("| `thin36` | ")).unwrap();
    let flat: usize = row.split(" | ").next().unwrap().parse().unwrap();
    assert!((52..56).contains(&flat), "twelve vectors and a class, four bytes each: {flat}");
}

/// A saddle, by hand: x, y sheared against each other, `z = x y / 2`.
fn saddle(divisions: [usize; 2]) -> Surface {
    let domain = [[0.0, 1.0], [-1.0, 1.0]];
    let node = |i: usize, j: usize| {
        let (x, y) = (i as f64 / divisions[0] as f64, 2.0 * j as f64 / divisions[1] as f64 - 1.0);
        SurfacePoint {
            r: [x + 0.3 * y, y, 0.5 * x * y],
            r_x: [1.0, 0.0, 0.5 * y],
            r_y: [0.3, 1.0, 0.5 * x],
            r_xy: [0.0, 0.0, 0.5],
        }
    };
    let nodes = (0..=divisions[1]).flat_map(|j| (0..=divisions[0]).map(move |i| node(i, j)));
    Surface::from_nodes(domain, divisions, nodes.collect()).unwrap()
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// No force at rest, and none after a rigid motion; what is left is rounding, compared with the force of a small stretch.
#[test]
fn rigid_motions_leave_no_force() {
    let rotation = Rotation3::new(Vector3::new(0.7, -1.9, 0.4));
    let shift = Vector3::new(3.0, -1.0, 0.5);
    let shapes = shapes().map(|(surface, divisions, ..)| (surface, divisions));
    let shapes: Vec<_> = shapes.into_iter().chain([(saddle([5, 8]), [5, 8])]).collect();
    for (element, (surface, divisions)) in Kind::ALL.into_iter().flat_map(|e| shapes.iter().map(move |s| (e, s))) {
        let mut system = system(element, surface, *divisions);
        let reference = system.model().reference().to_vec();
        let mut moved = Vec::new();
        for (index, vector) in reference.chunks(3).enumerate() {
            let turned = rotation * Vector3::from_column_slice(vector);
            // The position is the first of the vectors at each node.
            let is_position = index % element.nodal_vectors().len() == 0;
            moved.extend((turned + if is_position { shift } else { Vector3::zeros() }).iter());
        }
        let stretched: Vec<f64> = reference.iter().map(|x| 1.001 * x).collect();
        let mut force = vec![0.0; reference.len()];
        let scale = system.internal_force(&stretched, &mut force).total();
        let force_scale = largest(&force);
        for state in [&reference, &moved] {
            let energy = system.internal_force(state, &mut force);
            assert!(energy.total() < 1e-20 * scale, "{element:?}, {surface:?}: {} of {scale}", energy.total());
            let left = largest(&force) / force_scale;
            assert!(left < 1e-9, "{element:?}, {surface:?}: {left:e}");
        }
    }
}

/// The error of a quantity and how often the double mesh divides it.
fn convergence(divisions: [usize; 2], error: impl Fn([usize; 2]) -> f64) -> (f64, f64) {
    let (coarse, fine) = (error(divisions), error(divisions.map(|n| 2 * n)));
    (coarse.abs(), coarse / fine)
}

/// The mass is that of the area, up to the interpolation of the shape by the elements, which is of fourth order.
#[test]
fn mass_is_density_times_thickness_times_area() {
    for (surface, divisions, area, _) in shapes() {
        for element in [Kind::Thin36, Kind::Thin48] {
            let (error, ratio) = convergence(divisions, |divisions| {
                // A uniform velocity lives in the positions alone.
                let weight = system(element, &surface, divisions).weight().to_vec();
                let mass: f64 = weight.iter().step_by(element.nodal_vectors().len()).sum();
                mass / (DENSITY * THICKNESS * area) - 1.0
            });
            assert!(error < 2e-6 && (error < 1e-14 || ratio > 15.0), "{element:?}, {surface:?}: {error}, {ratio}");
        }
    }
}

/// A sphere blown up by the factor s: `E_ab = (s^2 - 1)/2 A_ab` and, with `b_ab = s B_ab`, `J = s^2`,
/// `kappa_ab = (s^(1 - 2m) - 1) B_ab` where `B_ab = -A_ab / R`; both states of strain are the same in all directions,
/// so the energy density is `E/(1 - nu)` times `h e^2` and `h^3/12 k^2`. Second derivatives of the interpolated sphere,
/// and so its curvature, are of second order. The meshes are so fine that all of the strain counts that is not bilinear.
#[test]
fn a_growing_sphere_has_the_energy_of_its_strains() {
    const STRETCH: f64 = 1.05;
    let (surface, divisions, area, _) = shapes().into_iter().last().unwrap();
    let divisions = divisions.map(|n| 2 * n);
    let plane = 2.07e11 / (1.0 - 0.3) * area;
    let strain = 0.5 * (STRETCH * STRETCH - 1.0);
    let membrane = plane * THICKNESS * strain * strain;
    for (law, power) in [(CurvatureLaw::Paper, -3), (CurvatureLaw::Koiter, 1)] {
        let curvature = (STRETCH.powi(power) - 1.0) / 1.5;
        let bending = plane * THICKNESS.powi(3) / 12.0 * curvature * curvature;
        let energy = |divisions| {
            let mut system = with_law(Kind::Thin36, &surface, divisions, Some(law));
            let grown: Vec<f64> = system.model().reference().iter().map(|x| STRETCH * x).collect();
            system.internal_force(&grown, &mut vec![0.0; grown.len()])
        };
        let (error, ratio) = convergence(divisions, |divisions| energy(divisions).membrane / membrane - 1.0);
        assert!(error < 1e-5 && ratio > 15.0, "membrane: {error}, {ratio}");
        let (error, ratio) = convergence(divisions, |divisions| energy(divisions).bending / bending - 1.0);
        assert!(error < 2e-3 && (ratio - 4.0).abs() < 0.04, "bending, {law:?}: {error}, {ratio}");
    }
}
