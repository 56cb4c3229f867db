//! Quadrature on the unit interval and its products on the unit square.

/// Points and weights of a rule on `[0, 1]`.
#[derive(Clone, Copy, Debug)]
pub enum Rule {
    /// Gauss-Legendre with 2 to 5 points, exact for polynomials of degree `2 n - 1`.
    Gauss(usize),
    /// Gauss-Lobatto with 3 points (Simpson), both ends included, exact to degree 3.
    Lobatto3,
}

impl Rule {
    /// The points and weights on `[0, 1]`, from left to right.
    ///
    /// # Panics
    ///
    /// If a Gauss rule with other than 2 to 5 points is asked for.
    pub fn points(self) -> Vec<(f64, f64)> {
        let standard: Vec<(f64, f64)> = match self {
            Self::Lobatto3 => vec![(-1.0, 1.0 / 3.0), (0.0, 4.0 / 3.0), (1.0, 1.0 / 3.0)],
            Self::Gauss(2) => mirrored(&[(1.0_f64 / 3.0).sqrt()], &[1.0], None),
            Self::Gauss(3) => mirrored(&[0.6_f64.sqrt()], &[5.0 / 9.0], Some(8.0 / 9.0)),
            Self::Gauss(4) => {
                let (inner, outer) = (3.0 / 7.0 - 2.0 / 7.0 * 1.2_f64.sqrt(), 3.0 / 7.0 + 2.0 / 7.0 * 1.2_f64.sqrt());
                let root = 30.0_f64.sqrt();
                mirrored(&[outer.sqrt(), inner.sqrt()], &[(18.0 - root) / 36.0, (18.0 + root) / 36.0], None)
            }
            Self::Gauss(5) => {
                let root = (10.0_f64 / 7.0).sqrt();
                let weight = 13.0 * 70.0_f64.sqrt();
                mirrored(
                    &[(5.0 + 2.0 * root).sqrt() / 3.0, (5.0 - 2.0 * root).sqrt() / 3.0],
                    &[(322.0 - weight) / 900.0, (322.0 + weight) / 900.0],
                    Some(128.0 / 225.0),
                )
            }
            Self::Gauss(n) => panic!("no Gauss rule with {n} points"),
        };
        standard.into_iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect()
    }

    /// The tensor product on the unit square, first variable fastest: `([xi, eta], weight)`.
    pub fn square(self) -> Vec<([f64; 2], f64)> {
        let points = self.points();
        points.iter().flat_map(|&(eta, v)| points.iter().map(move |&(xi, u)| ([xi, eta], u * v))).collect()
    }
}

/// A symmetric rule on `[-1, 1]` from its positive points, outermost first, and the weight of the midpoint if it has one.
fn mirrored(points: &[f64], weights: &[f64], middle: Option<f64>) -> Vec<(f64, f64)> {
    let positive = || points.iter().copied().zip(weights.iter().copied());
    let mut rule: Vec<_> = positive().map(|(x, w)| (-x, w)).collect();
    rule.extend(middle.map(|w| (0.0, w)));
    rule.extend(positive().rev());
    rule
}

/// The Legendre polynomials of degree 0 to 2, orthonormal on `[0, 1]`.
///
/// # Panics
///
/// If a higher degree is asked for.
pub fn legendre(degree: usize, at: f64) -> f64 {
    let t = 2.0 * at - 1.0;
    match degree {
        0 => 1.0,
        1 => 3.0_f64.sqrt() * t,
        2 => 5.0_f64.sqrt() * (1.5 * t * t - 0.5),
        _ => panic!("no Legendre polynomial of degree {degree}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every rule integrates the monomials up to its degree exactly, and not the next even one.
    #[test]
    fn degrees_of_exactness() {
        for (rule, degree) in
            [(Rule::Gauss(2), 3), (Rule::Gauss(3), 5), (Rule::Gauss(4), 7), (Rule::Gauss(5), 9), (Rule::Lobatto3, 3)]
        {
            let error = |power: i32| {
                let sum: f64 = rule.points().iter().map(|(x, w)| w * x.powi(power)).sum();
                (sum - 1.0 / f64::from(power + 1)).abs()
            };
            for power in 0..=degree {
                assert!(error(power) < 1e-15, "{rule:?}, power {power}: {}", error(power));
            }
            assert!(error(degree + 1) > 1e-7, "{rule:?}");
        }
    }
}
