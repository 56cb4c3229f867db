//! Tangents of elements added to the columns of their nodes.

use pulp::{Simd, WithSimd};

use crate::lanes::{Transpose, add};
use crate::strain::packed;

use super::columns::Columns;
use super::parts::{Corner, Slots};

/// Elements whose tangents are added, with the instruction set that the processor has.
pub(super) struct Tangents<'a> {
    pub columns: &'a Columns,
    /// Where the tangents go.
    pub slots: &'a [Slots],
    /// The tangents, one after the other, in the order of [`tangent_place`](crate::element::tangent_place).
    pub tangents: &'a [f64],
    /// The columns of the part.
    pub values: &'a mut [f64],
    /// The columns of its border.
    pub border: &'a mut [f64],
}

impl WithSimd for Tangents<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { columns, slots, tangents, values, border } = self;
        for (slots, tangent) in slots.iter().zip(tangents.chunks_exact(tangents.len() / slots.len())) {
            let pairs = tangent.len() / 10;
            for r in 0..4 {
                for c in 0..=r {
                    let pair = &tangent[packed(c, r) * pairs..][..pairs];
                    let [first, second] = [&slots.corners[c], &slots.corners[r]];
                    let transposed = second.place < first.place;
                    let (early, late) = if transposed { (second, first) } else { (first, second) };
                    let target = if early.inside { &mut *values } else { &mut *border };
                    let target = &mut target[early.first[0] as usize..];
                    let offset = (r != c).then(|| slots.offsets[c + r * r.saturating_sub(1) / 2] as usize);
                    match (pairs, early.free, late.free) {
                        (81, 9, 9) => add_whole::<S, 9>(simd, early, offset, pair, transposed, target),
                        (144, 12, 12) => add_whole::<S, 12>(simd, early, offset, pair, transposed, target),
                        _ => add_free(columns, [early, late], offset, pair, transposed, target),
                    }
                }
            }
        }
    }
}

/// Adds the entries that a pair of corners has in the columns of the earlier node, none of whose coordinates, and none of
/// the later node's, are fixed. `offset` is where the rows of the later node begin below the diagonal block; none for the
/// diagonal block itself.
#[inline(always)]
fn add_whole<S: Simd, const SIDE: usize>(
    simd: S,
    early: &Corner,
    offset: Option<usize>,
    pair: &[f64],
    transposed: bool,
    target: &mut [f64],
) {
    let pair: &[[f64; SIDE]; SIDE] = pair.as_chunks().0.try_into().expect("a square");
    let length = early.length as usize;
    match offset.map(|offset| &mut target[SIDE + offset..]) {
        None => add_columns::<S, SIDE, true>(simd, length, pair, target),
        Some(below) if transposed => {
            add_columns::<S, SIDE, false>(simd, length, &Transpose::new(simd).square(pair), below);
        }
        Some(below) => add_columns::<S, SIDE, false>(simd, length, pair, below),
    }
}

/// Adds the columns of a block to those of a node, of which the first has `length` entries.
#[inline(always)]
fn add_columns<S: Simd, const SIDE: usize, const DIAGONAL: bool>(
    simd: S,
    length: usize,
    block: &[[f64; SIDE]; SIDE],
    mut target: &mut [f64],
) {
    for (j, column) in block.iter().enumerate() {
        let entries = target.first_chunk_mut::<SIDE>().expect("rows of the node");
        // What lies above the diagonal is zero, and may be added to the end of the column before; no more of it than fills
        // registers of four numbers.
        match SIDE - j {
            ..=4 if DIAGONAL => add(simd, &mut entries[SIDE - 4..], &column[SIDE - 4..]),
            ..=8 if DIAGONAL => add(simd, &mut entries[SIDE - 8..], &column[SIDE - 8..]),
            _ => add(simd, entries, column),
        }
        if j + 1 < SIDE {
            target = &mut target[length - j - 1..];
        }
    }
}

/// As [`add_whole`], where some coordinates of the nodes are fixed.
fn add_free(
    nodes: &Columns,
    [early, late]: [&Corner; 2],
    offset: Option<usize>,
    pair: &[f64],
    transposed: bool,
    target: &mut [f64],
) {
    let [column, other] = [early, late].map(|corner| &nodes.of[corner.place as usize]);
    let [columns, rows] = [column, other].map(|node| &nodes.free[node.free.clone()]);
    let [by_row, by_column] = if transposed { [pair.len().isqrt(), 1] } else { [1, pair.len().isqrt()] };
    for (j, &own) in columns.iter().enumerate() {
        let (begin, rows) = match offset {
            Some(offset) => (column.begin(j) + columns.len() - j + offset, rows),
            None => (column.begin(j), &rows[j..]),
        };
        for (sum, &row) in target[begin..].iter_mut().zip(rows) {
            *sum += pair[own as usize * by_column + row as usize * by_row];
        }
    }
}
