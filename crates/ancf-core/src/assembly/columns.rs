//! The columns of each node in the global tangent: those of its free coordinates, which follow each other.

use std::ops::Range;

use crate::linear::{LinearError, Pattern};

use super::numbering::{Node, Numbering};

/// The columns of one node.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Where they begin among the entries of the tangent.
    pub start: usize,
    /// Entries of the first of them; each has one less than the one before.
    pub length: usize,
    /// Its free coordinates, in `Columns::free`.
    pub free: Range<usize>,
    /// Its coordinates, free or not, counted in the order of elimination.
    pub forces: Range<usize>,
}

impl Column {
    /// Number of entries of all of them.
    pub fn entries(&self) -> usize {
        self.begin(self.free.len())
    }

    /// Where one of them begins, counted from the first.
    pub fn begin(&self, column: usize) -> usize {
        column * self.length - column * column.saturating_sub(1) / 2
    }
}

/// The columns of all nodes.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    /// In the order of elimination.
    pub of: Vec<Column>,
    /// The free coordinates of all nodes, numbered within each node.
    pub free: Vec<u8>,
    /// The later nodes with which each node shares elements, and their first rows below the diagonal block.
    later: Vec<Vec<(u32, u32)>>,
}

impl Columns {
    /// Finds the columns and the pattern that they make up.
    pub fn new(numbering: &Numbering) -> Result<(Self, Pattern), LinearError> {
        let Numbering { nodes, cells, order, place, .. } = numbering;
        let mut of = Vec::with_capacity(order.len());
        let mut free = Vec::new();
        let mut forces = 0;
        for &node in order {
            let Node { first_vector, vectors } = nodes[node];
            let begin = free.len();
            free.extend((0..3 * vectors).filter(|c| numbering.free(3 * first_vector + c).is_some()).map(|c| c as u8));
            of.push(Column { start: 0, length: 0, free: begin..free.len(), forces: forces..forces + 3 * vectors });
            forces += 3 * vectors;
        }

        let mut neighbours = vec![Vec::new(); order.len()];
        for cell in cells.iter().flatten().map(|cell| cell.map(|node| place[node])) {
            for early in cell {
                neighbours[early].extend(cell.into_iter().filter(|late| *late > early));
            }
        }
        let mut later = Vec::with_capacity(order.len());
        let (mut col_ptr, mut row_idx) = (vec![0], Vec::new());
        for (k, mut neighbours) in neighbours.into_iter().enumerate() {
            neighbours.sort_unstable();
            neighbours.dedup();
            // A free coordinate has the number of free ones before it.
            of[k].start = row_idx.len();
            let own = of[k].free.clone();
            for column in own.clone() {
                row_idx.extend(column..own.end);
                row_idx.extend(neighbours.iter().flat_map(|other| of[*other].free.clone()));
                col_ptr.push(row_idx.len());
            }
            let mut offset = 0;
            later.push(Vec::with_capacity(neighbours.len()));
            for other in neighbours {
                later[k].push((other as u32, offset));
                offset += of[other].free.len() as u32;
            }
            of[k].length = own.len() + offset as usize;
        }
        let pattern = Pattern::new(free.len(), col_ptr, row_idx)?;
        Ok((Self { of, free, later }, pattern))
    }

    /// Where the rows of a later node begin below the diagonal block of an earlier one.
    pub fn offset(&self, early: usize, late: usize) -> u32 {
        let later = &self.later[early];
        later[later.binary_search_by_key(&(late as u32), |(node, _)| *node).expect("nodes of an element")].1
    }
}
