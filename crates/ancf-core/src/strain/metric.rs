//! Membrane strain: half the metric of the surface, whose change from the reference is the Green-Lagrange strain.

use pulp::Simd;

use super::{Block, Measure, packed};
use crate::lanes::{Lanes, Vector, axpy, dot, scale, table_axpy};

/// `r_x . r_x / 2`, `r_y . r_y / 2` and `r_x . r_y` for the gradients `r_x`, `r_y`.
///
/// # Source
///
/// Dufva and Shabana (2005), (30) and (31), without the constant part.
#[derive(Clone, Copy)]
pub struct Metric<S: Simd> {
    x: Vector<S>,
    y: Vector<S>,
}

impl<S: Simd> Measure<S, 2, 3> for Metric<S> {
    type Law = ();

    #[inline(always)]
    fn new((): (), [x, y]: [Vector<S>; 2], _area: Lanes<S>) -> Self {
        Self { x, y }
    }

    #[inline(always)]
    fn strain(&self) -> [Lanes<S>; 3] {
        [dot(self.x, self.x) * 0.5, dot(self.y, self.y) * 0.5, dot(self.x, self.y)]
    }

    #[inline(always)]
    fn change(&self, [dx, dy]: &[Vector<S>; 2]) -> [Lanes<S>; 3] {
        [dot(self.x, *dx), dot(self.y, *dy), dot(self.x, *dy) + dot(self.y, *dx)]
    }

    #[inline(always)]
    fn forces(&self, [xx, yy, xy]: [Lanes<S>; 3]) -> [Vector<S>; 2] {
        [axpy(xx, self.x, scale(xy, self.y)), axpy(yy, self.y, scale(xy, self.x))]
    }

    #[inline(always)]
    fn row(&self, [tx, ty]: [f64; 2]) -> [Vector<S>; 3] {
        let scaled = |factor: f64, v: Vector<S>| [v[0] * factor, v[1] * factor, v[2] * factor];
        [scaled(tx, self.x), scaled(ty, self.y), table_axpy(tx, self.y, scaled(ty, self.x))]
    }

    #[inline(always)]
    fn add_second<const N: usize>(
        &self,
        [xx, yy, xy]: [Lanes<S>; 3],
        [tx, ty]: &[[f64; N]; 2],
        blocks: &mut [Block<S>],
    ) {
        for b in 0..N {
            let along_x = xy.scale_add(ty[b], xx * tx[b]);
            let along_y = yy.scale_add(ty[b], xy * tx[b]);
            for a in 0..=b {
                let value = along_y.scale_add(ty[a], along_x * tx[a]);
                let block = &mut blocks[packed(a, b)];
                for (i, row) in block.iter_mut().enumerate() {
                    row[i] = row[i] + value;
                }
            }
        }
    }
}
