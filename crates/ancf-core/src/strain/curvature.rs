//! Bending strain: the curvature of the surface.

use pulp::Simd;

use super::{Block, Form, Measure, add_outer};
use crate::lanes::{Lanes, Vector, axpy, cross, dot, scale};

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
    const FORCE: usize = 21 + 20 + 63;
    // Normal and its derivatives, changes with it, weighted sums, their outer products with H, coupling to b_ab.
    const STIFFNESS: usize = 100 + 108 + 108 + 159 + 162 + 58 + 3 * 59 + 6 * 22;

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
        let mut change = [dot(n, *dxx), dot(n, *dyy), dot(n, *dxy)];
        for c in 0..3 {
            change[c] = change[c] + dot(self.normal_derivative(self.second[c]), dn);
        }
        [change[0], change[1], change[2] * 2.0]
    }

    #[inline(always)]
    fn forces(&self, stress: [Lanes<S>; 3]) -> [Vector<S>; 5] {
        let g = self.normal_derivative(self.weighted(stress));
        let n = self.scaled_normal();
        let [xx, yy, xy] = stress;
        [cross(self.y, g), cross(g, self.x), scale(xx, n), scale(yy, n), scale(xy * 2.0, n)]
    }

    /// With `v` the weighted second derivatives, the energy `f v . n` of constant stress depends on the gradients through
    /// `n` and `v`, by `g = d(f v . n)/dn`, `H = dg/dn` and `F = d(f n)/dn`; `dn = dr_x x r_y + r_x x dr_y`.
    #[inline(always)]
    fn stiffness(&self, weight: &[[Lanes<S>; 3]; 3], stress: [Lanes<S>; 3], mut form: Form<'_, S>) {
        let (x, y, u) = (self.x, self.y, self.unit_normal);
        let v = self.weighted(stress);
        let along = dot(v, u);
        let over = self.f / self.length * -self.power;
        let zero = over.like(0.0);
        let none = [[zero; 3]; 3];
        // H = over (v u^T + u v^T + along (1 - (power + 2) u u^T)), F = f (1 - power u u^T).
        let middle = scale(over, axpy(along * (-0.5 * (self.power + 2.0)), u, v));
        let mut h = add_outer(middle, u, add_outer(u, middle, none));
        let mut f = add_outer(scale(self.f * -self.power, u), u, none);
        for i in 0..3 {
            h[i][i] = over.mul_add(along, h[i][i]);
            f[i][i] = f[i][i] + self.f;
        }

        // The change of each curvature with r_x and r_y, and the weighted sums of these.
        let twice = [1.0, 1.0, 2.0];
        let mut by_x = none;
        let mut by_y = none;
        for c in 0..3 {
            let by_normal = scale(zero.like(twice[c]), self.normal_derivative(self.second[c]));
            by_x[c] = cross(y, by_normal);
            by_y[c] = cross(by_normal, x);
        }
        let mut weighted_x = none;
        let mut weighted_y = none;
        for c in 0..3 {
            for e in 0..3 {
                weighted_x[c] = axpy(weight[c][e], by_x[e], weighted_x[c]);
                weighted_y[c] = axpy(weight[c][e], by_y[e], weighted_y[c]);
            }
        }

        // With [t] the matrix of the vector product: dn = -[r_y] dr_x + [r_x] dr_y, and n is bilinear: g . (dr_x x dr_y).
        let (y_h, x_h) = (turned(y, &h), turned(x, &h));
        let g = self.normal_derivative(v);
        let mut xx = none;
        let mut yy = none;
        let mut xy = [[zero, g[2], -g[1]], [-g[2], zero, g[0]], [g[1], -g[0], zero]];
        for i in 0..3 {
            // Row i of m [t] is (row i of m) x t.
            xx[i] = cross(y, y_h[i]);
            yy[i] = cross(x, x_h[i]);
            let row = cross(y_h[i], x);
            for j in 0..3 {
                xy[i][j] = xy[i][j] + row[j];
            }
        }
        for c in 0..3 {
            xx = add_outer(by_x[c], weighted_x[c], xx);
            yy = add_outer(by_y[c], weighted_y[c], yy);
            xy = add_outer(by_x[c], weighted_y[c], xy);
        }
        form.set(0, 0, xx);
        form.set(0, 1, xy);
        form.set(1, 1, yy);

        let n = self.scaled_normal();
        let (y_f, x_f) = (turned(y, &f), turned(x, &f));
        for c in 0..3 {
            let moment = stress[c] * twice[c];
            let normal = scale(zero.like(twice[c]), n);
            let mut on_x = none;
            let mut on_y = none;
            for i in 0..3 {
                on_x[i] = scale(moment, y_f[i]);
                on_y[i] = scale(-moment, x_f[i]);
            }
            form.set(0, 2 + c, add_outer(weighted_x[c], normal, on_x));
            form.set(1, 2 + c, add_outer(weighted_y[c], normal, on_y));
            for e in c..3 {
                form.set(2 + c, 2 + e, add_outer(normal, scale(weight[c][e] * twice[e], n), none));
            }
        }
    }
}

/// `[t] m` for a symmetric `m`, where `[t]` is the matrix of the vector product with `t` from the left.
#[inline(always)]
fn turned<S: Simd>(t: Vector<S>, m: &Block<S>) -> Block<S> {
    let columns = [cross(t, m[0]), cross(t, m[1]), cross(t, m[2])];
    let mut rows = columns;
    for i in 0..3 {
        for j in 0..3 {
            rows[i][j] = columns[j][i];
        }
    }
    rows
}
