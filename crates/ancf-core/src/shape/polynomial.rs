//! Polynomials in two variables: shape functions are written as their formulas and differentiated exactly.

use std::array;
use std::ops::{Add, Mul, Neg, Sub};

/// Number of powers kept per variable: enough for a product of two cubics in one variable.
const POWERS: usize = 8;

/// A polynomial `sum c_ij xi^i eta^j`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial {
    coefficients: [[f64; POWERS]; POWERS],
}

impl Polynomial {
    /// The constant `value`.
    pub fn constant(value: f64) -> Self {
        let mut coefficients = [[0.0; POWERS]; POWERS];
        coefficients[0][0] = value;
        Self { coefficients }
    }

    /// The first variable.
    pub fn xi() -> Self {
        let mut coefficients = [[0.0; POWERS]; POWERS];
        coefficients[1][0] = 1.0;
        Self { coefficients }
    }

    /// The second variable.
    pub fn eta() -> Self {
        let mut coefficients = [[0.0; POWERS]; POWERS];
        coefficients[0][1] = 1.0;
        Self { coefficients }
    }

    /// The derivative taken `in_xi` times in the first and `in_eta` times in the second variable, at a point.
    pub fn derivative(&self, in_xi: usize, in_eta: usize, xi: f64, eta: f64) -> f64 {
        // Horner's scheme in both variables.
        (in_xi..POWERS).rev().fold(0.0, |sum, i| {
            let row = (in_eta..POWERS)
                .rev()
                .fold(0.0, |row, j| row * eta + falling_factorial(j, in_eta) * self.coefficients[i][j]);
            sum * xi + falling_factorial(i, in_xi) * row
        })
    }

    /// The value at a point.
    pub fn value(&self, xi: f64, eta: f64) -> f64 {
        self.derivative(0, 0, xi, eta)
    }
}

/// `n (n - 1) ... (n - k + 1)`, the factor that `k` derivatives put before `x^(n - k)`.
fn falling_factorial(n: usize, k: usize) -> f64 {
    (0..k).map(|i| (n - i) as f64).product()
}

impl Add for Polynomial {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let coefficients = array::from_fn(|i| array::from_fn(|j| self.coefficients[i][j] + other.coefficients[i][j]));
        Self { coefficients }
    }
}

impl Neg for Polynomial {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Sub for Polynomial {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Add<f64> for Polynomial {
    type Output = Self;
    fn add(self, other: f64) -> Self {
        self + Self::constant(other)
    }
}

impl Sub<f64> for Polynomial {
    type Output = Self;
    fn sub(self, other: f64) -> Self {
        self + -other
    }
}

impl Mul<f64> for Polynomial {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        let coefficients = self.coefficients.map(|row| row.map(|c| c * factor));
        Self { coefficients }
    }
}

impl Mul<Polynomial> for f64 {
    type Output = Polynomial;
    fn mul(self, polynomial: Polynomial) -> Polynomial {
        polynomial * self
    }
}

impl Mul for Polynomial {
    type Output = Self;
    /// # Panics
    ///
    /// If a power exceeds what is kept: no shape function here reaches it.
    fn mul(self, other: Self) -> Self {
        let mut coefficients = [[0.0; POWERS]; POWERS];
        for (i, row) in self.coefficients.iter().enumerate() {
            for (j, &c) in row.iter().enumerate().filter(|(_, c)| **c != 0.0) {
                for (k, other_row) in other.coefficients.iter().enumerate() {
                    for (l, &d) in other_row.iter().enumerate().filter(|(_, d)| **d != 0.0) {
                        coefficients[i + k][j + l] += c * d;
                    }
                }
            }
        }
        Self { coefficients }
    }
}
