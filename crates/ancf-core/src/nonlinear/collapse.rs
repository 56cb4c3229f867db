//! Elements that collapse in a step.

use nalgebra::Vector3;

use crate::mesh::Place;
use crate::model::{Body, Model};

/// Area, relative to the larger one at both ends of a step, that counts as none.
const NO_AREA: f64 = 1e-3;

/// Area of an element in equilibrium, relative to that at rest, below which nothing is left of it: St. Venant-Kirchhoff's law
/// lets a strip lose all its width at a stretch of sqrt(1 + 1/nu), and a column all its length at a finite force.
const SQUEEZED: f64 = 0.1;

/// The middle of an element, relative to its sides.
const MIDDLE: [f64; 2] = [0.5, 0.5];

/// The middles of all elements of a model, where collapse is looked for: gradients at nodes fold and unfold in soft plates
/// whose elements keep their areas, as at a pinned corner.
pub(crate) struct Middles {
    /// Of each body, for each nodal vector of an element: `N_x` and `N_y` at its middle.
    tables: Vec<Vec<[f64; 2]>>,
    /// `r_x` and `r_y` of all elements in the last state, and in the one that was looked at.
    last: Vec<[Vector3<f64>; 2]>,
    next: Vec<[Vector3<f64>; 2]>,
}

impl Middles {
    pub fn new(model: &Model) -> Self {
        let tables = |body: &Body| {
            let [_, x, y, ..] = body.shape(0, MIDDLE).1;
            x.into_iter().zip(y).map(|(x, y)| [x, y]).collect()
        };
        Self { tables: model.bodies().iter().map(tables).collect(), last: Vec::new(), next: Vec::new() }
    }

    /// Begins at a state.
    pub fn begin(&mut self, model: &Model, q: &[f64]) {
        self.look_at(model, q);
        self.accept();
    }

    /// Goes on from the state that was looked at.
    pub fn accept(&mut self) {
        std::mem::swap(&mut self.last, &mut self.next);
    }

    /// The first element that is turned inside out on the way from the last state to another one, in words.
    ///
    /// The energy of an element stays finite when its surface shrinks to nothing, so that a step may lead through that and
    /// out on the other side, where no material has been. There the area vector `r_x x r_y` vanishes on the straight way
    /// from one state to the other. Where the surface only turns, it does so nowhere, but for half a turn in one step.
    pub fn collapsed(&mut self, model: &Model, q: &[f64]) -> Option<String> {
        self.look_at(model, q);
        let turned = |(last, next)| is_turned_inside_out(last, next);
        self.last.iter().zip(&self.next).position(turned).map(|element| place(model, element))
    }

    /// The first element that has hardly any area left in equilibrium, in words.
    pub fn squeezed(&mut self, model: &Model, q: &[f64]) -> Option<String> {
        self.begin(model, model.reference());
        self.look_at(model, q);
        let area = |[x, y]: &[Vector3<f64>; 2]| x.cross(y).norm();
        let mut areas = self.last.iter().zip(&self.next);
        areas.position(|(rest, now)| area(now) < SQUEEZED * area(rest)).map(|element| place(model, element))
    }

    fn look_at(&mut self, model: &Model, q: &[f64]) {
        self.next.clear();
        for (body, tables) in model.bodies().iter().zip(&self.tables) {
            let count = body.nodal_vectors().len();
            self.next.extend((0..body.grid().elements()).map(|element| {
                let [mut x, mut y] = [[0.0; 3]; 2];
                for (node, tables) in body.grid().cell(element).into_iter().zip(tables.chunks_exact(count)) {
                    let vectors = q[3 * body.vector(node, 0)..][..3 * count].as_chunks::<3>().0;
                    for (vector, [n_x, n_y]) in vectors.iter().zip(tables) {
                        for i in 0..3 {
                            x[i] += n_x * vector[i];
                            y[i] += n_y * vector[i];
                        }
                    }
                }
                [Vector3::from(x), Vector3::from(y)]
            }));
        }
    }
}

/// The middle of an element, counted over all bodies, in words.
fn place(model: &Model, mut element: usize) -> String {
    for body in model.bodies() {
        let grid = body.grid();
        if element < grid.elements() {
            let [first, _, last, _] = grid.cell(element).map(|node| grid.parameters(node));
            let middle = Place::Point([0, 1].map(|i| 0.5 * (first[i] + last[i])));
            return format!("{middle} of body \"{}\"", body.name());
        }
        element -= grid.elements();
    }
    unreachable!("elements are those of the bodies")
}

/// Whether the area vector passes by zero closely, and points backwards then.
fn is_turned_inside_out(from: &[Vector3<f64>; 2], to: &[Vector3<f64>; 2]) -> bool {
    // Most elements hardly turn in a step.
    let n = from[0].cross(&from[1]);
    if n.dot(&to[0].cross(&to[1])) >= 0.0 {
        return false;
    }
    let change = [to[0] - from[0], to[1] - from[1]];
    // The area vector on the way, from s = 0 to 1: n + s (n_1 + s n_2).
    let n_1 = change[0].cross(&from[1]) + from[0].cross(&change[1]);
    let n_2 = change[0].cross(&change[1]);
    let [c, b, a] = [n.dot(&n), n.dot(&n_1), n.dot(&n_2)];
    // The zero of c + b s + a s^2, which is positive at 0 and negative at 1.
    let s = 2.0 * c / (-b + (b * b - 4.0 * a * c).sqrt());
    let larger = n.norm().max(to[0].cross(&to[1]).norm());
    (n + s * (n_1 + s * n_2)).norm() < NO_AREA * larger
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collapse_is_told_from_turning() {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        let turned = |angle: f64| [x * angle.cos() + z * angle.sin(), y];
        for angle in [0.1, 1.0, 2.0, 3.0] {
            assert!(!is_turned_inside_out(&turned(0.3), &turned(0.3 + angle)), "{angle}");
        }
        for stretch in [-0.1, -1.0, -30.0] {
            assert!(is_turned_inside_out(&[x, y], &[x * stretch, y]), "{stretch}");
            assert!(is_turned_inside_out(&[x, y], &[x, y * stretch + x]), "{stretch}");
        }
        assert!(!is_turned_inside_out(&[x, y], &[x * 0.1, y * 3.0]));
        let spun = |angle: f64| [x * angle.cos() + y * angle.sin(), y * angle.cos() - x * angle.sin()];
        assert!(!is_turned_inside_out(&spun(0.3), &spun(3.3)));
    }
}
