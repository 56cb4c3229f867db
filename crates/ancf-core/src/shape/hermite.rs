//! Tensor products of cubic Hermite functions: for `r`, `r_x`, `r_y`, `r_xy` at four nodes, C1 between equal rectangles.

use std::array;

use super::Polynomial;

/// The 16 functions of an element with sides `l` and `w`, in `xi = x / l`, `eta = y / w`.
///
/// The order is that of the nodal vectors: `r`, `r_x`, `r_y`, `r_xy` at the nodes A(0,0), B(1,0), C(1,1), D(0,1).
///
/// # Source
///
/// Dmitrochenko and Pogorelov (2003); Bogner, Fox and Schmit (1965).
pub fn hermite([l, w]: [f64; 2]) -> [Polynomial; 16] {
    let (x, y) = (cubic(Polynomial::xi(), l), cubic(Polynomial::eta(), w));
    array::from_fn(|a| {
        let [end_x, end_y] = [[0, 0], [1, 0], [1, 1], [0, 1]][a / 4];
        let [in_x, in_y] = [[0, 0], [1, 0], [0, 1], [1, 1]][a % 4];
        x[end_x][in_x] * y[end_y][in_y]
    })
}

/// Cubic Hermite functions of `t` on an interval of the given length: at its ends, for value and derivative.
fn cubic(t: Polynomial, length: f64) -> [[Polynomial; 2]; 2] {
    let (square, cube) = (t * t, t * t * t);
    let rise = 3.0 * square - 2.0 * cube;
    [[-rise + 1.0, length * (t - 2.0 * square + cube)], [rise, length * (cube - square)]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each function is one at its own nodal coordinate and zero at the others.
    #[test]
    fn nodal_coordinates_are_interpolated() {
        let (l, w) = (0.7, 1.9);
        let functions = hermite([l, w]);
        for (node, (xi, eta)) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].into_iter().enumerate() {
            for (vector, (dx, dy)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
                for (a, function) in functions.iter().enumerate() {
                    let value = function.derivative(dx, dy, xi, eta) / l.powi(dx as i32) / w.powi(dy as i32);
                    let expected = f64::from(a == 4 * node + vector);
                    assert!((value - expected).abs() < 1e-14, "function {a}, node {node}, vector {vector}: {value}");
                }
            }
        }
    }

    /// Products of two cubics are in the span of the functions, so they are interpolated exactly.
    #[test]
    fn bicubics_are_complete() {
        let (l, w) = (1.3, 0.6);
        let functions = hermite([l, w]);
        let f = |x: f64| [2.0 - x + 3.0 * x * x * x, -1.0 + 9.0 * x * x];
        let g = |y: f64| [1.0 + y * y - 0.5 * y * y * y, 2.0 * y - 1.5 * y * y];
        let (xi, eta) = (0.37, 0.81);
        let mut sum = 0.0;
        for (node, (x, y)) in [(0.0, 0.0), (l, 0.0), (l, w), (0.0, w)].into_iter().enumerate() {
            for (vector, (dx, dy)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
                sum += f(x)[dx] * g(y)[dy] * functions[4 * node + vector].value(xi, eta);
            }
        }
        assert!((sum - f(xi * l)[0] * g(eta * w)[0]).abs() < 1e-13);
    }
}
