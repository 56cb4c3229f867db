//! The stiffness of a square of sample points, put together from its moments.
//!
//! A block of the tangent is `sum_g t_a(g) F(g) t_b(g)` over the points g, summed over pairs of gradient vectors, with `t` the
//! table entries of two functions and `F` the stiffness with respect to the gradient vectors. The product of two table
//! entries is a polynomial in x and y of which parity and degree leave few coefficients (see `corners`), the same for all
//! elements. So `F` is turned into its moments `sum_g x^k y^l F(g)` once, and each block of the tangent is a combination
//! of few of them.

use nalgebra::DMatrix;
use pulp::Simd;

use crate::lanes::Lanes;
use crate::strain::{Block, packed};

/// Coefficients below this, relative to the largest of a product, are zero but for rounding.
const ROUNDING: f64 = 1e-12;

/// How the blocks of a tangent follow from the moments of the stiffness at `side` x `side` points.
#[derive(Clone, Debug)]
pub(super) struct Moments {
    side: usize,
    /// Of four points in a row, the place of the inner ones relative to the outer ones.
    inner: f64,
    /// Moments with their factors, block after block of the packed tangent.
    entries: Vec<(u32, f64)>,
    /// For each block where its entries end: first those of moments that count as they are, then of transposed ones.
    ends: Vec<[u32; 2]>,
}

impl Moments {
    /// For points in a square, whose coordinates along each side are `points`, in `[0, 1]` and symmetric;
    /// `symmetric` tells for which pairs of gradient vectors the stiffness is a symmetric matrix.
    pub fn new<const N: usize, const D: usize>(
        tables: &[[[f64; N]; D]],
        points: &[f64],
        symmetric: fn(usize, usize) -> bool,
    ) -> Self {
        let side = points.len();
        let outer = points[side - 1] - 0.5;
        let place = |i: usize| (points[i] - 0.5) / outer;
        let powers = DMatrix::from_fn(side, side, |i, k| place(i).powi(k as i32));
        let inverse = powers.try_inverse().expect("different points");
        let coefficients = |product: &dyn Fn(usize) -> f64| {
            let values = DMatrix::from_fn(side, side, |j, i| product(side * j + i));
            &inverse * values * inverse.transpose()
        };
        let (mut entries, mut ends) = (Vec::new(), Vec::new());
        for b in 0..N {
            for a in 0..=b {
                for transposed in [false, true] {
                    for e in 0..D {
                        for d in 0..=e {
                            let product = |d: usize, e: usize| move |g: usize| tables[g][d][a] * tables[g][e][b];
                            let (straight, mirrored) = (product(d, e), product(e, d));
                            let factors = match (transposed, d == e, symmetric(d, e)) {
                                (false, false, true) => coefficients(&|g| straight(g) + mirrored(g)),
                                (false, ..) => coefficients(&straight),
                                (true, false, false) => coefficients(&mirrored),
                                (true, ..) => continue,
                            };
                            let largest = factors.amax();
                            for l in 0..side {
                                for k in 0..side {
                                    let factor = factors[(l, k)];
                                    if factor.abs() > ROUNDING * largest {
                                        entries.push(((packed(d, e) * side * side + side * l + k) as u32, factor));
                                    }
                                }
                            }
                        }
                    }
                    ends.push(entries.len() as u32);
                }
            }
        }
        Self { side, inner: place(side / 2), entries, ends: ends.as_chunks().0.to_vec() }
    }

    /// Floating-point operations for points with so many gradient vectors, a fused multiply-add two.
    pub fn operations(&self, gradients: usize) -> usize {
        let line = [0, 0, 2, 3, 11][self.side];
        9 * gradients * (gradients + 1) / 2 * 2 * self.side * line + 18 * self.entries.len()
    }

    /// Adds the tangent that the stiffness of the points makes to `blocks`, or sets these if they are `EMPTY`; `forms` has
    /// the stiffness for each pair of gradient vectors, point by point, and is left with the moments.
    #[inline(always)]
    pub fn add<S: Simd, const N: usize, const EMPTY: bool>(
        &self,
        forms: &mut [Block<S>],
        blocks: &mut [[Block<S>; N]; N],
    ) {
        let none = [[forms[0][0][0].like(0.0); 3]; 3];
        for form in forms.chunks_exact_mut(self.side * self.side) {
            match self.side {
                2 => self.fold::<S, 2, 4>(form),
                3 => self.fold::<S, 3, 9>(form),
                _ => self.fold::<S, 4, 16>(form),
            }
        }
        let mut begin = 0;
        for b in 0..N {
            for a in 0..=b {
                let [straight, transposed] = self.ends[packed(a, b)].map(|end| end as usize);
                let mut sum = if EMPTY { none } else { blocks[b][a] };
                for &(moment, factor) in &self.entries[begin..straight] {
                    let moment = &forms[moment as usize];
                    for i in 0..3 {
                        for j in 0..3 {
                            sum[i][j] = moment[i][j].scale_add(factor, sum[i][j]);
                        }
                    }
                }
                for &(moment, factor) in &self.entries[straight..transposed] {
                    let moment = &forms[moment as usize];
                    for i in 0..3 {
                        for j in 0..3 {
                            sum[i][j] = moment[j][i].scale_add(factor, sum[i][j]);
                        }
                    }
                }
                begin = transposed;
                blocks[b][a] = sum;
            }
        }
    }

    /// Values at `SIDE` x `SIDE` points to their moments.
    #[inline(always)]
    fn fold<S: Simd, const SIDE: usize, const POINTS: usize>(&self, form: &mut [Block<S>]) {
        for i in 0..3 {
            for j in 0..3 {
                let mut values = [form[0][i][j]; POINTS];
                for g in 0..POINTS {
                    values[g] = form[g][i][j];
                }
                for row in 0..SIDE {
                    self.line::<S, SIDE, POINTS>(&mut values, SIDE * row, 1);
                }
                for column in 0..SIDE {
                    self.line::<S, SIDE, POINTS>(&mut values, column, SIDE);
                }
                for g in 0..POINTS {
                    form[g][i][j] = values[g];
                }
            }
        }
    }

    /// The same for the points of a row or a column: from `first` on, each `step` after the last. Points in mirror images
    /// of each other are summed for even powers, subtracted for odd ones.
    #[inline(always)]
    fn line<S: Simd, const SIDE: usize, const POINTS: usize>(
        &self,
        values: &mut [Lanes<S>; POINTS],
        first: usize,
        step: usize,
    ) {
        let (low, high) = (values[first], values[first + (SIDE - 1) * step]);
        let (even, odd) = (high + low, high - low);
        match SIDE {
            2 => {
                values[first] = even;
                values[first + step] = odd;
            }
            3 => {
                values[first] = even + values[first + step];
                values[first + step] = odd;
                values[first + 2 * step] = even;
            }
            _ => {
                let (low, high) = (values[first + step], values[first + 2 * step]);
                let (inner_even, inner_odd) = (high + low, high - low);
                values[first] = even + inner_even;
                values[first + step] = inner_odd.scale_add(self.inner, odd);
                values[first + 2 * step] = inner_even.scale_add(self.inner.powi(2), even);
                values[first + 3 * step] = inner_odd.scale_add(self.inner.powi(3), odd);
            }
        }
    }
}
