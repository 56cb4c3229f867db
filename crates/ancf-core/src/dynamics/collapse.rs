//! Elements that collapse in a step.

use nalgebra::Vector3;

use crate::element::NodalVector;
use crate::mesh::Place;
use crate::model::Model;

/// Area, relative to the larger one at both ends of a step, that counts as none.
const NO_AREA: f64 = 1e-3;

/// The first node where elements are turned inside out on the way between two states, in words.
///
/// The energy of an element stays finite when its surface shrinks to nothing, so that a step may lead through that and
/// out on the other side, where no material has been. There the area vector `r_x x r_y` vanishes on the straight way from
/// one state to the other. Where the surface only turns, it does so nowhere, but for half a turn in one step.
pub(super) fn collapsed(model: &Model, from: &[f64], to: &[f64]) -> Option<String> {
    for body in model.bodies() {
        let index = |kind| body.nodal_vectors().iter().position(|v| *v == kind);
        let (Some(x), Some(y)) = (index(NodalVector::RX), index(NodalVector::RY)) else { continue };
        for node in 0..body.grid().nodes() {
            let tangents =
                |q: &[f64]| [x, y].map(|index| Vector3::from_column_slice(&q[3 * body.vector(node, index)..][..3]));
            if is_turned_inside_out(tangents(from), tangents(to)) {
                let at = Place::Point(body.grid().parameters(node));
                return Some(format!("{at} of body \"{}\"", body.name()));
            }
        }
    }
    None
}

/// Whether the area vector passes by zero closely, and points backwards then.
fn is_turned_inside_out(from: [Vector3<f64>; 2], to: [Vector3<f64>; 2]) -> bool {
    let change = [to[0] - from[0], to[1] - from[1]];
    // The area vector on the way, from s = 0 to 1: n + s (n_1 + s n_2).
    let n = from[0].cross(&from[1]);
    let n_1 = change[0].cross(&from[1]) + from[0].cross(&change[1]);
    let n_2 = change[0].cross(&change[1]);
    let [c, b, a] = [n.dot(&n), n.dot(&n_1), n.dot(&n_2)];
    // The first zero of c + b s + a s^2, where c is positive; none: not a number.
    let s = 2.0 * c / (-b + (b * b - 4.0 * a * c).sqrt());
    let larger = n.norm().max(to[0].cross(&to[1]).norm());
    (0.0..=1.0).contains(&s) && (n + s * (n_1 + s * n_2)).norm() < NO_AREA * larger
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collapse_is_told_from_turning() {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        let turned = |angle: f64| [x * angle.cos() + z * angle.sin(), y];
        for angle in [0.1, 1.0, 2.0, 3.0] {
            assert!(!is_turned_inside_out(turned(0.3), turned(0.3 + angle)), "{angle}");
        }
        for stretch in [-0.1, -1.0, -30.0] {
            assert!(is_turned_inside_out([x, y], [x * stretch, y]), "{stretch}");
            assert!(is_turned_inside_out([x, y], [x, y * stretch + x]), "{stretch}");
        }
        assert!(!is_turned_inside_out([x, y], [x * 0.1, y * 3.0]));
        let spun = |angle: f64| [x * angle.cos() + y * angle.sin(), y * angle.cos() - x * angle.sin()];
        assert!(!is_turned_inside_out(spun(0.3), spun(3.3)));
    }
}
