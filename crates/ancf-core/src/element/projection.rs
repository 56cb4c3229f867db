//! The cure of membrane locking: generalised strains in place of the samples.
//!
//! Membrane strains of a bent element contain polynomials that its nodal coordinates cannot keep at zero. Their L2
//! projection, component by component, on spaces that the element can control removes the locking.

use crate::quadrature::Rule;

/// One generalised strain: the coefficient of a basis function that is orthonormal in the quadrature.
#[derive(Clone, Debug)]
pub(crate) struct Mode {
    /// The strain component it belongs to.
    pub component: usize,
    /// Sample point and value of the basis function there, where it is not zero.
    pub basis: Vec<(usize, f64)>,
}

/// Generalised strains `e_k = sum_g w_g phi_k(g) eps(g)`; the projected strain is `sum_k phi_k e_k`.
#[derive(Clone, Debug)]
pub(crate) struct Projection {
    pub modes: Vec<Mode>,
    /// For each sample point, the modes that see it and the value of their basis function there.
    pub at_point: Vec<Vec<(usize, f64)>>,
}

impl Projection {
    /// The membrane projection on 4 x 4 Gauss points: `E_xx` on `P1(x) P3(y)`, `E_yy` on `P3(x) P1(y)`, `E_xy` on
    /// `P1 P1`, in an element with the given parameter area. 20 modes for 48 samples.
    ///
    /// The basis of the cubics is the one of the Gauss points themselves, so that most modes see four samples only.
    pub fn membrane(area: f64) -> Self {
        let points = Rule::Gauss(4).points();
        // Legendre polynomials of degree 0 and 1, and the point functions, orthonormal on the unit interval.
        let linear = |degree: usize, i: usize| match degree {
            0 => 1.0,
            _ => 3.0_f64.sqrt() * (2.0 * points[i].0 - 1.0),
        };
        let at_point = |j: usize, i: usize| if i == j { 1.0 / points[j].1.sqrt() } else { 0.0 };
        let mode = |component: usize, along_x: &dyn Fn(usize) -> f64, along_y: &dyn Fn(usize) -> f64| {
            let scale = 1.0 / area.sqrt();
            let values = (0..16).map(|g| (g, scale * along_x(g % 4) * along_y(g / 4)));
            Mode { component, basis: values.filter(|(_, value)| *value != 0.0).collect() }
        };
        let mut modes = Vec::new();
        for degree in 0..2 {
            for j in 0..4 {
                modes.push(mode(0, &|i| linear(degree, i), &|i| at_point(j, i)));
                modes.push(mode(1, &|i| at_point(j, i), &|i| linear(degree, i)));
            }
            for other in 0..2 {
                modes.push(mode(2, &|i| linear(degree, i), &|i| linear(other, i)));
            }
        }
        let mut at_point = vec![Vec::new(); 16];
        for (k, mode) in modes.iter().enumerate() {
            for &(g, phi) in &mode.basis {
                at_point[g].push((k, phi));
            }
        }
        Self { modes, at_point }
    }
}
