//! The global force and tangent are the sums of those of the elements.
//!
//! Reference: the element forces and tangents summed into dense arrays, one element after the other.
//! Goal: agreement to rounding, with everything that decides about places: many parts, bodies whose nodes have three and
//! four vectors, fixed coordinates, a load that follows.
//! Mesh: 12 x 10 `thin36` and 5 x 4 `thin48`, 173 nodes: several parts.

use ancf_core::assembly::System;
use ancf_core::element::{At, Kind, Membrane, NodalVector, Want, tangent_place, tangent_size};
use ancf_core::mesh::{Place, Surface};
use ancf_core::model::{Fix, LoadKind, Plate};
use nalgebra::DMatrix;

use crate::common::{Random, add_constant, pin, plate, random_state, rectangle, system};

const WANT: Want<'_> = Want { mass: 40.0, stiffness: 0.7, previous: None };

#[test]
fn global_forces_and_tangents_are_sums_over_elements() {
    let thin36 = plate(1e5, 0.3, 7810.0, 0.01, Membrane::Projected);
    let (mut model, first) = rectangle([0.6, 0.5], [12, 10], thin36);
    let thin48 = Plate { element: Kind::Thin48, membrane: Some(Membrane::Full), ..thin36 };
    let second = model.add_body("other", &Surface::rectangle([0.3, 0.2]).unwrap(), [5, 4], thin48).unwrap();
    model.clamp(first, "edge:x0".parse().unwrap()).unwrap();
    pin(&mut model, second, "corner:x0y0");
    let fix = Fix { vector: NodalVector::RX, component: Some(1) };
    model.fix(first, Place::Point([0.3, 0.25]), &[fix]).unwrap();
    let q = random_state(&model, 0.05, &mut Random(3));

    let n = q.len();
    let (mut force, mut tangent) = (vec![0.0; n], DMatrix::zeros(n, n));
    for body in model.bodies() {
        let elements = body.elements(model.reference());
        let vectors = elements.vectors_per_element();
        let size = tangent_size(vectors);
        for element in 0..elements.elements() {
            let own: Vec<usize> = elements.vectors(element).iter().map(|v| *v as usize).collect();
            elements.evaluate(&[element as u32], At::rest(&q), Some(WANT), &mut |portion| {
                assert_eq!((portion.elements, portion.tangent.len()), ([element as u32].as_slice(), size));
                for row in 0..3 * vectors {
                    let [a, i] = [row / 3, row % 3];
                    force[3 * own[a] + i] += portion.force[row];
                    for column in 0..=row {
                        let [b, j] = [column / 3, column % 3];
                        let entry = portion.tangent[tangent_place(vectors, [a, i], [b, j])];
                        tangent[(3 * own[a] + i, 3 * own[b] + j)] += entry;
                        if row != column {
                            tangent[(3 * own[b] + j, 3 * own[a] + i)] += entry;
                        }
                    }
                }
            });
        }
    }

    let compare = |system: &mut System, less: &DMatrix<f64>| {
        let mut sums = vec![0.0; n];
        system.assemble(&q, 0.0, WANT, &mut sums);
        let largest = force.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        let error = sums.iter().zip(&force).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(error < 1e-13 * largest, "force: {error:e} of {largest:e}");
        let (pattern, values) = system.tangent();
        let free = system.free();
        assert_eq!(pattern.n(), free.len());
        let mut rest = tangent.select_rows(free).select_columns(free) - less;
        let largest = rest.amax();
        for column in 0..pattern.n() {
            for (&row, value) in pattern.rows(column).iter().zip(&values[pattern.col_ptr()[column]..]) {
                rest[(row, column)] -= value;
                if row != column {
                    rest[(column, row)] -= value;
                }
            }
        }
        let error = rest.amax();
        assert!(error < 1e-13 * largest, "tangent: {error:e} of {largest:e}");
    };
    let mut alone = system(model.clone());
    let free = alone.free().len();
    compare(&mut alone, &DMatrix::zeros(free, free));

    // A pressure on the second body: the symmetric half of the differences of its force.
    add_constant(&mut model, LoadKind::Pressure { body: second, pressure: 300.0 });
    let mut loaded = system(model);
    let mut stiffness = DMatrix::zeros(n, n);
    for j in 0..n {
        // The force is quadratic in the coordinates, so differences over any length are exact.
        let ends = [1.0, -1.0].map(|step| {
            let mut q = q.clone();
            q[j] += step;
            let mut force = vec![0.0; n];
            loaded.external_force(&q, 0.0, &mut force);
            force
        });
        stiffness.column_mut(j).iter_mut().enumerate().for_each(|(i, s)| *s = 0.5 * (ends[0][i] - ends[1][i]));
    }
    let symmetric = (&stiffness + stiffness.transpose()) * (0.5 * WANT.stiffness);
    let symmetric = symmetric.select_rows(loaded.free()).select_columns(loaded.free());
    assert!(symmetric.amax() > 1e-3);
    compare(&mut loaded, &symmetric);
}
