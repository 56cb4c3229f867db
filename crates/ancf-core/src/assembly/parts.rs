//! The model cut into parts, each a task of its own: nodes that follow each other in the order of elimination, and the
//! elements of which one of these nodes is eliminated first.
//!
//! The cut depends on the mesh alone, so sums over parts have the same bits on any number of threads. In nested dissection
//! nodes that follow each other lie side by side; the elements of a part then share few nodes with other parts.

use std::ops::Range;

use super::columns::Columns;
use super::numbering::Numbering;

/// Models with at most so many nodes are one part: sharing out less work takes longer than doing it.
const FEW: usize = 128;

/// Least and most nodes of a part otherwise: enough elements for the lanes, and columns that stay in the cache of a core.
const NODES: [usize; 2] = [64, 256];

/// The number of parts wanted, if their sizes allow: several for each thread, so that none waits for long.
const WANTED: usize = 32;

/// Consecutive nodes, and the elements that begin there.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// The places of its nodes in the order of elimination.
    pub nodes: Range<usize>,
    /// Its elements of each block.
    pub elements: Vec<Vec<u32>>,
    /// For each of these, block after block, where its tangent goes.
    pub slots: Vec<Slots>,
    /// The later nodes of its elements.
    pub border: Vec<Border>,
    /// Number of entries in the columns of these, and of their forces.
    pub border_size: [usize; 2],
    /// The nodes of this part that are on the border of earlier ones.
    pub shares: Vec<Share>,
}

/// Where the entries of an element go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slots {
    /// The nodes at its corners.
    pub corners: [Corner; 4],
    /// For each pair of corners `c < r`, at `c + r (r - 1) / 2`, the rows of the later node in the columns of the earlier
    /// one, counted from the end of the diagonal block.
    pub offsets: [u32; 6],
}

/// A node of an element, with what its sums need of its columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Its place in the order of elimination.
    pub place: u32,
    /// Entries of the first of its columns.
    pub length: u32,
    /// Number of its free coordinates.
    pub free: u8,
    /// Whether it belongs to the part, not to its border.
    pub inside: bool,
    /// Where its columns and its forces begin among those of the part or of its border.
    pub first: [u32; 2],
}

/// A later node, whose columns and forces the part sums apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    /// Its place in the order of elimination.
    pub place: usize,
    /// Where its columns and its forces begin among those of the border.
    pub first: [usize; 2],
}

/// What an earlier part adds to a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    /// The earlier part.
    pub part: usize,
    /// Its number for the node.
    pub border: usize,
}

impl Part {
    /// Cuts a model.
    pub fn cut(numbering: &Numbering, columns: &Columns) -> Vec<Self> {
        let nodes = numbering.order.len();
        let size = if nodes <= FEW { FEW } else { (nodes / WANTED).clamp(NODES[0], NODES[1]) };
        let blocks = numbering.cells.len();
        let mut parts: Vec<_> = (0..nodes)
            .step_by(size)
            .map(|first| Self {
                nodes: first..(first + size).min(nodes),
                elements: vec![Vec::new(); blocks],
                slots: Vec::new(),
                border: Vec::new(),
                border_size: [0; 2],
                shares: Vec::new(),
            })
            .collect();
        for (block, cells) in numbering.cells.iter().enumerate() {
            let places = |element: u32| cells[element as usize].map(|node| numbering.place[node]);
            for element in 0..cells.len() as u32 {
                let first = places(element).into_iter().min().expect("four corners");
                parts[first / size].elements[block].push(element);
            }
            // Elements that share nodes follow each other.
            for part in &mut parts {
                part.elements[block].sort_by_cached_key(|&element| {
                    let mut places = places(element);
                    places.sort_unstable();
                    places
                });
            }
        }
        for p in 0..parts.len() {
            parts[p].connect(numbering, columns);
            for border in 0..parts[p].border.len() {
                let owner = parts[p].border[border].place / size;
                parts[owner].shares.push(Share { part: p, border });
            }
        }
        parts
    }

    /// Finds the border and the places of the entries of all elements.
    fn connect(&mut self, numbering: &Numbering, columns: &Columns) {
        let cells: Vec<[usize; 4]> = (self.elements.iter().zip(&numbering.cells))
            .flat_map(|(elements, cells)| elements.iter().map(|&e| cells[e as usize].map(|n| numbering.place[n])))
            .collect();
        let mut later: Vec<_> = cells.iter().flatten().copied().filter(|place| *place >= self.nodes.end).collect();
        later.sort_unstable();
        later.dedup();
        for &place in &later {
            self.border.push(Border { place, first: self.border_size });
            let column = &columns.of[place];
            self.border_size[0] += column.entries();
            self.border_size[1] += column.forces.len();
        }
        let corner = |place: usize| {
            let column = &columns.of[place];
            let start = &columns.of[self.nodes.start];
            let (inside, first) = match later.binary_search(&place) {
                Ok(i) => (false, self.border[i].first),
                Err(_) => (true, [column.start - start.start, column.forces.start - start.forces.start]),
            };
            let (length, free) = (column.length as u32, column.free.len() as u8);
            Corner { place: place as u32, length, free, inside, first: first.map(|first| first as u32) }
        };
        self.slots = cells
            .iter()
            .map(|places| {
                let mut offsets = [0; 6];
                for r in 1..4 {
                    for c in 0..r {
                        let (early, late) = (places[c].min(places[r]), places[c].max(places[r]));
                        offsets[c + r * (r - 1) / 2] = columns.offset(early, late);
                    }
                }
                Slots { corners: places.map(corner), offsets }
            })
            .collect();
    }
}
