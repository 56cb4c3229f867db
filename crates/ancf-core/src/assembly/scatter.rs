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
        Ok(Self { pattern, columns, free, incidents, place: place.clone(), cells: cells.clone(), entries })
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
            let own = &self.free[column.free.clone()];
            for incident in &self.incidents[column.incidents.clone()] {
                let (block, element) = (incident.block as usize, incident.element as usize);
                let n = blocks[block].vectors_per_element();
                let size = 9 * n * (n + 1) / 2;
                let tangent = &outcomes[block].tangent[element * size..(element + 1) * size];
                let per_node = 3 * n / 4;
                let corner = incident.corner as usize;
                for (jj, &j) in own.iter().enumerate() {
                    let diagonal = self.pattern.col_ptr()[column.first + jj] - origin;
                    let entries = &self.entries[block][corner * per_node + j as usize];
                    let add = |target: &mut [f64], corner: usize, rows: &[u8]| {
                        let entries = &entries[corner * per_node..(corner + 1) * per_node];
                        for (value, &i) in target.iter_mut().zip(rows) {
                            *value += tangent[entries[i as usize] as usize];
                        }
                    };
                    add(&mut values[diagonal..diagonal + own.len() - jj], corner, &own[jj..]);
                    let below = diagonal + own.len() - jj;
                    for (other, &offset) in incident.offsets.iter().enumerate() {
                        if other == corner || offset == ABOVE {
                            continue;
                        }
                        let rows = &self.columns[self.place[self.cells[block][element][other]]];
                        let rows = &self.free[rows.free.clone()];
                        add(&mut values[below + offset as usize..][..rows.len()], other, rows);
                    }
                }
            }
        }
    }

    /// Sums what the elements give on each nodal vector into `force`, over all coordinates of the model.
    pub fn sum_forces(&self, blocks: &[Box<dyn ElementBlock>], outcomes: &[Outcome], force: &mut [f64]) {
        force.fill(0.0);
        for (block, outcome) in blocks.iter().zip(outcomes) {
            let n = block.vectors_per_element();
            for (element, local) in outcome.force.chunks(3 * n).enumerate() {
                for (vector, part) in block.vectors(element).iter().zip(local.chunks(3)) {
                    let target = &mut force[3 * *vector as usize..][..3];
                    for (sum, value) in target.iter_mut().zip(part) {
                        *sum += value;
                    }
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
