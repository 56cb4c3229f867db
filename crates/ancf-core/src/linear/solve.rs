//! Solution with the factor: forward through the fronts, each handing on what it makes of its rows below, and back.

use std::ops::Range;

use pulp::Arch;
use rayon::prelude::*;

use super::panel;
use super::tree::{Front, Tree};

/// Factors with fewer entries are solved with on one thread.
const PARALLEL: usize = 1 << 19;

/// Working memory: for each front a vector over its rows.
#[derive(Default)]
pub(super) struct Solution {
    parts: Vec<f64>,
}

/// The fronts of a subtree, or of the top, and their parts of the vector; the first part begins at `begin`.
struct Part<'a> {
    fronts: Range<usize>,
    begin: usize,
    parts: &'a mut [f64],
}

impl Solution {
    /// Replaces interleaved right-hand sides, (n, count), by the solutions.
    pub fn solve(&mut self, tree: &Tree, factor: &[f64], rhs: &mut [f64], count: usize) {
        let size = tree.vector() * count;
        if self.parts.len() < size {
            self.parts.resize(size, 0.0);
        }
        let solver = Solver { arch: Arch::new(), tree, factor, count };
        let top = tree.top();
        let split = tree.fronts.get(top.start).map_or(tree.vector(), |front| front.vector) * count;
        let (below, above) = self.parts[..size].split_at_mut(split);
        solver.subtrees(below, |part| solver.forward(part, None, rhs));
        solver.forward(Part { fronts: top.clone(), begin: split, parts: above }, Some(below), rhs);
        solver.backward(Part { fronts: top, begin: split, parts: above }, None);
        let above = (split, &*above);
        solver.subtrees(below, |part| solver.backward(part, Some(above)));
        for front in &tree.fronts {
            let rows = front.rows();
            for (k, &column) in tree.order[front.columns.clone()].iter().enumerate() {
                for c in 0..count {
                    rhs[column * count + c] = self.parts[front.vector * count + c * rows + k];
                }
            }
        }
    }
}

struct Solver<'a> {
    arch: Arch,
    tree: &'a Tree,
    factor: &'a [f64],
    count: usize,
}

impl<'a> Solver<'a> {
    /// Calls a function for each subtree.
    fn subtrees(&self, parts: &mut [f64], work: impl Fn(Part<'_>) + Send + Sync) {
        let tree = self.tree;
        let mut rest = parts;
        let mut begin = 0;
        let mut tasks = Vec::with_capacity(tree.subtrees.len());
        for ends in tree.subtrees.windows(2) {
            let fronts = ends[0]..ends[1];
            let size = tree.fronts[fronts.clone()].iter().map(Front::rows).sum::<usize>() * self.count;
            let (parts, others) = rest.split_at_mut(size);
            tasks.push(Part { fronts, begin, parts });
            begin += size;
            rest = others;
        }
        if self.factor.len() < PARALLEL {
            tasks.into_iter().for_each(work);
        } else {
            tasks.into_par_iter().for_each(work);
        }
    }

    /// The columns of a front in the factor: unit lower triangle with D on its diagonal, and the rows below.
    fn panel(&self, front: &Front) -> &'a [f64] {
        &self.factor[front.factor..front.factor + front.size()]
    }

    /// Solves with L; `below` are the parts of the subtrees that the top continues.
    fn forward(&self, part: Part<'_>, below: Option<&[f64]>, rhs: &[f64]) {
        let Self { tree, count, .. } = *self;
        for front in &tree.fronts[part.fronts] {
            let (rows, columns) = (front.rows(), front.columns.len());
            let (before, own) = part.parts.split_at_mut(front.vector * count - part.begin);
            let own = &mut own[..rows * count];
            for c in 0..count {
                for (k, &column) in tree.order[front.columns.clone()].iter().enumerate() {
                    own[c * rows + k] = rhs[column * count + c];
                }
                own[c * rows + columns..(c + 1) * rows].fill(0.0);
            }
            for &child in &tree.children[front.children.clone()] {
                let child = &tree.fronts[child];
                let begin = child.vector * count;
                let values = match below {
                    Some(below) if begin < part.begin => &below[begin..],
                    _ => &before[begin - part.begin..],
                };
                for c in 0..count {
                    let values = &values[c * child.rows() + child.columns.len()..][..child.below];
                    let own = &mut own[c * rows..][..rows];
                    for run in &tree.runs[child.runs.clone()] {
                        let values = &values[run.from as usize..][..run.length as usize];
                        own[run.to as usize..][..values.len()].iter_mut().zip(values).for_each(|(sum, v)| *sum += v);
                    }
                }
            }
            panel::forward(self.arch, self.panel(front), own, rows);
        }
    }

    /// Divides by D and solves with L^T; `above` are the parts of the top and where they begin.
    fn backward(&self, part: Part<'_>, above: Option<(usize, &[f64])>) {
        let Self { tree, count, .. } = *self;
        for f in part.fronts.rev() {
            let front = &tree.fronts[f];
            let (rows, columns) = (front.rows(), front.columns.len());
            let begin = front.vector * count - part.begin;
            let (own, after) = part.parts[begin..].split_at_mut(rows * count);
            if let Some(parent) = front.parent {
                let parent = &tree.fronts[parent];
                let place = parent.vector * count;
                let values = match above {
                    Some((begin, above)) if place >= begin => &above[place - begin..],
                    _ => &after[place - part.begin - begin - rows * count..],
                };
                for c in 0..count {
                    let values = &values[c * parent.rows()..][..parent.rows()];
                    let own = &mut own[c * rows + columns..][..front.below];
                    for run in &tree.runs[front.runs.clone()] {
                        let length = run.length as usize;
                        own[run.from as usize..][..length].copy_from_slice(&values[run.to as usize..][..length]);
                    }
                }
            }
            panel::backward(self.arch, self.panel(front), own, rows);
        }
    }
}
