//! Meshes: a regular grid of four-node elements over the natural coordinates of a reference surface.

mod place;
mod surface;

pub use place::{Edge, End, Place};
pub use surface::{Surface, SurfacePoint};

use crate::error::InputError;

/// A grid of elements of equal size in two parameters, nodes numbered along x first.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    domain: [[f64; 2]; 2],
    divisions: [usize; 2],
}

/// Most nodes a body may have: indices of coordinates are stored in 32 bits.
const MOST_NODES: usize = 1 << 27;

impl Grid {
    /// A grid with `divisions` elements along each parameter.
    ///
    /// # Errors
    ///
    /// At least one element along each parameter, and not more than can be numbered.
    pub fn new(domain: [[f64; 2]; 2], divisions: [usize; 2]) -> Result<Self, InputError> {
        let nodes = divisions.iter().try_fold(1_usize, |n, d| d.checked_add(1).and_then(|d| n.checked_mul(d)));
        let valid = divisions.iter().all(|d| *d > 0) && nodes.is_some_and(|n| n <= MOST_NODES);
        let shown = format!("[{}, {}]", divisions[0], divisions[1]);
        InputError::check("divisions", shown, valid, "two whole numbers from 1, at most 2^27 nodes in all")?;
        Ok(Self { domain, divisions })
    }

    /// The ranges of the parameters.
    pub fn domain(&self) -> &[[f64; 2]; 2] {
        &self.domain
    }

    /// Elements along x and y.
    pub fn divisions(&self) -> [usize; 2] {
        self.divisions
    }

    /// Sides of an element in its parameters.
    pub fn element_sides(&self) -> [f64; 2] {
        [0, 1].map(|i| (self.domain[i][1] - self.domain[i][0]) / self.divisions[i] as f64)
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        (self.divisions[0] + 1) * (self.divisions[1] + 1)
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.divisions[0] * self.divisions[1]
    }

    /// The natural coordinates of a node.
    pub fn parameters(&self, node: usize) -> [f64; 2] {
        let columns = self.divisions[0] + 1;
        let index = [node % columns, node / columns];
        [0, 1].map(|i| {
            let [from, to] = self.domain[i];
            // The last node is at the end of the range to the last bit.
            if index[i] == self.divisions[i] {
                to
            } else {
                from + (to - from) * index[i] as f64 / self.divisions[i] as f64
            }
        })
    }

    /// The nodes A, B, C, D of an element.
    pub fn cell(&self, element: usize) -> [usize; 4] {
        let columns = self.divisions[0] + 1;
        let a = element / self.divisions[0] * columns + element % self.divisions[0];
        [a, a + 1, a + 1 + columns, a + columns]
    }

    /// The element that a point lies in and its place there, `(xi, eta)` in `[0, 1]`.
    ///
    /// # Errors
    ///
    /// The point must lie in the body; an excess of 1e-9 of the range is taken as rounding.
    pub fn locate(&self, point: [f64; 2]) -> Result<(usize, [f64; 2]), InputError> {
        let mut index = [0; 2];
        let mut local = [0.0; 2];
        for i in 0..2 {
            let [from, to] = self.domain[i];
            let position = (point[i] - from) / (to - from);
            if !(-1e-9..=1.0 + 1e-9).contains(&position) {
                let [[x0, x1], [y0, y1]] = self.domain;
                let allowed = format!("a point in the body, x in [{x0}, {x1}], y in [{y0}, {y1}]");
                return Err(Place::Point(point).refuse("at", &allowed));
            }
            let scaled = position.clamp(0.0, 1.0) * self.divisions[i] as f64;
            index[i] = (scaled as usize).min(self.divisions[i] - 1);
            local[i] = scaled - index[i] as f64;
        }
        Ok((index[1] * self.divisions[0] + index[0], local))
    }

    /// The nodes at a place; for a point, the nearest node.
    ///
    /// # Errors
    ///
    /// A point must lie in the body.
    pub fn nodes_at(&self, place: Place) -> Result<Vec<usize>, InputError> {
        let columns = self.divisions[0] + 1;
        let last = |across: usize, end: End| if end == End::High { self.divisions[across] } else { 0 };
        Ok(match place {
            Place::All => (0..self.nodes()).collect(),
            Place::Corner([x, y]) => vec![last(1, y) * columns + last(0, x)],
            Place::Edge(Edge { across: 0, end }) => {
                (0..=self.divisions[1]).map(|j| j * columns + last(0, end)).collect()
            }
            Place::Edge(Edge { across: _, end }) => (0..columns).map(|i| last(1, end) * columns + i).collect(),
            Place::Point(point) => {
                let (element, [xi, eta]) = self.locate(point)?;
                let nearest = usize::from(xi > 0.5) + 2 * usize::from(eta > 0.5);
                let [a, b, c, d] = self.cell(element);
                vec![[a, b, d, c][nearest]]
            }
        })
    }

    /// The elements along an edge.
    pub fn elements_at(&self, edge: Edge) -> Vec<usize> {
        let [nx, ny] = self.divisions;
        let last = if edge.end == End::High { self.divisions[edge.across] - 1 } else { 0 };
        if edge.across == 0 {
            (0..ny).map(|j| j * nx + last).collect()
        } else {
            (0..nx).map(|i| last * nx + i).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid::new([[1.0, 4.0], [-1.0, 1.0]], [3, 2]).unwrap()
    }

    #[test]
    fn cells_are_counter_clockwise() {
        let grid = grid();
        assert_eq!((grid.nodes(), grid.elements()), (12, 6));
        assert_eq!(grid.cell(4), [5, 6, 10, 9]);
        assert_eq!(grid.parameters(10), [3.0, 1.0]);
        assert_eq!(grid.element_sides(), [1.0, 1.0]);
    }

    #[test]
    fn points_are_located() {
        let grid = grid();
        let (element, local) = grid.locate([2.25, 0.5]).unwrap();
        assert_eq!((element, local), (4, [0.25, 0.5]));
        assert_eq!(grid.locate([4.0, 1.0]).unwrap(), (5, [1.0, 1.0]));
        assert_eq!(grid.locate([4.1, 0.0]).unwrap_err().argument, "at");
        assert!(grid.locate([f64::NAN, 0.0]).is_err());
    }

    #[test]
    fn places_are_found() {
        let grid = grid();
        let at = |text: &str| grid.nodes_at(text.parse().unwrap()).unwrap();
        assert_eq!(at("edge:x1"), [3, 7, 11]);
        assert_eq!(at("edge:y0"), [0, 1, 2, 3]);
        assert_eq!(at("corner:x0y1"), [8]);
        assert_eq!(grid.nodes_at(Place::Point([2.9, -0.9])).unwrap(), [2]);
        assert_eq!(grid.elements_at(Edge { across: 0, end: End::High }), [2, 5]);
        assert_eq!(grid.elements_at(Edge { across: 1, end: End::High }), [3, 4, 5]);
    }
}
