//! The tangent of an element by pairs of its corners, as the global one needs it.
//!
//! For each pair of corners `c <= r` a square block holds the rows of corner `r` in the columns of corner `c`, column after
//! column: a column of the global matrix takes them as they follow each other. Of a corner with itself the block has the
//! lower triangle, and zeros above it.

use pulp::Simd;

use crate::lanes::Lanes;
use crate::strain::{Block, packed};

use super::corners::distribute;

/// Pairs of corners.
const PAIRS: usize = 10;

/// Number of entries of the tangent of an element with `n` nodal vectors.
pub const fn tangent_size(n: usize) -> usize {
    PAIRS * (3 * n / 4).pow(2)
}

/// Position of an entry of the tangent of an element with `n` nodal vectors: component `i` of vector `a` in the rows,
/// component `j` of vector `b` in the columns; the row must not be before the column.
pub const fn tangent_place(n: usize, [a, i]: [usize; 2], [b, j]: [usize; 2]) -> usize {
    let kinds = n / 4;
    let (side, pair) = (3 * kinds, packed(b / kinds, a / kinds));
    (pair * side + 3 * (b % kinds) + j) * side + 3 * (a % kinds) + i
}

/// Makes the tangent of the corners from that of their sums and differences, `blocks[b][a]` for `a <= b`, times
/// `stiffness`, and adds `inertia` times the packed scalar mass matrix.
#[inline(always)]
pub(super) fn to_pairs<S: Simd, const N: usize>(
    blocks: &[[Block<S>; N]; N],
    stiffness: f64,
    mass: &[Lanes<S>],
    inertia: f64,
    pairs: &mut [Lanes<S>],
) {
    let kinds = N / 4;
    let side = 3 * kinds;
    let pairs = &mut pairs[..tangent_size(N)];
    let stiffness = blocks[0][0][0][0].like(stiffness);
    let zero = stiffness.like(0.0);
    let place = |[r, i]: [usize; 2], [c, j]: [usize; 2]| (packed(c, r) * side + j) * side + i;
    for u in 0..kinds {
        for v in u..kinds {
            for i in 0..3 {
                for j in (if u == v { i } else { 0 })..3 {
                    // Component i of kind u at corner r, component j of kind v at corner c.
                    let (first, second) = (3 * u + i, 3 * v + j);
                    let mut rows = [[stiffness; 4]; 4];
                    for r in 0..4 {
                        for c in 0..4 {
                            let (a, b) = (r * kinds + u, c * kinds + v);
                            rows[r][c] = if r <= c { blocks[b][a][i][j] } else { blocks[a][b][j][i] };
                        }
                        rows[r] = distribute(rows[r]);
                    }
                    for c in 0..4 {
                        let entries = distribute([rows[0][c], rows[1][c], rows[2][c], rows[3][c]]);
                        for r in 0..4 {
                            let mut entry = entries[r] * stiffness;
                            if i == j {
                                let (a, b) = (r * kinds + u, c * kinds + v);
                                let mass = mass[if r <= c { packed(a, b) } else { packed(b, a) }];
                                entry = mass.scale_add(inertia, entry);
                            }
                            if r > c {
                                pairs[place([r, first], [c, second])] = entry;
                                continue;
                            }
                            if r == c {
                                pairs[place([r, first], [c, second])] = zero;
                            }
                            pairs[place([c, second], [r, first])] = entry;
                        }
                    }
                }
            }
        }
    }
}
