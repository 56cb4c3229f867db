//! The incomplete quartic of Adini, Clough and Melosh: `S_C` of the paper, for `r`, `r_x`, `r_y` at four nodes.

use super::Polynomial;

/// The 12 functions of an element with sides `l` and `w`, in `xi = x / l`, `eta = y / w`.
///
/// The order is that of the nodal vectors: `r`, `r_x`, `r_y` at the nodes A(0,0), B(1,0), C(1,1), D(0,1).
///
/// # Source
///
/// Dufva and Shabana (2005), Appendix 2, with the slips of the printed text mended: each function is one at its own
/// nodal coordinate and zero at the other eleven.
pub fn acm([l, w]: [f64; 2]) -> [Polynomial; 12] {
    let x = Polynomial::xi();
    let y = Polynomial::eta();
    let (x1, y1) = (x - 1.0, y - 1.0);
    let quartic = 2.0 * x * x + 2.0 * y * y;
    [
        -x1 * y1 * (quartic - x - y - 1.0),
        -l * x * x1 * x1 * y1,
        -w * y * y1 * y1 * x1,
        x * (quartic - 3.0 * x - y) * y1,
        -l * x * x * x1 * y1,
        w * x * y * y1 * y1,
        -x * y * (quartic - 3.0 * x - 3.0 * y + 1.0),
        l * x * x * y * x1,
        w * x * y * y * y1,
        y * x1 * (quartic - x - 3.0 * y),
        l * x * x1 * x1 * y,
        -w * y * y * x1 * y1,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each function is one at its own nodal coordinate and zero at the others.
    #[test]
    fn nodal_coordinates_are_interpolated() {
        let (l, w) = (0.7, 1.9);
        let functions = acm([l, w]);
        for (node, (xi, eta)) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].into_iter().enumerate() {
            for (vector, (dx, dy)) in [(0, 0), (1, 0), (0, 1)].into_iter().enumerate() {
                for (a, function) in functions.iter().enumerate() {
                    let value = function.derivative(dx, dy, xi, eta) / l.powi(dx as i32) / w.powi(dy as i32);
                    let expected = f64::from(a == 3 * node + vector);
                    assert!((value - expected).abs() < 1e-14, "function {a}, node {node}, vector {vector}: {value}");
                }
            }
        }
    }

    /// A complete cubic is in the span of the functions, so it is interpolated exactly.
    #[test]
    fn cubics_are_complete() {
        let (l, w) = (1.3, 0.6);
        let functions = acm([l, w]);
        let field = |x: f64, y: f64| 1.0 + 2.0 * x - y + x * y + 3.0 * x * x - y * y * y + 0.5 * x * x * y;
        let field_x = |x: f64, y: f64| 2.0 + y + 6.0 * x + x * y;
        let field_y = |x: f64, y: f64| -1.0 + x - 3.0 * y * y + 0.5 * x * x;
        let (xi, eta) = (0.37, 0.81);
        let mut sum = 0.0;
        for (node, (x, y)) in [(0.0, 0.0), (l, 0.0), (l, w), (0.0, w)].into_iter().enumerate() {
            for (vector, value) in [field(x, y), field_x(x, y), field_y(x, y)].into_iter().enumerate() {
                sum += value * functions[3 * node + vector].value(xi, eta);
            }
        }
        assert!((sum - field(xi * l, eta * w)).abs() < 1e-13);
    }
}
