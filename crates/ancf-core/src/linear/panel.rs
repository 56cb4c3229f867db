//! Solution with the dense columns of one front, four at a time.
//!
//! A panel holds the columns of L one after the other, (rows, columns), with D on the diagonal; what is above is of no
//! use. One vector is handled by registers that run along it. Four vectors side by side, (rows, 4), are a register a row:
//! nothing is left over at the ends of short columns, and no register is summed.

use pulp::{Arch, Simd, WithSimd};

use crate::lanes;

/// Columns that are handled in one pass over a vector.
const WIDTH: usize = 4;

/// Vectors that are solved for side by side: the components of vectors in space, and one that is left empty.
pub(super) const FOUR: usize = 4;

/// The instruction set for one vector, or for four.
pub(super) fn arch<const W: usize>() -> Arch {
    if W == FOUR { lanes::arch(FOUR) } else { Arch::new() }
}

/// Solves with L: the first numbers of each vector of `x` are replaced by the solution, and what it makes of the rows below
/// is subtracted from the rest.
pub(super) fn forward<const W: usize>(arch: Arch, panel: &[f64], x: &mut [[f64; W]]) {
    arch.dispatch(Forward { panel, x });
}

/// Divides by D and solves with L^T: the first numbers of each vector are replaced by the solution, the rest is known.
pub(super) fn backward<const W: usize>(arch: Arch, panel: &[f64], x: &mut [[f64; W]]) {
    arch.dispatch(Backward { panel, x });
}

struct Forward<'a, const W: usize> {
    panel: &'a [f64],
    x: &'a mut [[f64; W]],
}

impl<const W: usize> WithSimd for Forward<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { panel, x } = self;
        let columns = panel.len() / x.len();
        for start in (0..columns).step_by(WIDTH) {
            match columns - start {
                1 => forward_block::<S, 1, W>(simd, panel, x, start),
                2 => forward_block::<S, 2, W>(simd, panel, x, start),
                3 => forward_block::<S, 3, W>(simd, panel, x, start),
                _ => forward_block::<S, WIDTH, W>(simd, panel, x, start),
            }
        }
    }
}

struct Backward<'a, const W: usize> {
    panel: &'a [f64],
    x: &'a mut [[f64; W]],
}

impl<const W: usize> WithSimd for Backward<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { panel, x } = self;
        let columns = panel.len() / x.len();
        for start in (0..columns).step_by(WIDTH).rev() {
            match columns - start {
                1 => backward_block::<S, 1, W>(simd, panel, x, start),
                2 => backward_block::<S, 2, W>(simd, panel, x, start),
                3 => backward_block::<S, 3, W>(simd, panel, x, start),
                _ => backward_block::<S, WIDTH, W>(simd, panel, x, start),
            }
        }
    }
}

/// Solves with `N` columns.
#[inline(always)]
fn forward_block<S: Simd, const N: usize, const W: usize>(simd: S, panel: &[f64], x: &mut [[f64; W]], start: usize) {
    let (square, below) = block::<N>(panel, x.len(), start);
    let (own, rest) = x[start..].split_first_chunk_mut::<N>().expect("columns are rows too");
    for j in 0..N {
        for i in j + 1..N {
            for w in 0..W {
                own[i][w] -= square[j][i] * own[j][w];
            }
        }
    }
    let rest = rest.as_flattened_mut();
    if W == FOUR {
        subtract_rows(simd, rest, below, own.as_flattened());
    } else {
        subtract(simd, rest, below, own.as_flattened());
    }
}

/// Divides by D and solves with `N` columns of L^T.
#[inline(always)]
fn backward_block<S: Simd, const N: usize, const W: usize>(simd: S, panel: &[f64], x: &mut [[f64; W]], start: usize) {
    let (square, below) = block::<N>(panel, x.len(), start);
    let (own, rest) = x[start..].split_first_chunk_mut::<N>().expect("columns are rows too");
    let rest = rest.as_flattened();
    let mut sums = [[0.0; W]; N];
    if W == FOUR {
        product_rows(simd, rest, below, sums.as_flattened_mut());
    } else {
        products(simd, rest, below, sums.as_flattened_mut());
    }
    for j in (0..N).rev() {
        let inverse = 1.0 / square[j][j];
        for w in 0..W {
            let mut sum = sums[j][w];
            for i in j + 1..N {
                sum += square[j][i] * own[i][w];
            }
            own[j][w] = own[j][w] * inverse - sum;
        }
    }
}

/// `N` columns from `start` on: their rows there, and those below.
#[inline(always)]
fn block<const N: usize>(panel: &[f64], rows: usize, start: usize) -> ([&[f64; N]; N], [&[f64]; N]) {
    let (mut square, mut below) = ([&[0.0; N]; N], [panel; N]);
    for j in 0..N {
        let column = &panel[(start + j) * rows + start..(start + j + 1) * rows];
        (square[j], below[j]) = column.split_first_chunk().expect("columns are rows too");
    }
    (square, below)
}

/// Subtracts from a vector a sum of columns, each times a factor.
#[inline(always)]
fn subtract<S: Simd, const N: usize>(simd: S, x: &mut [f64], columns: [&[f64]; N], factors: &[f64]) {
    let length = x.len() / S::F64_LANES;
    let (x, tail) = S::as_mut_simd_f64s(x);
    let mut sum = simd.partial_load_f64s(tail);
    let mut whole = [S::as_simd_f64s(columns[0]).0; N];
    let mut splat = [simd.splat_f64s(0.0); N];
    for j in 0..N {
        let tail;
        (whole[j], tail) = S::as_simd_f64s(columns[j]);
        whole[j] = &whole[j][..length];
        splat[j] = simd.splat_f64s(-factors[j]);
        sum = simd.mul_add_e_f64s(simd.partial_load_f64s(tail), splat[j], sum);
    }
    for i in 0..length {
        for j in 0..N {
            x[i] = simd.mul_add_e_f64s(whole[j][i], splat[j], x[i]);
        }
    }
    simd.partial_store_f64s(tail, sum);
}

/// The products of a vector with some columns.
#[inline(always)]
fn products<S: Simd, const N: usize>(simd: S, x: &[f64], columns: [&[f64]; N], products: &mut [f64]) {
    let length = x.len() / S::F64_LANES;
    let (x, tail) = S::as_simd_f64s(x);
    let last = simd.partial_load_f64s(tail);
    let mut whole = [x; N];
    let mut sums = [simd.splat_f64s(0.0); N];
    for j in 0..N {
        let tail;
        (whole[j], tail) = S::as_simd_f64s(columns[j]);
        whole[j] = &whole[j][..length];
        sums[j] = simd.mul_f64s(simd.partial_load_f64s(tail), last);
    }
    for i in 0..length {
        for j in 0..N {
            sums[j] = simd.mul_add_e_f64s(whole[j][i], x[i], sums[j]);
        }
    }
    for j in 0..N {
        products[j] = simd.reduce_sum_f64s(sums[j]);
    }
}

/// Subtracts from four vectors sums of columns, each times four factors.
#[inline(always)]
fn subtract_rows<S: Simd, const N: usize>(simd: S, x: &mut [f64], columns: [&[f64]; N], factors: &[f64]) {
    let (x, factors) = (S::as_mut_simd_f64s(x).0, S::as_simd_f64s(factors).0);
    let registers = FOUR / S::F64_LANES;
    let rows = x.len() / registers;
    let columns = first(columns, rows);
    for r in 0..registers {
        let mut negative = [simd.splat_f64s(0.0); N];
        for j in 0..N {
            negative[j] = simd.neg_f64s(factors[j * registers + r]);
        }
        for i in 0..rows {
            let mut sum = x[i * registers + r];
            for j in 0..N {
                sum = simd.mul_add_e_f64s(simd.splat_f64s(columns[j][i]), negative[j], sum);
            }
            x[i * registers + r] = sum;
        }
    }
}

/// The products of four vectors with some columns.
#[inline(always)]
fn product_rows<S: Simd, const N: usize>(simd: S, x: &[f64], columns: [&[f64]; N], products: &mut [f64]) {
    let (x, products) = (S::as_simd_f64s(x).0, S::as_mut_simd_f64s(products).0);
    let registers = FOUR / S::F64_LANES;
    let rows = x.len() / registers;
    let columns = first(columns, rows);
    for r in 0..registers {
        // Two sums for even and odd rows: one would wait for itself.
        let mut sums = [[simd.splat_f64s(0.0); N]; 2];
        for i in 0..rows / 2 {
            for odd in 0..2 {
                let x = x[(2 * i + odd) * registers + r];
                for j in 0..N {
                    sums[odd][j] = simd.mul_add_e_f64s(simd.splat_f64s(columns[j][2 * i + odd]), x, sums[odd][j]);
                }
            }
        }
        for j in 0..N {
            let mut sum = simd.add_f64s(sums[0][j], sums[1][j]);
            if rows % 2 == 1 {
                let last = simd.splat_f64s(columns[j][rows - 1]);
                sum = simd.mul_add_e_f64s(last, x[(rows - 1) * registers + r], sum);
            }
            products[j * registers + r] = sum;
        }
    }
}

/// The first numbers of columns, as many as the caller knows of.
#[inline(always)]
fn first<const N: usize>(mut columns: [&[f64]; N], rows: usize) -> [&[f64]; N] {
    for column in &mut columns {
        *column = &column[..rows];
    }
    columns
}
