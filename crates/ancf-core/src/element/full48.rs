//! The fully parametrised elements: a middle surface and a vector through the thickness at each node, the
//! Green-Lagrange strain of a solid.

use std::array;

use crate::quadrature::Rule;
use crate::shape::{Polynomial, acm, bilinear, hermite};

use super::corners::functions;
use super::tables::{Derivatives, Group, Samples, Tables, derivative};

/// `S_A`: the incomplete quartic of `thin36` for the middle surface.
///
/// # Source
///
/// Mikkola and Shabana (2003); Dufva and Shabana (2005), section 2.
pub(crate) fn full48a(sides: [f64; 2], thickness: f64) -> Tables<16> {
    tables(quartic_middle(sides), sides, thickness)
}

/// `S_B`: products of cubic Hermite functions without those of the twist for the middle surface.
///
/// # Source
///
/// Mikkola and Shabana (2003), as Dufva and Shabana (2005) describe it.
pub(crate) fn full48b(sides: [f64; 2], thickness: f64) -> Tables<16> {
    tables(hermite_middle(sides), sides, thickness)
}

/// The shape functions of `full48a` on the middle surface: zero for `r_z`.
pub(crate) fn quartic_middle(sides: [f64; 2]) -> [Polynomial; 16] {
    let functions = acm(sides);
    array::from_fn(|a| if a % 4 == 3 { Polynomial::constant(0.0) } else { functions[a / 4 * 3 + a % 4] })
}

/// The shape functions of `full48b` on the middle surface: zero for `r_z`.
pub(crate) fn hermite_middle(sides: [f64; 2]) -> [Polynomial; 16] {
    let functions = hermite(sides);
    array::from_fn(|a| if a % 4 == 3 { Polynomial::constant(0.0) } else { functions[a] })
}

/// The shape functions of the vector through the thickness: bilinear for `r_z`, zero for the others.
pub(crate) fn director() -> [Polynomial; 16] {
    let corners = bilinear();
    array::from_fn(|a| if a % 4 == 3 { corners[a / 4] } else { Polynomial::constant(0.0) })
}

/// The tables for a middle surface: `r = r_middle + z r_z`, `r_z` bilinear between the nodes.
///
/// Strains are sampled at 4 x 4 x 2 Gauss points, the mass at 5 x 5 x 3.
fn tables(middle: [Polynomial; 16], sides: [f64; 2], thickness: f64) -> Tables<16> {
    let director = director();
    let at = |orders: [usize; 2], point: [f64; 2], z: f64| {
        let along = derivative(&director, sides, orders, point);
        let mut row = derivative(&middle, sides, orders, point);
        row.iter_mut().zip(along).for_each(|(n, d)| *n += z * d);
        row
    };
    let through = |point: [f64; 2]| derivative(&director, sides, [0, 0], point);
    let points = |in_plane: usize, across: usize| {
        Rule::Gauss(across).points().into_iter().flat_map(move |(zeta, share)| {
            let z = thickness * (zeta - 0.5);
            let weight = move |w: f64| w * share * sides[0] * sides[1];
            Rule::Gauss(in_plane).square().into_iter().map(move |(point, w)| (point, z, weight(w)))
        })
    };
    let strain = points(4, 2).map(|(p, z, weight)| ([at([1, 0], p, z), at([0, 1], p, z), through(p)], weight));
    let units = [1.0, sides[0], sides[1], thickness];
    let (rows, weights) = strain.map(|(rows, weight)| (rows.map(|row| functions(&row, &units)), weight)).unzip();
    let mass = points(5, 3).map(|(p, z, weight)| {
        let shape =
            Derivatives { value: at([0, 0], p, z), x: at([1, 0], p, z), y: at([0, 1], p, z), z: Some(through(p)) };
        (shape, weight)
    });
    let mass = mass.collect();
    Tables { sides, functions: middle, groups: vec![Group::Solid(Samples::new(Rule::Gauss(4), rows, weights))], mass }
}
