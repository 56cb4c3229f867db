//! Solution with the dense columns of one front, four at a time.
//!
//! `panel` holds the columns of L below each other, (rows, columns), with D on the diagonal; what is above is of no use.

use pulp::{Arch, Simd, WithSimd};

/// Columns that are handled in one pass over a vector.
const WIDTH: usize = 4;

/// Solves with L: the first numbers of `x`, (rows), are replaced by the solution, and what it makes of the rows below is
/// subtracted from the rest.
pub(super) fn forward(arch: Arch, panel: &[f64], x: &mut [f64]) {
    arch.dispatch(Forward { panel, x });
}

/// Divides by D and solves with L^T: the first numbers of `x`, (rows), are replaced by the solution, the rest is known.
pub(super) fn backward(arch: Arch, panel: &[f64], x: &mut [f64]) {
    arch.dispatch(Backward { panel, x });
}

struct Forward<'a> {
    panel: &'a [f64],
    x: &'a mut [f64],
}

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { panel, x } = self;
        let rows = x.len();
        let columns = panel.len() / rows;
        for start in (0..columns).step_by(WIDTH) {
            let end = columns.min(start + WIDTH);
            let (known, rest) = x.split_at_mut(end);
            let mut factors = [0.0; WIDTH];
            for j in start..end {
                let column = &panel[j * rows..(j + 1) * rows];
                factors[j - start] = known[j];
                for i in j + 1..end {
                    known[i] -= column[i] * known[j];
                }
            }
            if end - start == WIDTH {
                let mut columns = [&panel[..0]; WIDTH];
                for j in 0..WIDTH {
                    columns[j] = &panel[(start + j) * rows + end..(start + j + 1) * rows];
                }
                subtract(simd, rest, columns, factors);
            } else {
                for j in start..end {
                    subtract(simd, rest, [&panel[j * rows + end..(j + 1) * rows]], [factors[j - start]]);
                }
            }
        }
    }
}

struct Backward<'a> {
    panel: &'a [f64],
    x: &'a mut [f64],
}

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { panel, x } = self;
        let rows = x.len();
        let columns = panel.len() / rows;
        for (j, x) in x[..columns].iter_mut().enumerate() {
            *x /= panel[j * rows + j];
        }
        for start in (0..columns).step_by(WIDTH).rev() {
            let end = columns.min(start + WIDTH);
            let (unknown, rest) = x.split_at_mut(end);
            if end - start == WIDTH {
                let mut columns = [&panel[..0]; WIDTH];
                for j in 0..WIDTH {
                    columns[j] = &panel[(start + j) * rows + end..(start + j + 1) * rows];
                }
                let products = products(simd, rest, columns);
                for j in 0..WIDTH {
                    unknown[start + j] -= products[j];
                }
            } else {
                for j in start..end {
                    unknown[j] -= products(simd, rest, [&panel[j * rows + end..(j + 1) * rows]])[0];
                }
            }
            for j in (start..end).rev() {
                for i in j + 1..end {
                    unknown[j] -= panel[j * rows + i] * unknown[i];
                }
            }
        }
    }
}

/// Subtracts from a vector a sum of columns, each times its factor.
#[inline(always)]
fn subtract<S: Simd, const N: usize>(simd: S, x: &mut [f64], columns: [&[f64]; N], factors: [f64; N]) {
    let (x, x_tail) = S::as_mut_simd_f64s(x);
    let mut whole = [S::as_simd_f64s(columns[0]).0; N];
    let mut tails = [S::as_simd_f64s(columns[0]).1; N];
    let mut splat = [simd.splat_f64s(0.0); N];
    for j in 0..N {
        (whole[j], tails[j]) = S::as_simd_f64s(columns[j]);
        (whole[j], tails[j]) = (&whole[j][..x.len()], &tails[j][..x_tail.len()]);
        splat[j] = simd.splat_f64s(-factors[j]);
    }
    for (i, x) in x.iter_mut().enumerate() {
        let mut sum = *x;
        for j in 0..N {
            sum = simd.mul_add_e_f64s(whole[j][i], splat[j], sum);
        }
        *x = sum;
    }
    for (i, x) in x_tail.iter_mut().enumerate() {
        for j in 0..N {
            *x -= tails[j][i] * factors[j];
        }
    }
}

/// The products of a vector with some columns.
#[inline(always)]
fn products<S: Simd, const N: usize>(simd: S, x: &[f64], columns: [&[f64]; N]) -> [f64; N] {
    let (x, x_tail) = S::as_simd_f64s(x);
    let mut whole = [x; N];
    let mut tails = [x_tail; N];
    for j in 0..N {
        (whole[j], tails[j]) = S::as_simd_f64s(columns[j]);
        (whole[j], tails[j]) = (&whole[j][..x.len()], &tails[j][..x_tail.len()]);
    }
    let mut sums = [simd.splat_f64s(0.0); N];
    for (i, x) in x.iter().enumerate() {
        for j in 0..N {
            sums[j] = simd.mul_add_e_f64s(whole[j][i], *x, sums[j]);
        }
    }
    let mut products = [0.0; N];
    for j in 0..N {
        products[j] = simd.reduce_sum_f64s(sums[j]);
        for (i, x) in x_tail.iter().enumerate() {
            products[j] += tails[j][i] * x;
        }
    }
    products
}
