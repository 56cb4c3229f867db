//! Supernodes: which columns are eliminated together, and which subtrees of them in parallel.

use super::Pattern;
use super::elimination::Elimination;
use super::tree::{Front, Tree, work};

/// Subtrees with less work than this are not worth a task of their own.
const TASK: f64 = 4e6;
/// No task has more than this share of the work.
const SHARE: f64 = 1.0 / 24.0;

/// A tree of sets of columns.
pub(super) struct Supernodes {
    columns: Vec<Vec<usize>>,
    below: Vec<usize>,
    parent: Vec<Option<usize>>,
    zeros: Vec<usize>,
}

impl Supernodes {
    /// Chains of groups of columns with the same rows.
    pub fn new(elimination: &Elimination) -> Self {
        let Elimination { parent, counts, .. } = elimination;
        let n = parent.len();
        let mut children = vec![0; n];
        parent.iter().flatten().for_each(|&parent| children[parent] += 1);
        let mut of_group = vec![usize::MAX; n];
        let mut last = Vec::new();
        let mut columns: Vec<Vec<usize>> = Vec::new();
        for group in 0..n {
            if of_group[group] != usize::MAX {
                continue;
            }
            let mut chain: Vec<usize> = elimination.columns(group).collect();
            let mut end = group;
            of_group[group] = columns.len();
            while let Some(next) = parent[end]
                && children[next] == 1
                && counts[next] + elimination.columns(end).len() == counts[end]
            {
                chain.extend(elimination.columns(next));
                of_group[next] = columns.len();
                end = next;
            }
            last.push(end);
            columns.push(chain);
        }
        let below = last.iter().map(|&group| counts[group] - elimination.columns(group).len()).collect();
        let parent = last.iter().map(|&group| parent[group].map(|group| of_group[group])).collect();
        let zeros = vec![0; columns.len()];
        Self { columns, below, parent, zeros }
    }

    /// Merges supernodes with their parents where that adds few zeros: fewer and larger fronts are faster.
    pub fn merge(&mut self) {
        // A parent's first column comes after its children's, so children are met first.
        for child in 0..self.columns.len() {
            let Some(parent) = self.parent[child] else { continue };
            let (k, m) = (self.columns[child].len(), self.below[child]);
            let (kp, mp) = (self.columns[parent].len(), self.below[parent]);
            let zeros = self.zeros[child] + self.zeros[parent] + k * (kp + mp - m);
            let size = (k + kp) * (k + kp + 1) / 2 + (k + kp) * mp;
            let most = match k + kp {
                0..=16 => 0.5,
                17..=48 => 0.1,
                49..=96 => 0.05,
                _ => 0.03,
            };
            if zeros as f64 <= most * size as f64 {
                let mut columns = std::mem::take(&mut self.columns[child]);
                columns.append(&mut self.columns[parent]);
                self.columns[parent] = columns;
                self.zeros[parent] = zeros;
            }
        }
        // Children of what was merged belong to what it was merged with.
        for s in (0..self.columns.len()).rev() {
            if let Some(parent) = self.parent[s]
                && self.columns[parent].is_empty()
            {
                self.parent[s] = self.parent[parent];
            }
        }
    }

    /// Numbers the columns: subtree after subtree, in each children before parents.
    pub fn arrange(self, pattern: &Pattern) -> Tree {
        let n = self.columns.len();
        let is_front = |s: &usize| !self.columns[*s].is_empty();
        let mut children = vec![Vec::new(); n];
        let mut total: Vec<f64> = (0..n).map(|s| work(self.columns[s].len(), self.below[s])).collect();
        for s in (0..n).filter(is_front) {
            if let Some(parent) = self.parent[s] {
                children[parent].push(s);
                total[parent] += total[s];
            }
        }
        let all: f64 = (0..n).filter(|s| is_front(s) && self.parent[*s].is_none()).map(|s| total[s]).sum();
        let most = (SHARE * all).max(TASK);
        let is_small = |s: usize| total[s] <= most || all <= 4.0 * TASK;

        let (mut sequence, mut subtrees) = (Vec::new(), vec![0]);
        for root in (0..n).filter(is_front) {
            if is_small(root) && self.parent[root].is_none_or(|parent| !is_small(parent)) {
                postorder(root, &children, &mut sequence);
                subtrees.push(sequence.len());
            }
        }
        sequence.extend((0..n).filter(|s| is_front(s) && !is_small(*s)));

        let mut number = vec![usize::MAX; n];
        sequence.iter().enumerate().for_each(|(f, &s)| number[s] = f);
        let mut order = Vec::with_capacity(pattern.n());
        let mut all_children = Vec::new();
        let fronts = sequence
            .iter()
            .map(|&s| {
                let start = order.len();
                order.extend(&self.columns[s]);
                let first = all_children.len();
                all_children.extend(children[s].iter().map(|&child| number[child]));
                Front {
                    columns: start..order.len(),
                    below: self.below[s],
                    children: first..all_children.len(),
                    parent: self.parent[s].map(|parent| number[parent]),
                    runs: 0..0,
                    entries: 0..0,
                    factor: 0,
                    place: 0,
                    update: 0,
                    vector: 0,
                }
            })
            .collect();
        Tree {
            order,
            fronts,
            subtrees,
            children: all_children,
            runs: Vec::new(),
            entries: Vec::new(),
            stack: 0,
            shared: 0,
            results: Vec::new(),
        }
    }
}

/// Appends a tree, children first.
fn postorder(root: usize, children: &[Vec<usize>], sequence: &mut Vec<usize>) {
    let mut stack = vec![(root, 0)];
    while let Some((s, next)) = stack.last_mut() {
        match children[*s].get(*next) {
            Some(&child) => {
                *next += 1;
                stack.push((child, 0));
            }
            None => {
                sequence.push(*s);
                stack.pop();
            }
        }
    }
}
