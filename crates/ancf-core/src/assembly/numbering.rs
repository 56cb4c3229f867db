//! The numbers of the free coordinates: nodes in an order that keeps the factor sparse, fixed coordinates left out.

use crate::linear::{LinearError, Pattern, order};
use crate::model::Model;

/// Marks a coordinate that is fixed.
const FIXED: u32 = u32::MAX;

/// A node of the model: its nodal vectors follow each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Model-wide number of its first nodal vector.
    pub first_vector: usize,
    /// Number of nodal vectors.
    pub vectors: usize,
}

/// The nodes of a model and the numbers of its free coordinates.
#[derive(Clone, Debug)]
pub(super) struct Numbering {
    /// All nodes, body after body.
    pub nodes: Vec<Node>,
    /// The nodes of each element, body after body.
    pub cells: Vec<Vec<[usize; 4]>>,
    /// The nodes in the order of elimination.
    pub order: Vec<usize>,
    /// The place of each node in that order.
    pub place: Vec<usize>,
    /// The coordinate of each free number.
    pub coordinate: Vec<usize>,
    /// The free number of each coordinate.
    number: Vec<u32>,
}

impl Numbering {
    /// Numbers the free coordinates of a model.
    pub fn new(model: &Model) -> Result<Self, LinearError> {
        let mut nodes = Vec::new();
        let mut positions = Vec::new();
        let mut cells = Vec::new();
        let mut offset = 0.0;
        for body in model.bodies() {
            let first = nodes.len();
            let grid = body.grid();
            let columns = grid.divisions()[0] + 1;
            for node in 0..grid.nodes() {
                nodes.push(Node { first_vector: body.vector(node, 0), vectors: body.nodal_vectors().len() });
                positions.push([offset + (node % columns) as f64, (node / columns) as f64]);
            }
            cells.push((0..grid.elements()).map(|e| grid.cell(e).map(|n| first + n)).collect::<Vec<_>>());
            // Bodies lie side by side in the plane in which nodes are ordered.
            offset += columns as f64 + 1.0;
        }
        let groups: Vec<_> = cells.iter().flatten().copied().collect();
        let graph = Pattern::from_groups(nodes.len(), &groups)?;
        let order = order(&graph, Some(&positions))?;

        let mut place = vec![0; nodes.len()];
        let mut number = vec![FIXED; model.reference().len()];
        let mut coordinate = Vec::new();
        for (k, &node) in order.iter().enumerate() {
            place[node] = k;
            let Node { first_vector, vectors } = nodes[node];
            for c in (3 * first_vector..3 * (first_vector + vectors)).filter(|c| !model.fixed()[*c]) {
                number[c] = coordinate.len() as u32;
                coordinate.push(c);
            }
        }
        Ok(Self { nodes, cells, order, place, coordinate, number })
    }

    /// The free number of a coordinate, unless it is fixed.
    pub fn free(&self, coordinate: usize) -> Option<usize> {
        (self.number[coordinate] != FIXED).then(|| self.number[coordinate] as usize)
    }
}
