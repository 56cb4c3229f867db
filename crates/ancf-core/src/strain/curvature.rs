//! Bending strain: the curvature of the surface.

use pulp::Simd;

use super::{Block, Measure, packed};
use crate::lanes::{Lanes, Vector, axpy, cross, dot, scale, sub};

/// How the curvature takes the stretch of the surface, `J = |n| / |N|`, into account.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CurvatureLaw {
    /// `r_ab . n / |n| J^-2`: the paper's `r_ab . n / |n|^3` on a flat reference.
    #[default]
    Paper,
    /// `r_ab . n / |n|`: the second fundamental form, as in Koiter's shell.
    Koiter,
}

impl CurvatureLaw {
    /// All variants.
    pub const ALL: [Self; 2] = [Self::Paper, Self::Koiter];

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Koiter => "koiter",
        }
    }
}

/// `kappa_xx`, `kappa_yy` and `2 kappa_xy` for the gradients `r_x`, `r_y`, `r_xx`, `r_yy`, `r_xy`.
///
/// `kappa_ab = f r_ab . n` with `n = r_x x r_y`, `f = |N|^m / |n|^(m + 1)` and `m` = 2 or 0.
///
/// # Source
///
/// Dufva and Shabana (2005), (32), without the constant part.
#[derive(Clone, Copy)]
pub struct Curvature<S: Simd> {
    x: Vector<S>,
    y: Vector<S>,
    second: [Vector<S>; 3],
    unit_normal: Vector<S>,
    length: Lanes<S>,
    f: Lanes<S>,
    /// `m + 1`, the power of `1 / |n|` in `f`.
    power: f64,
}

impl<S: Simd> Curvature<S> {
    /// `f n`, the derivative of `f v . n` with respect to `v`.
    #[inline(always)]
    fn scaled_normal(&self) -> Vector<S> {
        scale(self.f * self.length, self.unit_normal)
    }

    /// The derivative of `f v . n` with respect to `n`.
    #[inline(always)]
    fn normal_derivative(&self, v: Vector<S>) -> Vector<S> {
        let along = dot(v, self.unit_normal) * -self.power;
        scale(self.f, axpy(along, self.unit_normal, v))
    }

    /// `sum_c m_c b_c`, the second derivatives weighted with the moments, the twist twice.
    #[inline(always)]
    fn weighted(&self, [xx, yy, xy]: [Lanes<S>; 3]) -> Vector<S> {
        axpy(xx, self.second[0], axpy(yy, self.second[1], scale(xy * 2.0, self.second[2])))
    }
}

impl<S: Simd> Measure<S, 5, 3> for Curvature<S> {
    type Law = CurvatureLaw;

    #[inline(always)]
    fn new(law: CurvatureLaw, [x, y, xx, yy, xy]: [Vector<S>; 5], area: Lanes<S>) -> Self {
        let n = cross(x, y);
        let length = dot(n, n).sqrt();
        let unit_normal = [n[0] / length, n[1] / length, n[2] / length];
        let (f, power) = match law {
            CurvatureLaw::Paper => {
                let stretch = area / length;
                (stretch * stretch / length, 3.0)
            }
            CurvatureLaw::Koiter => (length / dot(n, n), 1.0),
        };
        Self { x, y, second: [xx, yy, xy], unit_normal, length, f, power }
    }

    #[inline(always)]
    fn strain(&self) -> [Lanes<S>; 3] {
        let n = self.scaled_normal();
        [dot(self.second[0], n), dot(self.second[1], n), dot(self.second[2], n) * 2.0]
    }

    #[inline(always)]
    fn change(&self, [dx, dy, dxx, dyy, dxy]: &[Vector<S>; 5]) -> [Lanes<S>; 3] {
        let n = self.scaled_normal();
        let (p, q) = (cross(*dx, self.y), cross(self.x, *dy));
        let dn = [p[0] + q[0], p[1] + q[1], p[2] + q[2]];
        let component = |b: Vector<S>, db: Vector<S>| dot(n, db) + dot(self.normal_derivative(b), dn);
        [component(self.second[0], *dxx), component(self.second[1], *dyy), component(self.second[2], *dxy) * 2.0]
    }

    #[inline(always)]
    fn forces(&self, stress: [Lanes<S>; 3]) -> [Vector<S>; 5] {
        let g = self.normal_derivative(self.weighted(stress));
        let n = self.scaled_normal();
        let [xx, yy, xy] = stress;
        [cross(self.y, g), cross(g, self.x), scale(xx, n), scale(yy, n), scale(xy * 2.0, n)]
    }

    #[inline(always)]
    fn row(&self, [tx, ty, txx, tyy, txy]: [f64; 5]) -> [Vector<S>; 3] {
        let n = self.scaled_normal();
        // The change of n with the nodal vector is t x (that vector), see `add_second`; so g . dn = (g x t) . de.
        let t = lever(ty, self.x, tx, self.y);
        let row = |factor: f64, b: Vector<S>| {
            let g = cross(self.normal_derivative(b), t);
            [n[0].scale_add(factor, g[0]), n[1].scale_add(factor, g[1]), n[2].scale_add(factor, g[2])]
        };
        let twist = row(txy, self.second[2]);
        [row(txx, self.second[0]), row(tyy, self.second[1]), [twist[0] * 2.0, twist[1] * 2.0, twist[2] * 2.0]]
    }

    /// With `v` the weighted second derivatives, the energy `f v . n` depends on nodal vectors through `n` and `v`:
    /// `dn = t_b x de_b`, `t_b = N_b,y r_x - N_b,x r_y`, and `dv = c_b de_b`. So
    /// `K_ab = [t_a]^T H [t_b] + c_a F [t_b] + c_b [t_a]^T F + (N_a,y N_b,x - N_a,x N_b,y) [g]`,
    /// where `[t]` is the matrix of the vector product, `g = d(f v . n)/dn`, `H = dg/dn`, `F = d(f n)/dn`.
    #[inline(always)]
    fn add_second<const N: usize>(
        &self,
        stress: [Lanes<S>; 3],
        [tx, ty, txx, tyy, txy]: &[[f64; N]; 5],
        blocks: &mut [Block<S>],
    ) {
        let v = self.weighted(stress);
        let g = self.normal_derivative(v);
        let u = self.unit_normal;
        let over = self.f / self.length * -self.power;
        let along = dot(v, u);
        let zero = over.like(0.0);
        let mut h = [[zero; 3]; 3];
        let mut f = [[zero; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                let uu = u[i] * u[j];
                h[i][j] = over * (v[i] * u[j] + u[i] * v[j] - along * uu * (self.power + 2.0));
                f[i][j] = self.f * (uu * -self.power);
            }
            h[i][i] = h[i][i] + over * along;
            f[i][i] = f[i][i] + self.f;
        }

        let [xx, yy, xy] = stress;
        let twice = xy * 2.0;
        let mut levers = [[zero; 3]; N];
        let mut weights = [zero; N];
        for b in 0..N {
            levers[b] = lever(ty[b], self.x, tx[b], self.y);
            weights[b] = twice.scale_add(txy[b], yy.scale_add(tyy[b], xx * txx[b]));
        }
        for b in 0..N {
            // Columns of F [t_b] and of H [t_b] + c_b F; H and F are symmetric, so row i of H [t] is h_i x t.
            let mut coupling = [[zero; 3]; 3];
            let mut inner = [[zero; 3]; 3];
            for i in 0..3 {
                coupling[i] = cross(f[i], levers[b]);
                inner[i] = axpy(weights[b], f[i], cross(h[i], levers[b]));
            }
            for a in 0..=b {
                let block = &mut blocks[packed(a, b)];
                let t = levers[a];
                let c = weights[a];
                let skew = tx[b] * ty[a] - tx[a] * ty[b];
                for j in 0..3 {
                    // [t]^T m = m x t for each column m.
                    let column = cross([inner[0][j], inner[1][j], inner[2][j]], t);
                    for i in 0..3 {
                        block[i][j] = c.mul_add(coupling[i][j], block[i][j] + column[i]);
                    }
                }
                for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                    block[j][i] = g[k].scale_add(skew, block[j][i]);
                    block[i][j] = g[k].scale_add(-skew, block[i][j]);
                }
            }
        }
    }
}

/// `along_y x - along_x y`.
#[inline(always)]
fn lever<S: Simd>(along_y: f64, x: Vector<S>, along_x: f64, y: Vector<S>) -> Vector<S> {
    sub([x[0] * along_y, x[1] * along_y, x[2] * along_y], [y[0] * along_x, y[1] * along_x, y[2] * along_x])
}
