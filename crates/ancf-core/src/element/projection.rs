//! The cure of membrane locking: generalised strains in place of the samples.
//!
//! Membrane strains of a bent element contain polynomials that its nodal coordinates cannot keep at zero. Their L2
//! projection, component by component, on spaces that the element can control removes the locking.

use nalgebra::DMatrix;

use crate::quadrature::{Rule, legendre};

use super::tables::Samples;

/// Number of sample points.
pub(crate) const POINTS: usize = 16;

/// Number of generalised strains.
pub(crate) const MODES: usize = 22;

/// One generalised strain: the coefficient of a basis function that is orthonormal in the quadrature.
#[derive(Clone, Debug)]
pub(crate) struct Mode {
    /// The strain component it belongs to.
    pub component: usize,
    /// Sample point and value of the basis function there times the quadrature weight, where it is not zero.
    pub basis: Vec<(usize, f64)>,
}

/// The part of one vector in the derivative of a generalised strain: gradient vectors, numbered `2 g` for `r_x` and
/// `2 g + 1` for `r_y` at point g, with their factors.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub mode: usize,
    pub gradients: Vec<(usize, f64)>,
}

/// Generalised strains `e_k = sum_g w_g phi_k(g) eps(g)`; the projected strain is `sum_k phi_k e_k`.
///
/// They are quadratic in the vectors `q_a`: `de_k = sum_a row_k,a . dq_a`. Their second derivatives are those of the samples,
/// so their stress enters the geometric stiffness at the points.
#[derive(Clone, Debug)]
pub(crate) struct Projection<const N: usize> {
    /// Those of `E_xx` and `E_yy`, then the bilinear ones of `E_xy`, then its quadratic ones.
    pub modes: Vec<Mode>,
    /// For each vector the rows of the modes that depend on it.
    pub rows: [Vec<Row>; N],
    /// The wave number times the side up to which the element follows a doubly curved surface that bends without
    /// stretching.
    pub followed: f64,
}

/// Degrees in x and in y of the modes of `E_xy`.
///
/// Without the last two the lines across a strip of one element may bend to cubics for nothing, and with them a strip is
/// three times too soft in its plane.
const SHEAR: [[usize; 2]; 6] = [[0, 0], [0, 1], [1, 0], [1, 1], [2, 0], [0, 2]];

/// Number of modes of `E_xx` and `E_yy`.
const NORMAL: usize = 16;

/// Number of modes but for the quadratic ones of `E_xy`.
const BILINEAR: usize = 20;

impl<const N: usize> Projection<N> {
    /// The membrane projection on 4 x 4 Gauss points: `E_xx` on `P1(x) P3(y)`, `E_yy` on `P3(x) P1(y)`, `E_xy` on
    /// `P1 P1` and the squares of x and of y. 22 modes for 48 samples.
    ///
    /// The basis of the cubics is the one of the Gauss points themselves, so that most modes see four samples only.
    pub fn membrane(samples: &Samples<N, 2>, followed: f64) -> Self {
        let points = Rule::Gauss(4).points();
        let scale = 1.0 / samples.weights.iter().sum::<f64>().sqrt();
        // Orthonormal as the Legendre polynomials are.
        let polynomial = |degree: usize, i: usize| legendre(degree, points[i].0);
        let at_point = |j: usize, i: usize| if i == j { 1.0 / points[j].1.sqrt() } else { 0.0 };
        let mode = |component: usize, along_x: &dyn Fn(usize) -> f64, along_y: &dyn Fn(usize) -> f64| {
            let values = (0..POINTS).map(|g| (g, samples.weights[g] * scale * along_x(g % 4) * along_y(g / 4)));
            Mode { component, basis: values.filter(|(_, value)| *value != 0.0).collect() }
        };
        let mut modes = Vec::with_capacity(MODES);
        for component in 0..2 {
            for degree in 0..2 {
                for j in 0..4 {
                    modes.push(match component {
                        0 => mode(0, &|i| polynomial(degree, i), &|i| at_point(j, i)),
                        _ => mode(1, &|i| at_point(j, i), &|i| polynomial(degree, i)),
                    });
                }
            }
        }
        modes.extend(SHEAR.map(|[in_x, in_y]| mode(2, &|i| polynomial(in_x, i), &|i| polynomial(in_y, i))));

        // d E_xx = t_x r_x . dq, d E_yy = t_y r_y . dq, d 2 E_xy = (t_y r_x + t_x r_y) . dq
        let rows = std::array::from_fn(|a| {
            let row = |(k, mode): (usize, &Mode)| {
                let gradients = mode.basis.iter().flat_map(|&(g, weight)| {
                    let [tx, ty] = samples.tables[g].map(|row| weight * row[a]);
                    match mode.component {
                        0 => [(2 * g, tx), (2 * g + 1, 0.0)],
                        1 => [(2 * g, 0.0), (2 * g + 1, ty)],
                        _ => [(2 * g, ty), (2 * g + 1, tx)],
                    }
                });
                Row { mode: k, gradients: gradients.filter(|(_, factor)| *factor != 0.0).collect() }
            };
            modes.iter().enumerate().map(row).filter(|row| !row.gradients.is_empty()).collect()
        });
        Self { modes, rows, followed }
    }

    /// The matrix on generalised strains that multiplies the parts that are not bilinear by factors: `normal` those of
    /// `E_xx` that are not linear in y, and those of `E_yy` that are not linear in x, `shear` the squares of x and of y in
    /// `E_xy`.
    pub fn reduction(normal: f64, shear: [f64; 2]) -> DMatrix<f64> {
        let points = Rule::Gauss(4).points();
        // A strain that is linear along the four point functions, in their coefficients.
        let linear = |i: usize, j: usize| {
            let [(x, p), (y, q)] = [points[i], points[j]];
            (p * q).sqrt() * (1.0 + 3.0 * (2.0 * x - 1.0) * (2.0 * y - 1.0))
        };
        DMatrix::from_fn(MODES, MODES, |k, l| {
            let same = if k == l { 1.0 } else { 0.0 };
            if k.max(l) >= BILINEAR {
                shear[k.max(l) - BILINEAR] * same
            } else if k.max(l) >= NORMAL || k / 4 != l / 4 {
                same
            } else {
                normal * same + (1.0 - normal) * linear(k % 4, l % 4)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reduction_keeps_what_is_bilinear() {
        let points = Rule::Gauss(4).points();
        let coefficients = |f: fn(f64) -> f64| {
            nalgebra::DVector::from_fn(MODES, |k, _| {
                let (x, weight) = points[k % 4];
                if k < NORMAL { weight.sqrt() * f(x) } else { f64::from(k as u32) }
            })
        };
        let reduction = Projection::<12>::reduction(0.3, [0.2, 0.1]);
        let mut linear = coefficients(|x| 2.0 - 5.0 * x);
        linear.rows_mut(BILINEAR, MODES - BILINEAR).fill(0.0);
        assert!((&reduction * &linear - &linear).amax() < 1e-13);
        // A Legendre polynomial, with nothing linear in it.
        let mut rough = coefficients(|x| 6.0 * x * x - 6.0 * x + 1.0);
        rough.rows_mut(NORMAL, MODES - NORMAL).fill(0.0);
        assert!((&reduction * &rough - 0.3 * &rough).amax() < 1e-13);
        for (square, share) in [(BILINEAR, 0.2), (BILINEAR + 1, 0.1)] {
            assert_eq!(reduction[(square, square)], share);
        }
    }
}
