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

/// The fronts of a subtree, or of the top, and their parts of `W` vectors side by side; the first part begins at `begin`.
struct Part<'a, const W: usize> {
    fronts: Range<usize>,
    begin: usize,
    parts: &'a mut [[f64; W]],
}

impl Solution {
    /// Replaces `W` interleaved right-hand sides, (n, W), by the solutions.
    pub fn solve<const W: usize>(&mut self, tree: &Tree, factor: &[f64], rhs: &mut [[f64; W]]) {
        let parts = self.parts(tree);
        let solver = Solver::<W> { arch: panel::arch::<W>(), tree, factor };
        let (below, above) = parts.split_at_mut(tree.split());
        solver.subtrees(below, |part| solver.forward(part, None, rhs));
        solver.forward(Part { fronts: tree.top(), begin: tree.split(), parts: above }, Some(below), rhs);
        solver.go_back(parts, rhs);
    }

    /// Vectors `z` with `z . A z = -1` and `z . A y = 0` for any two of them: one for each negative pivot.
    pub fn descents(&mut self, tree: &Tree, factor: &[f64]) -> Vec<Vec<f64>> {
        let parts = self.parts::<1>(tree);
        let solver = Solver { arch: panel::arch::<1>(), tree, factor };
        let mut descents = Vec::new();
        for front in &tree.fronts {
            for j in 0..front.columns.len() {
                let pivot = solver.panel(front)[j * (front.rows() + 1)];
                if pivot < 0.0 {
                    // L^T z = e_j / sqrt|d_j|; the way back divides by d_j.
                    parts.fill([0.0]);
                    parts[front.vector + j] = [-(-pivot).sqrt()];
                    let mut descent = vec![0.0; tree.order.len()];
                    solver.go_back(parts, descent.as_chunks_mut().0);
                    descents.push(descent);
                }
            }
        }
        descents
    }

    /// Working memory for `W` vectors.
    fn parts<const W: usize>(&mut self, tree: &Tree) -> &mut [[f64; W]] {
        let size = tree.vector() * W;
        if self.parts.len() < size {
            self.parts.resize(size, 0.0);
        }
        self.parts[..size].as_chunks_mut().0
    }
}

struct Solver<'a, const W: usize> {
    arch: Arch,
    tree: &'a Tree,
    factor: &'a [f64],
}

impl<'a, const W: usize> Solver<'a, W> {
    /// Divides by D and solves with L^T, from the last front to the first.
    fn go_back(&self, parts: &mut [[f64; W]], solution: &mut [[f64; W]]) {
        let tree = self.tree;
        let (below, above) = parts.split_at_mut(tree.split());
        self.backward(Part { fronts: tree.top(), begin: tree.split(), parts: above }, None);
        let above = (tree.split(), &*above);
        self.subtrees(below, |part| self.backward(part, Some(above)));
        for front in &tree.fronts {
            for (&column, value) in tree.order[front.columns.clone()].iter().zip(&parts[front.vector..]) {
                solution[column] = *value;
            }
        }
    }

    /// Calls a function for each subtree.
    fn subtrees(&self, parts: &mut [[f64; W]], work: impl Fn(Part<'_, W>) + Send + Sync) {
        let tree = self.tree;
        let mut rest = parts;
        let mut begin = 0;
        let mut tasks = Vec::with_capacity(tree.subtrees.len());
        for ends in tree.subtrees.windows(2) {
            let fronts = ends[0]..ends[1];
            let size = tree.fronts[fronts.clone()].iter().map(Front::rows).sum::<usize>();
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
    fn forward(&self, part: Part<'_, W>, below: Option<&[[f64; W]]>, rhs: &[[f64; W]]) {
        let Self { tree, .. } = *self;
        for front in &tree.fronts[part.fronts] {
            let (before, own) = part.parts.split_at_mut(front.vector - part.begin);
            let own = &mut own[..front.rows()];
            let (first, rest) = own.split_at_mut(front.columns.len());
            for (own, &column) in first.iter_mut().zip(&tree.order[front.columns.clone()]) {
                *own = rhs[column];
            }
            rest.fill([0.0; W]);
            for &child in &tree.children[front.children.clone()] {
                let child = &tree.fronts[child];
                let values = match below {
                    Some(below) if child.vector < part.begin => &below[child.vector..],
                    _ => &before[child.vector - part.begin..],
                };
                let values = &values[child.columns.len()..][..child.below];
                for run in &tree.runs[child.runs.clone()] {
                    let values = &values[run.from as usize..][..run.length as usize];
                    for (sums, values) in own[run.to as usize..].iter_mut().zip(values) {
                        for w in 0..W {
                            sums[w] += values[w];
                        }
                    }
                }
            }
            panel::forward(self.arch, self.panel(front), own);
        }
    }

    /// Divides by D and solves with L^T; `above` are the parts of the top and where they begin.
    fn backward(&self, part: Part<'_, W>, above: Option<(usize, &[[f64; W]])>) {
        let Self { tree, .. } = *self;
        for f in part.fronts.rev() {
            let front = &tree.fronts[f];
            let begin = front.vector - part.begin;
            let (own, after) = part.parts[begin..].split_at_mut(front.rows());
            if let Some(parent) = front.parent {
                let place = tree.fronts[parent].vector;
                let values = match above {
                    Some((begin, above)) if place >= begin => &above[place - begin..],
                    _ => &after[place - part.begin - begin - own.len()..],
                };
                let rest = &mut own[front.columns.len()..];
                for run in &tree.runs[front.runs.clone()] {
                    let length = run.length as usize;
                    rest[run.from as usize..][..length].copy_from_slice(&values[run.to as usize..][..length]);
                }
            }
            panel::backward(self.arch, self.panel(front), own);
        }
    }
}
