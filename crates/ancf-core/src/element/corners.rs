//! The symmetry of a rectangle: sums and differences over its corners in place of the corners themselves.
//!
//! Shape functions of one kind (those of `r`, say) at the four corners A, B, C, D are mirror images of each other. Their
//! sums and differences are even or odd in x and in y, so their derivatives contain fewer monomials and vanish more
//! often: at the sample points, two of three table entries of `thin36` are zero. Forces and tangents made with these
//! functions return to the nodal vectors with a few additions.

use std::array;
use std::ops::{Add, Sub};

/// What can be added and subtracted.
pub(crate) trait Number: Copy + Add<Output = Self> + Sub<Output = Self> {}

impl<T: Copy + Add<Output = T> + Sub<Output = T>> Number for T {}

/// The sum over the corners and the differences along x, along y and along both.
#[inline(always)]
fn combine<T: Number>([a, b, c, d]: [T; 4]) -> [T; 4] {
    let (right, left) = (b + c, a + d);
    let (at_right, at_left) = (c - b, d - a);
    [left + right, right - left, at_right + at_left, at_right - at_left]
}

/// The transpose of [`combine`]: each corner's share of the quantities conjugate to sum and differences. It is four
/// times the inverse, too.
#[inline(always)]
pub(crate) fn distribute<T: Number>([sum, x, y, xy]: [T; 4]) -> [T; 4] {
    let (right, left) = (sum + x, sum - x);
    let (at_right, at_left) = (y + xy, y - xy);
    [left - at_left, right - at_right, right + at_right, left + at_left]
}

/// [`combine`] in place, for each component of the nodal vectors of each kind; they are numbered corner by corner.
#[inline(always)]
pub(crate) fn combine_all<T: Number, const M: usize, const N: usize>(vectors: &mut [[T; M]; N]) {
    replace_all(vectors, combine);
}

/// [`distribute`] in place, for each component of the nodal vectors of each kind.
#[inline(always)]
pub(crate) fn distribute_all<T: Number, const M: usize, const N: usize>(combined: &mut [[T; M]; N]) {
    replace_all(combined, distribute);
}

#[inline(always)]
fn replace_all<T: Number, const M: usize, const N: usize>(vectors: &mut [[T; M]; N], by: impl Fn([T; 4]) -> [T; 4]) {
    let kinds = N / 4;
    for kind in 0..kinds {
        for i in 0..M {
            // Spelled out: a closure over the corners is called where `T` is a register.
            let [a, b, c, d] = [kind, kinds + kind, 2 * kinds + kind, 3 * kinds + kind];
            let parts = by([vectors[a][i], vectors[b][i], vectors[c][i], vectors[d][i]]);
            [vectors[a][i], vectors[b][i], vectors[c][i], vectors[d][i]] = parts;
        }
    }
}

/// The shape functions that belong to sum and differences, from those of the corners; rounding left of what is zero by
/// symmetry is removed. `units` has that of each kind of function: sides of the element, for those of gradients.
pub(crate) fn functions<const N: usize>(row: &[f64; N], units: &[f64; 4]) -> [f64; N] {
    let unit = |a: usize| units[a % (N / 4)];
    let largest = (0..N).map(|a| row[a].abs() / unit(a)).fold(0.0, f64::max);
    let mut combined = row.map(|x| [x]);
    combine_all(&mut combined);
    array::from_fn(|a| {
        let [x] = combined[a];
        if x.abs() / unit(a) < 1e-13 * largest { 0.0 } else { 0.25 * x }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distribute_is_the_transpose_of_combine_and_four_times_its_inverse() {
        let (u, v) = ([1.0, -2.5, 0.25, 7.0], [3.0, 0.5, -4.0, 2.0]);
        let dot = |a: [f64; 4], b: [f64; 4]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        assert_eq!(dot(combine(u), v), dot(u, distribute(v)));
        assert_eq!(distribute(combine(u)), u.map(|x| 4.0 * x));
        assert_eq!(combine(u), [5.75, -10.25, 8.75, -3.25]);
    }
}
