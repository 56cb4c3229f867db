//! Loops that tell what the machine gives: arithmetic in registers.

use std::hint::black_box;

use pulp::{Arch, Simd, WithSimd};

/// Fused multiply-adds in as many chains as hide their latency.
struct Chains {
    rounds: usize,
}

const CHAINS: usize = 12;

impl WithSimd for Chains {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (factor, addend) = (simd.splat_f64s(0.999), simd.splat_f64s(1e-3));
        let mut chains = [factor; CHAINS];
        for _ in 0..self.rounds {
            for chain in &mut chains {
                *chain = simd.mul_add_e_f64s(*chain, factor, addend);
            }
        }
        chains.iter().map(|chain| simd.reduce_sum_f64s(*chain)).sum()
    }
}

/// Runs so many rounds of fused multiply-adds. Returns the number of floating-point operations.
pub fn multiply_add(rounds: usize) -> f64 {
    black_box(Arch::new().dispatch(Chains { rounds }));
    (2 * rounds * CHAINS * ancf_core::simd().1) as f64
}
