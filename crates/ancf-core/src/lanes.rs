//! Several elements side by side: a SIMD register with the arithmetic of a number.
//!
//! Kernels are written once over [`Lanes`] and compiled for every instruction set that `pulp` knows; the widest one the
//! processor has is chosen at run time. Every function here is inlined, so a kernel must be entered through
//! [`pulp::Simd::vectorize`] (as [`pulp::Arch::dispatch`] does).

use std::ops::{Add, Div, Mul, Neg, Sub};

use pulp::bytemuck::{cast_slice, cast_slice_mut};
use pulp::{Arch, Simd};

/// The widest register there is, in numbers.
pub const MAX_LANES: usize = 8;

/// The instruction set for so many elements: the widest, or registers of four numbers where those hold them all, which
/// takes half the time on processors that work on wider ones in two halves and no more on others. One element takes half
/// the time again with single numbers, though they have no fused multiply-add: all it needs stays in the first cache.
pub fn arch(elements: usize) -> Arch {
    if elements == 1 {
        return Arch::Scalar;
    }
    #[cfg(target_arch = "x86_64")]
    if elements <= 4
        && let Some(simd) = pulp::x86::V3::try_new()
    {
        return Arch::V3(simd);
    }
    Arch::new()
}

/// One number for each of `S::F64_LANES` elements.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd> {
    simd: S,
    value: S::f64s,
}

/// Numbers in lanes at the start of a cache line: a register that lies across two lines takes twice the time to load.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Aligned<T>(pub T);

/// A vector in space, for each lane.
pub type Vector<S> = [Lanes<S>; 3];

impl<S: Simd> Lanes<S> {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        Self { simd, value: simd.splat_f64s(value) }
    }

    /// `value` in every lane, for the same instruction set as `self`.
    #[inline(always)]
    pub fn like(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    /// The first numbers of an array, one for each lane.
    #[inline(always)]
    pub fn from_array(simd: S, numbers: &[f64; MAX_LANES]) -> Self {
        Self { simd, value: cast_slice(&numbers[..S::F64_LANES])[0] }
    }

    /// The number in each lane; the rest of the array is zero.
    #[inline(always)]
    pub fn to_array(self) -> [f64; MAX_LANES] {
        let mut buffer = [0.0; MAX_LANES];
        cast_slice_mut(&mut buffer[..S::F64_LANES])[0] = self.value;
        buffer
    }

    /// The register.
    #[inline(always)]
    pub fn value(self) -> S::f64s {
        self.value
    }

    /// `self * factor + addend` in one rounding where the processor can.
    #[inline(always)]
    pub fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self { simd: self.simd, value: self.simd.mul_add_e_f64s(self.value, factor.value, addend.value) }
    }

    /// `self * factor + addend` with the same factor in every lane: an entry of a shared table.
    #[inline(always)]
    pub fn scale_add(self, factor: f64, addend: Self) -> Self {
        self.mul_add(self.like(factor), addend)
    }

    /// The square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self { simd: self.simd, value: self.simd.sqrt_f64s(self.value) }
    }
}

/// Adds numbers to as many others.
#[inline(always)]
pub fn add<S: Simd>(simd: S, sums: &mut [f64], parts: &[f64]) {
    let ((sums, last), (parts, others)) = (S::as_mut_simd_f64s(sums), S::as_simd_f64s(parts));
    for (sum, part) in sums.iter_mut().zip(parts) {
        *sum = simd.add_f64s(*sum, *part);
    }
    for (sum, part) in last.iter_mut().zip(others) {
        *sum += part;
    }
}

/// Numbers of several elements from lanes to one element after the other.
#[derive(Clone, Copy, Debug)]
pub struct Transpose<S: Simd> {
    simd: S,
    /// The lane of each element: in the order in which transposed registers have them.
    pub lanes: [usize; MAX_LANES],
}

/// Registers that are transposed at a time.
const FOUR: usize = 4;

/// Groups of so many registers that are copied before they are transposed: what has just been stored in pieces cannot be
/// loaded as a whole.
const GROUPS: usize = 16;

impl<S: Simd> Transpose<S> {
    /// The transposition for an instruction set.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let mut numbers = [0.0; MAX_LANES];
        for (lane, number) in numbers.iter_mut().enumerate() {
            *number = lane as f64;
        }
        let elements = simd.interleave_shfl_f64s([Lanes::from_array(simd, &numbers).value; FOUR]);
        let mut lanes = [0; MAX_LANES];
        for (lane, element) in lanes.iter_mut().zip(cast_slice::<_, f64>(&elements).chunks_exact(FOUR)) {
            *lane = element[0] as usize;
        }
        Self { simd, lanes }
    }

    /// Numbers of several elements side by side: `source` gives those of an element, as many as there are in `target`.
    #[inline(always)]
    pub fn load<'a>(self, source: impl Fn(usize) -> &'a [f64], target: &mut [Lanes<S>]) {
        let mut copies = [[self.simd.splat_f64s(0.0); FOUR]; GROUPS];
        let size = target.len();
        for (part, target) in target.chunks_mut(FOUR * GROUPS).enumerate() {
            let begin = part * FOUR * GROUPS;
            let end = size.min(begin + FOUR * GROUPS);
            for element in 0..S::F64_LANES {
                let (fours, rest) = source(element)[begin..end].as_chunks::<FOUR>();
                for (copy, four) in copies.iter_mut().zip(fours) {
                    cast_slice_mut(copy)[FOUR * element..][..FOUR].copy_from_slice(four);
                }
                if let Some(copy) = copies.get_mut(fours.len()) {
                    cast_slice_mut(copy)[FOUR * element..][..rest.len()].copy_from_slice(rest);
                }
            }
            for (copy, target) in copies.iter().zip(target.chunks_mut(FOUR)) {
                for (target, value) in target.iter_mut().zip(self.simd.deinterleave_shfl_f64s(*copy)) {
                    *target = Lanes { simd: self.simd, value };
                }
            }
        }
    }

    /// The transpose of a square block of numbers.
    #[inline(always)]
    pub fn square<const SIDE: usize>(self, block: &[[f64; SIDE]; SIDE]) -> [[f64; SIDE]; SIDE] {
        let mut transpose = [[0.0; SIDE]; SIDE];
        let whole = SIDE - SIDE % S::F64_LANES;
        for first in (0..whole).step_by(S::F64_LANES) {
            for k in (0..SIDE - SIDE % FOUR).step_by(FOUR) {
                let mut four = [self.simd.splat_f64s(0.0); FOUR];
                for (value, row) in four.iter_mut().zip(&block[k..]) {
                    *value = cast_slice(&row[first..first + S::F64_LANES])[0];
                }
                let values = self.simd.interleave_shfl_f64s(four);
                for (values, lane) in cast_slice::<_, f64>(&values).chunks_exact(FOUR).zip(self.lanes) {
                    transpose[first + lane][k..k + FOUR].copy_from_slice(values);
                }
            }
        }
        for i in 0..SIDE {
            for k in (if i < whole { SIDE - SIDE % FOUR } else { 0 })..SIDE {
                transpose[i][k] = block[k][i];
            }
        }
        transpose
    }

    /// Stores `SIZE` numbers of each element.
    #[inline(always)]
    pub fn store<const SIZE: usize>(self, numbers: &[Lanes<S>], elements: &mut [[f64; SIZE]]) {
        let numbers = &numbers[..SIZE];
        for k in (0..SIZE - SIZE % FOUR).step_by(FOUR) {
            let four = [numbers[k].value, numbers[k + 1].value, numbers[k + 2].value, numbers[k + 3].value];
            let values = self.simd.interleave_shfl_f64s(four);
            for (values, element) in cast_slice::<_, f64>(&values).chunks_exact(FOUR).zip(elements.iter_mut()) {
                element[k..k + FOUR].copy_from_slice(values);
            }
        }
        for k in SIZE - SIZE % FOUR..SIZE {
            let values = numbers[k].to_array();
            for (lane, element) in self.lanes.iter().zip(elements.iter_mut()) {
                element[k] = values[*lane];
            }
        }
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.add_f64s(self.value, other.value) }
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.sub_f64s(self.value, other.value) }
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.mul_f64s(self.value, other.value) }
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.div_f64s(self.value, other.value) }
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.like(0.0) - self
    }
}

impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * self.like(factor)
    }
}

/// The scalar product.
#[inline(always)]
pub fn dot<S: Simd>(a: Vector<S>, b: Vector<S>) -> Lanes<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// The vector product.
#[inline(always)]
pub fn cross<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `factor * a + b`.
#[inline(always)]
pub fn axpy<S: Simd>(factor: Lanes<S>, a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [factor.mul_add(a[0], b[0]), factor.mul_add(a[1], b[1]), factor.mul_add(a[2], b[2])]
}

/// `factor * a + b` with the same factor in every lane.
#[inline(always)]
pub fn table_axpy<S: Simd>(factor: f64, a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0].scale_add(factor, b[0]), a[1].scale_add(factor, b[1]), a[2].scale_add(factor, b[2])]
}

/// `factor * a`.
#[inline(always)]
pub fn scale<S: Simd>(factor: Lanes<S>, a: Vector<S>) -> Vector<S> {
    [factor * a[0], factor * a[1], factor * a[2]]
}

#[cfg(test)]
mod tests {
    use pulp::WithSimd;

    use super::*;

    /// Transposes a block of `SIDE` x `SIDE` different numbers.
    struct Square<const SIDE: usize>;

    impl<const SIDE: usize> WithSimd for Square<SIDE> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let block: [[f64; SIDE]; SIDE] = std::array::from_fn(|i| std::array::from_fn(|j| (SIDE * i + j) as f64));
            let transpose = Transpose::new(simd).square(&block);
            for i in 0..SIDE {
                for j in 0..SIDE {
                    assert_eq!(transpose[i][j], block[j][i]);
                }
            }
        }
    }

    #[test]
    fn every_instruction_set_transposes_blocks() {
        for arch in [Arch::Scalar, arch(4), arch(usize::MAX)] {
            arch.dispatch(Square::<9>);
            arch.dispatch(Square::<12>);
        }
    }
}
