//! The assembly tree of a factorisation: which columns are eliminated together, and what follows from that.

use std::ops::Range;

use super::elimination::Elimination;
use super::{Pattern, front};

/// Numbers that follow each other in two arrays.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub from: u32,
    pub to: u32,
    pub length: u32,
}

/// Columns that are eliminated together, as a dense matrix over them and over the rows that they couple with.
#[derive(Debug, Clone)]
pub(super) struct Front {
    /// Its columns, in the order of elimination.
    pub columns: Range<usize>,
    /// Number of rows below them.
    pub below: usize,
    /// Where the fronts that it receives updates from are in [`Tree::children`].
    pub children: Range<usize>,
    /// The front that receives its update.
    pub parent: Option<usize>,
    /// Where its rows below are in the parent's rows: a range of [`Tree::runs`].
    pub runs: Range<usize>,
    /// From the values of the matrix to its columns: a range of [`Tree::entries`].
    pub entries: Range<usize>,
    /// Where its part of the factor begins.
    pub factor: usize,
    /// Where its update to the parent begins in the working memory.
    pub update: usize,
    /// Where its part of a vector begins.
    pub vector: usize,
}

impl Front {
    /// Rows, those of its own columns included.
    pub fn rows(&self) -> usize {
        self.columns.len() + self.below
    }

    /// Entries of its part of the factor.
    pub fn size(&self) -> usize {
        self.rows() * self.columns.len()
    }

    /// Multiplications and additions of its elimination.
    pub fn work(&self) -> f64 {
        work(self.columns.len(), self.below)
    }

    /// Working memory while it is eliminated: the update and a scaled copy of a block of columns.
    pub fn workspace(&self) -> usize {
        self.below * self.below + self.rows() * self.columns.len().min(front::BLOCK)
    }
}

/// Operations to eliminate `columns` columns with `below` rows more.
fn work(columns: usize, below: usize) -> f64 {
    let (k, m) = (columns as f64, below as f64);
    k * m * m + k * k * m + k * k * k / 3.0
}

/// Subtrees with less work than this are not worth a task of their own.
const TASK: f64 = 4e6;
/// No task has more than this share of the work.
const SHARE: f64 = 1.0 / 24.0;

/// The fronts of a factorisation: first disjoint subtrees that are independent of each other, then what joins them.
///
/// # Source
///
/// Duff and Reid (1983), the multifrontal method; Liu (1992), its assembly tree.
#[derive(Debug)]
pub(super) struct Tree {
    /// The column of the pattern that is eliminated k-th.
    pub order: Vec<usize>,
    /// All fronts, each after those that it receives updates from.
    pub fronts: Vec<Front>,
    /// The first front of each subtree, and the end of the last one.
    pub subtrees: Vec<usize>,
    pub children: Vec<usize>,
    pub runs: Vec<Run>,
    pub entries: Vec<Run>,
    /// Numbers in the working memory of an elimination.
    pub workspace: usize,
    /// Where the working memory of each subtree begins, and the end of the last one.
    pub regions: Vec<usize>,
}

impl Tree {
    pub fn new(pattern: &Pattern) -> Self {
        let mut supernodes = Supernodes::new(&Elimination::new(pattern));
        supernodes.merge();
        let mut tree = supernodes.arrange(pattern);
        tree.place(pattern);
        tree.plan();
        tree
    }

    /// Entries of the factor.
    pub fn size(&self) -> usize {
        self.fronts.last().map_or(0, |front| front.factor + front.size())
    }

    /// Numbers in the parts of a vector of all fronts.
    pub fn vector(&self) -> usize {
        self.fronts.last().map_or(0, |front| front.vector + front.rows())
    }

    /// The fronts that join the subtrees.
    pub fn top(&self) -> Range<usize> {
        *self.subtrees.last().expect("an end")..self.fronts.len()
    }

    /// Finds the rows of each front, where they are in its parent, and where the entries of the matrix are.
    fn place(&mut self, pattern: &Pattern) {
        let n = pattern.n();
        let mut place = vec![0_u32; n];
        for (k, &column) in self.order.iter().enumerate() {
            place[column] = k as u32;
        }
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); self.fronts.len()];
        let mut local = vec![0; n];
        let mut seen_in = vec![usize::MAX; n];
        let (mut factor, mut vector) = (0, 0);
        for f in 0..self.fronts.len() {
            let Front { columns, children, .. } = self.fronts[f].clone();
            let mut below = Vec::new();
            // What couples with a column and is eliminated later stays later: it is above it in the tree.
            let own = &self.order[columns.clone()];
            let of_columns = own.iter().flat_map(|&column| pattern.rows(column)).map(|&row| place[row]);
            let of_children = self.children[children.clone()].iter().flat_map(|&child| &rows[child]).copied();
            for row in of_columns.chain(of_children) {
                let i = row as usize;
                if i >= columns.end && seen_in[i] != f {
                    seen_in[i] = f;
                    below.push(row);
                }
            }
            below.sort_unstable();
            for (k, i) in columns.clone().chain(below.iter().map(|&row| row as usize)).enumerate() {
                local[i] = k;
            }
            for &child in &self.children[children] {
                let begin = self.runs.len();
                let places = std::mem::take(&mut rows[child]).into_iter().map(|row| local[row as usize]);
                join(&mut self.runs, places.enumerate());
                self.fronts[child].runs = begin..self.runs.len();
            }
            let height = columns.len() + below.len();
            let begin = self.entries.len();
            let places = own.iter().enumerate().flat_map(|(k, &column)| {
                let slots = pattern.col_ptr()[column]..;
                let (place, local) = (&place, &local);
                slots.zip(pattern.rows(column)).map(move |(slot, &row)| (slot, k * height + local[place[row] as usize]))
            });
            join(&mut self.entries, places);
            let front = &mut self.fronts[f];
            front.below = below.len();
            front.entries = begin..self.entries.len();
            (front.factor, front.vector) = (factor, vector);
            factor += front.size();
            vector += height;
            rows[f] = below;
        }
    }

    /// Gives each update a place in the working memory.
    fn plan(&mut self) {
        let mut memory = Memory::default();
        self.regions = vec![0];
        let mut results = Vec::new();
        for k in 1..self.subtrees.len() {
            let mut own = Memory { blocks: Vec::new(), begin: memory.end, end: memory.end };
            for f in self.subtrees[k - 1]..self.subtrees[k] {
                self.place_update(f, &mut own);
            }
            results.extend(own.blocks);
            memory.end = own.end;
            self.regions.push(memory.end);
        }
        memory.blocks = results;
        for f in self.top() {
            self.place_update(f, &mut memory);
        }
        self.workspace = memory.end;
    }

    fn place_update(&mut self, f: usize, memory: &mut Memory) {
        let front = &mut self.fronts[f];
        front.update = memory.take(front.workspace());
        memory.shrink(front.update, front.below * front.below);
        for &child in &self.children[self.fronts[f].children.clone()] {
            memory.shrink(self.fronts[child].update, 0);
        }
    }
}

/// Joins pairs in which both numbers grow by one to runs.
fn join(runs: &mut Vec<Run>, pairs: impl Iterator<Item = (usize, usize)>) {
    let begin = runs.len();
    for (from, to) in pairs {
        let (from, to) = (from as u32, to as u32);
        match runs[begin..].last_mut() {
            Some(run) if run.from + run.length == from && run.to + run.length == to => run.length += 1,
            _ => runs.push(Run { from, to, length: 1 }),
        }
    }
}

/// Blocks of a memory that are in use, sorted.
#[derive(Default)]
struct Memory {
    blocks: Vec<Range<usize>>,
    begin: usize,
    end: usize,
}

impl Memory {
    /// Takes the first gap that is large enough.
    fn take(&mut self, size: usize) -> usize {
        let mut begin = self.begin;
        let mut k = 0;
        while let Some(block) = self.blocks.get(k)
            && block.start < begin + size
        {
            begin = block.end;
            k += 1;
        }
        self.blocks.insert(k, begin..begin + size);
        self.end = self.end.max(begin + size);
        begin
    }

    /// Keeps so many numbers of the block that begins there.
    fn shrink(&mut self, begin: usize, size: usize) {
        let k = self.blocks.iter().position(|block| block.start == begin && !block.is_empty());
        let Some(k) = k else { return };
        if size == 0 {
            self.blocks.remove(k);
        } else {
            self.blocks[k].end = begin + size;
        }
    }
}

/// A tree of sets of columns.
struct Supernodes {
    columns: Vec<Vec<usize>>,
    below: Vec<usize>,
    parent: Vec<Option<usize>>,
    zeros: Vec<usize>,
}

impl Supernodes {
    /// Chains of groups of columns with the same rows.
    fn new(elimination: &Elimination) -> Self {
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
    fn merge(&mut self) {
        // A parent's first column comes after its children's, so children are met first.
        for child in 0..self.columns.len() {
            let Some(parent) = self.parent[child] else { continue };
            let (k, m) = (self.columns[child].len(), self.below[child]);
            let (kp, mp) = (self.columns[parent].len(), self.below[parent]);
            let zeros = self.zeros[child] + self.zeros[parent] + k * (kp + mp - m);
            let size = (k + kp) * (k + kp + 1) / 2 + (k + kp) * mp;
            let most = match k + kp {
                0..=16 => 0.5,
                17..=48 => 0.25,
                49..=96 => 0.1,
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
    fn arrange(self, pattern: &Pattern) -> Tree {
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
            workspace: 0,
            regions: Vec::new(),
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
