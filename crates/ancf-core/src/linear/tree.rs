//! The assembly tree of a factorisation: its fronts, where their rows and entries are, and their working memory.

use std::ops::Range;

use super::elimination::Elimination;
use super::supernodes::Supernodes;
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
    /// Where the memory begins that it needs while it is eliminated.
    pub place: usize,
    /// Where its update to the parent begins.
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

    /// Numbers of its update.
    pub fn update_size(&self) -> usize {
        self.below * self.below
    }

    /// Numbers of a scaled copy of a block of columns.
    pub fn scratch(&self) -> usize {
        self.rows() * self.columns.len().min(front::BLOCK)
    }

    /// Working memory while it is eliminated, its update first.
    pub fn workspace(&self) -> usize {
        self.update_size() + self.scratch()
    }
}

/// Operations to eliminate `columns` columns with `below` rows more.
pub(super) fn work(columns: usize, below: usize) -> f64 {
    let (k, m) = (columns as f64, below as f64);
    k * m * m + k * k * m + k * k * k / 3.0
}

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
    /// Numbers in the working memory of a subtree.
    pub stack: usize,
    /// Numbers in the working memory of the top, which begins with the updates of the subtrees.
    pub shared: usize,
    /// Where the update of each subtree begins there, and the end of the last one.
    pub results: Vec<usize>,
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

    /// Where the parts of a vector of these fronts begin.
    pub fn split(&self) -> usize {
        self.fronts.get(self.top().start).map_or(self.vector(), |front| front.vector)
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

    /// Gives each update a place: in the stack of the thread that eliminates a subtree, and those that subtrees hand on and
    /// all above in memory that the threads share.
    fn plan(&mut self) {
        let mut memory = Memory::default();
        self.results = vec![0];
        for k in 1..self.subtrees.len() {
            let root = self.subtrees[k] - 1;
            let mut stack = Memory::default();
            for f in self.subtrees[k - 1]..root {
                self.place_update(f, self.fronts[f].workspace(), self.fronts[f].update_size(), &mut stack);
            }
            self.place_update(root, self.fronts[root].scratch(), 0, &mut stack);
            self.stack = self.stack.max(stack.end);
            let size = self.fronts[root].update_size();
            self.fronts[root].update = if size > 0 { memory.take(size) } else { memory.end };
            self.results.push(memory.end);
        }
        for f in self.top() {
            self.place_update(f, self.fronts[f].workspace(), self.fronts[f].update_size(), &mut memory);
        }
        self.shared = memory.end;
    }

    /// Places a front that needs so much memory while it is eliminated, and so much until it has been added to its parent.
    fn place_update(&mut self, f: usize, size: usize, kept: usize, memory: &mut Memory) {
        let place = memory.take(size);
        memory.shrink(place, kept);
        (self.fronts[f].place, self.fronts[f].update) = (place, place);
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
    end: usize,
}

impl Memory {
    /// Takes the first gap that is large enough.
    fn take(&mut self, size: usize) -> usize {
        let mut begin = 0;
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
