//! From element tangents to the global one, the same sum in the same order on any number of threads.
//!
//! The columns of a node follow each other in the matrix, so nodes are shared out among threads; each adds what its
//! elements give, in the order of the elements.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use crate::element::{ElementBlock, Outcome};
use crate::linear::{LinearError, Pattern};
use crate::strain::packed;

use super::numbering::{Node, Numbering};

/// Nodes handled by one task.
const TASK: usize = 64;

/// Nodes whose forces are summed by one task.
const FORCE_TASK: usize = 512;

/// Marks rows that are not stored in the lower triangle.
const ABOVE: u32 = u32::MAX;

/// An element that a node belongs to.
#[derive(Clone, Copy, Debug)]
struct Incident {
    block: u32,
    element: u32,
    corner: u32,
    /// For each corner of the element, where its rows begin below the diagonal block of this node's columns.
    offsets: [u32; 4],
}

/// The columns of one node.
#[derive(Clone, Debug)]
struct Column {
    /// Free number of its first free coordinate.
    first: usize,
    /// Its free coordinates, numbered within the node.
    free: Range<usize>,
    incidents: Range<usize>,
}

/// Where each entry of an element tangent goes.
#[derive(Clone, Debug)]
pub(super) struct Scatter {
    pattern: Arc<Pattern>,
    nodes: Vec<Node>,
    columns: Vec<Column>,
    free: Vec<u8>,
    incidents: Vec<Incident>,
    place: Vec<usize>,
    cells: Vec<Vec<[usize; 4]>>,
    /// For each body and each column of its element tangents the places of the entries.
    entries: Vec<Vec<Vec<u32>>>,
}

impl Scatter {
    /// Makes the pattern of the tangent and the places of all element entries in it.
    pub fn new(numbering: &Numbering) -> Result<Self, LinearError> {
        let Numbering { nodes, cells, order, place, .. } = numbering;
        let mut elements_of = vec![Vec::new(); nodes.len()];
        for (block, cells) in cells.iter().enumerate() {
            for (element, cell) in cells.iter().enumerate() {
                for (corner, &node) in cell.iter().enumerate() {
                    elements_of[node].push((block, element, corner));
                }
            }
        }

        let mut free = Vec::new();
        let mut columns = Vec::with_capacity(nodes.len());
        let mut first = 0;
        for &node in order {
            let Node { first_vector, vectors } = nodes[node];
            let start = free.len();
            free.extend((0..3 * vectors).filter(|c| numbering.free(3 * first_vector + c).is_some()).map(|c| c as u8));
            columns.push(Column { first, free: start..free.len(), incidents: 0..0 });
            first += free.len() - start;
        }

        let mut incidents = Vec::new();
        let (mut col_ptr, mut row_idx) = (vec![0], Vec::new());
        for k in 0..columns.len() {
            let elements = &elements_of[order[k]];
            let mut later: Vec<_> = elements.iter().flat_map(|&(b, e, _)| cells[b][e].map(|n| place[n])).collect();
            later.retain(|other| *other > k);
            later.sort_unstable();
            later.dedup();

            let rows = |c: &Column| c.first..c.first + c.free.len();
            let own = rows(&columns[k]);
            for column in own.clone() {
                row_idx.extend(column..own.end);
                row_idx.extend(later.iter().flat_map(|other| rows(&columns[*other])));
                col_ptr.push(row_idx.len());
            }

            let mut offset = 0;
            let mut offset_of = Vec::with_capacity(later.len());
            for other in &later {
                offset_of.push(offset);
                offset += columns[*other].free.len() as u32;
            }
            let start = incidents.len();
            incidents.extend(elements.iter().map(|&(block, element, corner)| Incident {
                block: block as u32,
                element: element as u32,
                corner: corner as u32,
                offsets: cells[block][element].map(|n| later.binary_search(&place[n]).map_or(ABOVE, |i| offset_of[i])),
            }));
            columns[k].incidents = start..incidents.len();
        }
        let pattern = Arc::new(Pattern::new(first, col_ptr, row_idx)?);
        let entries = cells.iter().map(|cells| {
            let size = 12 * nodes[cells[0][0]].vectors;
            (0..size).map(|j| (0..size).map(|i| entry(i, j)).collect()).collect()
        });
        let entries = entries.collect();
        Ok(Self {
            pattern,
            nodes: nodes.clone(),
            columns,
            free,
            incidents,
            place: place.clone(),
            cells: cells.clone(),
            entries,
        })
    }

    /// The pattern of the tangent.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Sums the element tangents of all blocks into `values`, in the order of the pattern.
    pub fn sum(&self, blocks: &[Box<dyn ElementBlock>], outcomes: &[Outcome], values: &mut [f64]) {
        let start = |column: &Column| self.pattern.col_ptr()[column.first];
        if self.columns.len() <= TASK {
            return self.sum_columns(&self.columns, blocks, outcomes, values);
        }
        let mut tasks = Vec::with_capacity(self.columns.len() / TASK + 1);
        let mut rest = values;
        for (i, columns) in self.columns.chunks(TASK).enumerate() {
            let end = self.columns.get((i + 1) * TASK).map_or(self.pattern.nnz(), start);
            let (part, others) = rest.split_at_mut(end - start(&columns[0]));
            tasks.push((columns, part));
            rest = others;
        }
        tasks.into_par_iter().for_each(|(columns, part)| self.sum_columns(columns, blocks, outcomes, part));
    }

    /// The same for columns that follow each other; `values` begins with the first of them.
    fn sum_columns(
        &self,
        columns: &[Column],
        blocks: &[Box<dyn ElementBlock>],
        outcomes: &[Outcome],
        values: &mut [f64],
    ) {
        let origin = self.pattern.col_ptr()[columns[0].first];
        values.fill(0.0);
        for column in columns {
            for incident in &self.incidents[column.incidents.clone()] {
                let (block, element) = (incident.block as usize, incident.element as usize);
                let n = blocks[block].vectors_per_element();
                let size = 9 * n * (n + 1) / 2;
                let tangent = &outcomes[block].tangent[element * size..(element + 1) * size];
                for other in 0..4 {
                    let offset = incident.offsets[other];
                    if other != incident.corner as usize && offset == ABOVE {
                        continue;
                    }
                    let rows = &self.columns[self.place[self.cells[block][element][other]]];
                    let corners = [other, incident.corner as usize];
                    if column.free.len() == 3 * n / 4 && rows.free.len() == 3 * n / 4 {
                        self.add_whole(column, origin, corners, offset as usize, n / 4, tangent, values);
                    } else {
                        self.add_free(column, rows, origin, corners, offset as usize, block, tangent, values);
                    }
                }
            }
        }
    }

    /// Adds what an element gives for the columns of one node and the rows of another, or the same, none of whose
    /// coordinates are fixed: `corners` are those of the rows and of the columns, `kinds` the vectors of a node.
    #[expect(clippy::too_many_arguments, reason = "the inner loop of the sum")]
    fn add_whole(
        &self,
        column: &Column,
        origin: usize,
        [row_corner, column_corner]: [usize; 2],
        offset: usize,
        kinds: usize,
        tangent: &[f64],
        values: &mut [f64],
    ) {
        let starts = &self.pattern.col_ptr()[column.first..][..3 * kinds];
        let same = row_corner == column_corner;
        for v in 0..kinds {
            let b = column_corner * kinds + v;
            for u in (if same { v } else { 0 })..kinds {
                let a = row_corner * kinds + u;
                let block: &[f64; 9] = tangent[9 * packed(a.min(b), a.max(b))..].first_chunk().expect("a whole block");
                for c in 0..3 {
                    let j = 3 * v + c;
                    let start = starts[j] - origin;
                    if same && u == v {
                        for (i, value) in values[start..start + 3 - c].iter_mut().enumerate() {
                            *value += block[3 * c + c + i];
                        }
                        continue;
                    }
                    let first = start + 3 * u + if same { 0 } else { 3 * kinds + offset } - j;
                    let target: &mut [f64; 3] = values[first..].first_chunk_mut().expect("rows of the column");
                    for i in 0..3 {
                        target[i] += if a <= b { block[3 * i + c] } else { block[3 * c + i] };
                    }
                }
            }
        }
    }

    /// The same where some of the coordinates are fixed.
    #[expect(clippy::too_many_arguments, reason = "the inner loop of the sum")]
    fn add_free(
        &self,
        column: &Column,
        rows: &Column,
        origin: usize,
        [row_corner, column_corner]: [usize; 2],
        offset: usize,
        block: usize,
        tangent: &[f64],
        values: &mut [f64],
    ) {
        let own = &self.free[column.free.clone()];
        let rows = &self.free[rows.free.clone()];
        let per_node = self.entries[block].len() / 4;
        for (jj, &j) in own.iter().enumerate() {
            let diagonal = self.pattern.col_ptr()[column.first + jj] - origin;
            let (first, rows) = match row_corner == column_corner {
                true => (diagonal, &rows[jj..]),
                false => (diagonal + own.len() - jj + offset, rows),
            };
            let entries = &self.entries[block][column_corner * per_node + j as usize][row_corner * per_node..];
            for (value, &i) in values[first..].iter_mut().zip(rows) {
                *value += tangent[entries[i as usize] as usize];
            }
        }
    }

    /// Sums what the elements give on each nodal vector into `force`, over all coordinates of the model.
    pub fn sum_forces(&self, blocks: &[Box<dyn ElementBlock>], outcomes: &[Outcome], force: &mut [f64]) {
        if self.nodes.len() <= FORCE_TASK {
            return self.sum_node_forces(0, blocks, outcomes, force);
        }
        let mut tasks = Vec::with_capacity(self.nodes.len() / FORCE_TASK + 1);
        let mut rest = force;
        for first in (0..self.nodes.len()).step_by(FORCE_TASK) {
            let end = self
                .nodes
                .get(first + FORCE_TASK)
                .map_or(rest.len(), |next| 3 * (next.first_vector - self.nodes[first].first_vector));
            let (part, others) = rest.split_at_mut(end);
            tasks.push((first, part));
            rest = others;
        }
        tasks.into_par_iter().for_each(|(first, part)| self.sum_node_forces(first, blocks, outcomes, part));
    }

    /// The same for the nodes from `first` on whose coordinates are in `force`.
    fn sum_node_forces(&self, first: usize, blocks: &[Box<dyn ElementBlock>], outcomes: &[Outcome], force: &mut [f64]) {
        force.fill(0.0);
        let mut rest = force;
        for node in first..self.nodes.len() {
            if rest.is_empty() {
                break;
            }
            let (target, others) = rest.split_at_mut(3 * self.nodes[node].vectors);
            rest = others;
            for incident in &self.incidents[self.columns[self.place[node]].incidents.clone()] {
                let block = incident.block as usize;
                let size = 3 * blocks[block].vectors_per_element();
                let begin = incident.element as usize * size + incident.corner as usize * target.len();
                for (sum, part) in target.iter_mut().zip(&outcomes[block].force[begin..]) {
                    *sum += part;
                }
            }
        }
    }
}

/// The place of entry `(i, j)` in a packed symmetric matrix of 3 x 3 blocks.
fn entry(i: usize, j: usize) -> u32 {
    let (a, b) = (i / 3, j / 3);
    let (block, row, column) = if a <= b { (packed(a, b), i % 3, j % 3) } else { (packed(b, a), j % 3, i % 3) };
    (9 * block + 3 * row + column) as u32
}
