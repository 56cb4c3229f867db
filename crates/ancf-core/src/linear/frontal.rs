//! One front from the entries of the matrix and the updates of its children, and its elimination.

use std::ops::Range;

use faer::MatMut;
use rayon::prelude::*;

use super::front::{eliminate, extend_add};
use super::tree::Tree;
use super::{LinearError, Pattern};

/// Columns of a front that one task adds updates to.
const CHUNK: usize = 32;

/// What the elimination of a front reads.
pub(super) struct Work<'a> {
    pub pattern: &'a Pattern,
    pub tree: &'a Tree,
    pub values: &'a [f64],
}

impl Work<'_> {
    /// Assembles and eliminates a front; `memory` has its place and the updates of its children. Its own update goes to
    /// `result`, or stays at its place. Returns the number of its negative pivots.
    pub fn front(
        &self,
        f: usize,
        panel: &mut [f64],
        memory: &mut [f64],
        result: Option<&mut [f64]>,
        shared: bool,
    ) -> Result<usize, LinearError> {
        let tree = self.tree;
        let front = &tree.fronts[f];
        let (rows, columns, below) = (front.rows(), front.columns.len(), front.below);
        let size = if result.is_some() { front.scratch() } else { front.workspace() };
        let (before, rest) = memory.split_at_mut(front.place);
        let (own, after) = rest.split_at_mut(size);
        let (update, scratch) = match result {
            Some(result) => (result, own),
            None => own.split_at_mut(front.update_size()),
        };
        let children = || {
            tree.children[front.children.clone()].iter().map(|&child| {
                let child = &tree.fronts[child];
                let memory = match child.update < front.place {
                    true => &before[child.update..],
                    false => &after[child.update - front.place - size..],
                };
                (&memory[..child.update_size()], &tree.runs[child.runs.clone()])
            })
        };

        panel.fill(0.0);
        for run in &tree.entries[front.entries.clone()] {
            let length = run.length as usize;
            panel[run.to as usize..][..length].copy_from_slice(&self.values[run.from as usize..][..length]);
        }
        let add = |target: &mut [f64], top: usize, columns: Range<usize>| {
            let height = rows - top;
            let part = |(k, target): (usize, &mut [f64])| {
                let first = columns.start + k * CHUNK;
                for (child, runs) in children() {
                    extend_add(target, top, first..first + target.len() / height, child, runs);
                }
            };
            if shared {
                target.par_chunks_mut(CHUNK * height).enumerate().for_each(part);
            } else if height > 0 {
                target.chunks_mut(CHUNK * height).enumerate().for_each(part);
            }
        };
        add(panel, 0, 0..columns);
        let stopped_at = eliminate(
            MatMut::from_column_major_slice_mut(panel, rows, columns),
            MatMut::from_column_major_slice_mut(update, below, below),
            scratch,
            shared,
        )
        .err();

        // pivots that are exactly zero or have overflowed stop the elimination; those below rounding are found here
        let rounding = self.pattern.n() as f64 * f64::EPSILON;
        let mut negative = 0;
        for k in 0..columns {
            let column = tree.order[front.columns.start + k];
            let pivot = panel[k * rows + k];
            let scale = self.values[self.pattern.col_ptr()[column]].abs();
            if stopped_at == Some(k) || pivot.abs() <= rounding * scale {
                return Err(LinearError::Singular { column, pivot, scale });
            }
            negative += usize::from(pivot < 0.0);
        }
        if below > 0 {
            add(update, columns, columns..rows);
        }
        Ok(negative)
    }
}
