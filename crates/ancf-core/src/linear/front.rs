//! Elimination of the columns of one front: dense L D L^T of its top, and the update that this makes below.

use std::mem::MaybeUninit;
use std::ops::Range;

use faer::dyn_stack::MemStack;
use faer::linalg::cholesky::ldlt::factor::cholesky_in_place;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::tree::Run;
use crate::lanes::{add, arch};

/// Columns that are eliminated at once.
pub(super) const BLOCK: usize = 128;
/// Width of the columns of tiles in which products are formed; of the tiles on the diagonal half is of no use.
const TILE: usize = 24;
/// The registers by which updates are added: two of four numbers and one number are the rows of a node with three vectors.
const RUN: usize = 4;
/// Sides of the tiles of fronts whose tiles are shared among threads.
const SHARED_TILE: usize = 192;

/// Eliminates the columns of a front and forms its update -L D L^T, (below, below), of which the lower triangle counts.
///
/// `panel` holds its columns, (rows, columns), of which the lower trapezium counts, and receives L and D; `scratch` has
/// room for a block of columns. Tiles are the same on any number of threads, so are the bits. Stops at a pivot that is
/// zero or not finite, which stays in its place, and says so.
pub(super) fn eliminate(
    mut panel: MatMut<'_, f64>,
    mut update: MatMut<'_, f64>,
    scratch: &mut [f64],
    shared: bool,
) -> Result<(), usize> {
    let (rows, columns) = panel.shape();
    for start in (0..columns).step_by(BLOCK) {
        let width = BLOCK.min(columns - start);
        let active = panel.rb_mut().submatrix_mut(start, start, rows - start, columns - start);
        let (block, trailing) = active.split_at_col_mut(width);
        let (mut diagonal, mut below) = block.split_at_row_mut(width);
        let mut memory = [MaybeUninit::uninit(); 8 * BLOCK + 256];
        let memory = MemStack::new(&mut memory);
        cholesky_in_place(diagonal.rb_mut(), Default::default(), Par::Seq, memory, Default::default()).map_err(
            |error| {
                let faer::linalg::cholesky::ldlt::factor::LdltError::ZeroPivot { index } = error;
                start + index
            },
        )?;
        let height = below.nrows();
        let mut scaled = MatMut::from_column_major_slice_mut(&mut scratch[..height * width], height, width);
        if shared {
            let tiles: Vec<_> = row_tiles(below.rb_mut()).into_iter().zip(row_tiles(scaled.rb_mut())).collect();
            tiles.into_par_iter().for_each(|(below, scaled)| divide(diagonal.rb(), below, scaled));
        } else {
            divide(diagonal.rb(), below.rb_mut(), scaled.rb_mut());
        }
        let (scaled, lower) = (scaled.rb(), below.rb());
        let rest = trailing.ncols();
        let (_, trailing) = trailing.split_at_row_mut(width);
        downdate(trailing, Accum::Add, scaled, lower, shared);
        let accumulate = if start == 0 { Accum::Replace } else { Accum::Add };
        let (scaled, lower) = (scaled.split_at_row(rest).1, lower.split_at_row(rest).1);
        downdate(update.rb_mut(), accumulate, scaled, lower, shared);
    }
    Ok(())
}

/// Turns what is below the factorised diagonal block into L, and `scaled` into L D.
fn divide(diagonal: MatRef<'_, f64>, mut below: MatMut<'_, f64>, mut scaled: MatMut<'_, f64>) {
    solve_unit_lower_triangular_in_place(diagonal, below.rb_mut().transpose_mut(), Par::Seq);
    for j in 0..diagonal.ncols() {
        let inverse = 1.0 / diagonal[(j, j)];
        let below = below.rb_mut().col_mut(j).try_as_col_major_mut().expect("columns").as_slice_mut();
        let scaled = scaled.rb_mut().col_mut(j).try_as_col_major_mut().expect("columns").as_slice_mut();
        for (below, scaled) in below.iter_mut().zip(scaled) {
            *scaled = *below;
            *below *= inverse;
        }
    }
}

/// Subtracts (L D) L^T from the lower trapezium of `target`, or sets it to that product.
fn downdate(target: MatMut<'_, f64>, accumulate: Accum, scaled: MatRef<'_, f64>, lower: MatRef<'_, f64>, shared: bool) {
    let columns = target.ncols();
    let mut tiles = Vec::new();
    let mut rest = target;
    let side = if shared { SHARED_TILE } else { TILE };
    for start in (0..columns).step_by(side) {
        let width = side.min(columns - start);
        let (tile, others) = rest.split_at_col_mut(width);
        let (_, tile) = tile.split_at_row_mut(start);
        let right = lower.subrows(start, width).transpose();
        if shared {
            let height = scaled.nrows() - start;
            let rows = (start..start + height).step_by(side);
            tiles.extend(row_tiles(tile).into_iter().zip(rows).map(|(tile, row)| (tile, row, right)));
        } else {
            let left = scaled.subrows(start, scaled.nrows() - start);
            matmul(tile, accumulate, left, right, -1.0, Par::Seq);
        }
        rest = others;
    }
    tiles.into_par_iter().for_each(|(tile, row, right)| {
        let left = scaled.subrows(row, tile.nrows());
        matmul(tile, accumulate, left, right, -1.0, Par::Seq);
    });
}

/// Cuts a matrix into pieces of rows.
fn row_tiles(matrix: MatMut<'_, f64>) -> Vec<MatMut<'_, f64>> {
    let mut tiles = Vec::with_capacity(matrix.nrows() / SHARED_TILE + 1);
    let mut rest = matrix;
    while rest.nrows() > 0 {
        let height = SHARED_TILE.min(rest.nrows());
        let (tile, others) = rest.split_at_row_mut(height);
        tiles.push(tile);
        rest = others;
    }
    tiles
}

/// Adds the update of a child, (below, below), to the columns `columns` of a front, of which `target` holds the rows
/// from `top` on, column by column; `runs` are the places of the child's rows.
pub(super) fn extend_add(target: &mut [f64], top: usize, columns: Range<usize>, child: &[f64], runs: &[Run]) {
    arch(RUN).dispatch(ExtendAdd { target, top, columns, child, runs });
}

/// The updates of a child to a front.
struct ExtendAdd<'a> {
    target: &'a mut [f64],
    top: usize,
    columns: Range<usize>,
    child: &'a [f64],
    runs: &'a [Run],
}

impl WithSimd for ExtendAdd<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { target, top, columns, child, runs } = self;
        let height = target.len() / columns.len();
        let below = runs.last().map_or(0, |run| (run.from + run.length) as usize);
        for (k, run) in runs.iter().enumerate() {
            let (from, to) = (run.from as usize, run.to as usize);
            let first = to.max(columns.start);
            for column in first..columns.end.min(to + run.length as usize) {
                let own = from + column - to;
                let target = &mut target[(column - columns.start) * height..][..height];
                let child = &child[own * below..][..below];
                for run in &runs[k..] {
                    let start = own.max(run.from as usize);
                    let end = (run.from + run.length) as usize;
                    let place = run.to as usize + start - run.from as usize - top;
                    let child = &child[start..end];
                    add(simd, &mut target[place..][..child.len()], child);
                }
            }
        }
    }
}
