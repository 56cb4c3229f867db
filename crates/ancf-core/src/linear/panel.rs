//! Solution with the dense columns of one front, four at a time.
//!
//! A panel holds the columns of L one after the other, (rows, columns), with D on the diagonal; what is above is of no
//! use. Three vectors are handled together, since a vector in space has three components: columns are read once for all.

use pulp::{Arch, Simd, WithSimd};

/// Columns that are handled in one pass over a vector.
const WIDTH: usize = 4;

/// Solves with L: the first numbers of each vector of `x`, (count, rows), are replaced by the solution, and what it makes of
/// the rows below is subtracted from the rest.
pub(super) fn forward(arch: Arch, panel: &[f64], x: &mut [f64], rows: usize) {
    let mut threes = x.chunks_exact_mut(3 * rows);
    for x in &mut threes {
        arch.dispatch(Forward { panel, x: parts::<3>(x, rows) });
    }
    for x in threes.into_remainder().chunks_exact_mut(rows) {
        arch.dispatch(Forward { panel, x: [x] });
    }
}

/// Divides by D and solves with L^T: the first numbers of each vector are replaced by the solution, the rest is known.
pub(super) fn backward(arch: Arch, panel: &[f64], x: &mut [f64], rows: usize) {
    let mut threes = x.chunks_exact_mut(3 * rows);
    for x in &mut threes {
        arch.dispatch(Backward { panel, x: parts::<3>(x, rows) });
    }
    for x in threes.into_remainder().chunks_exact_mut(rows) {
        arch.dispatch(Backward { panel, x: [x] });
    }
}

/// The vectors in an array.
fn parts<const R: usize>(x: &mut [f64], rows: usize) -> [&mut [f64]; R] {
    let mut vectors = x.chunks_exact_mut(rows);
    std::array::from_fn(|_| vectors.next().expect("as many vectors as the array is long"))
}

struct Forward<'a, const R: usize> {
    panel: &'a [f64],
    x: [&'a mut [f64]; R],
}

impl<const R: usize> WithSimd for Forward<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { panel, mut x } = self;
        let rows = x[0].len();
        let columns = panel.len() / rows;
        for start in (0..columns).step_by(WIDTH) {
            let end = columns.min(start + WIDTH);
            let mut factors = [[0.0; WIDTH]; R];
            for j in start..end {
                let column = &panel[j * rows..(j + 1) * rows];
                for r in 0..R {
                    factors[r][j - start] = x[r][j];
                    for i in j + 1..end {
                        x[r][i] -= column[i] * factors[r][j - start];
                    }
                }
            }
            let rest = x.each_mut().map(|x| &mut x[end..]);
            if end - start == WIDTH {
                subtract(simd, rest, below(panel, rows, start, end), factors);
            } else {
                let mut rest = rest;
                for j in start..end {
                    let factors = factors.each_ref().map(|factors| [factors[j - start]]);
                    let column = [&panel[j * rows + end..(j + 1) * rows]];
                    subtract(simd, rest.each_mut().map(|x| &mut **x), column, factors);
                }
            }
        }
    }
}

struct Backward<'a, const R: usize> {
    panel: &'a [f64],
    x: [&'a mut [f64]; R],
}

impl<const R: usize> WithSimd for Backward<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { panel, x } = self;
        let rows = x[0].len();
        let columns = panel.len() / rows;
        for j in 0..columns {
            let inverse = 1.0 / panel[j * rows + j];
            for r in 0..R {
                x[r][j] *= inverse;
            }
        }
        for start in (0..columns).step_by(WIDTH).rev() {
            let end = columns.min(start + WIDTH);
            let rest = x.each_ref().map(|x| &x[end..]);
            let mut sums = [[0.0; WIDTH]; R];
            if end - start == WIDTH {
                sums = products(simd, rest, below(panel, rows, start, end));
            } else {
                for j in start..end {
                    let products = products(simd, rest, [&panel[j * rows + end..(j + 1) * rows]]);
                    for r in 0..R {
                        sums[r][j - start] = products[r][0];
                    }
                }
            }
            for j in (start..end).rev() {
                for r in 0..R {
                    let mut sum = sums[r][j - start];
                    for i in j + 1..end {
                        sum += panel[j * rows + i] * x[r][i];
                    }
                    x[r][j] -= sum;
                }
            }
        }
    }
}

/// The rows from `end` on of the columns from `start` on.
#[inline(always)]
fn below(panel: &[f64], rows: usize, start: usize, end: usize) -> [&[f64]; WIDTH] {
    let mut columns = [panel; WIDTH];
    for j in 0..WIDTH {
        columns[j] = &panel[(start + j) * rows + end..(start + j + 1) * rows];
    }
    columns
}

/// Subtracts from each vector a sum of columns, each times a factor.
#[inline(always)]
fn subtract<S: Simd, const N: usize, const R: usize>(
    simd: S,
    x: [&mut [f64]; R],
    columns: [&[f64]; N],
    factors: [[f64; N]; R],
) {
    let length = columns[0].len() / S::F64_LANES;
    let mut whole = [S::as_simd_f64s(columns[0]).0; N];
    let mut tails = [S::as_simd_f64s(columns[0]).1; N];
    let mut splat = [[simd.splat_f64s(0.0); N]; R];
    for j in 0..N {
        (whole[j], tails[j]) = S::as_simd_f64s(columns[j]);
        whole[j] = &whole[j][..length];
        for r in 0..R {
            splat[r][j] = simd.splat_f64s(-factors[r][j]);
        }
    }
    let mut x = x.map(|x| S::as_mut_simd_f64s(x));
    for i in 0..length {
        for r in 0..R {
            let mut sum = x[r].0[i];
            for j in 0..N {
                sum = simd.mul_add_e_f64s(whole[j][i], splat[r][j], sum);
            }
            x[r].0[i] = sum;
        }
    }
    for (r, (_, x)) in x.iter_mut().enumerate() {
        for (i, x) in x.iter_mut().enumerate() {
            for j in 0..N {
                *x -= tails[j][i] * factors[r][j];
            }
        }
    }
}

/// The products of each vector with some columns.
#[inline(always)]
fn products<S: Simd, const N: usize, const R: usize>(simd: S, x: [&[f64]; R], columns: [&[f64]; N]) -> [[f64; N]; R] {
    let length = columns[0].len() / S::F64_LANES;
    let mut whole = [S::as_simd_f64s(columns[0]).0; N];
    let mut tails = [S::as_simd_f64s(columns[0]).1; N];
    for j in 0..N {
        (whole[j], tails[j]) = S::as_simd_f64s(columns[j]);
        whole[j] = &whole[j][..length];
    }
    let x = x.map(|x| S::as_simd_f64s(x));
    let mut sums = [[simd.splat_f64s(0.0); N]; R];
    for i in 0..length {
        for r in 0..R {
            let x = x[r].0[i];
            for j in 0..N {
                sums[r][j] = simd.mul_add_e_f64s(whole[j][i], x, sums[r][j]);
            }
        }
    }
    let mut products = [[0.0; N]; R];
    for r in 0..R {
        for j in 0..N {
            products[r][j] = simd.reduce_sum_f64s(sums[r][j]);
            for (i, x) in x[r].1.iter().enumerate() {
                products[r][j] += tails[j][i] * x;
            }
        }
    }
    products
}
