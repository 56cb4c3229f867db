//! Membrane strain: half the metric of the surface, whose change from the reference is the Green-Lagrange strain.

use pulp::Simd;

use super::{Block, Form, Measure, add_outer};
use crate::lanes::{Lanes, Vector, axpy, dot, scale};

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
    const FORCE: usize = 17 + 18;
    const STIFFNESS: usize = 6 * 9 + 6 * 18;

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

    /// The strains change with `r_x` by `(r_x, 0, r_y)` and with `r_y` by `(0, r_y, r_x)`; their second derivatives are
    /// multiples of the identity.
    #[inline(always)]
    fn stiffness(&self, weight: &[[Lanes<S>; 3]; 3], stress: [Lanes<S>; 3], mut form: Form<'_, S>) {
        let (x, y) = (self.x, self.y);
        let shear = mix(weight[2][2], x, weight[2][1], y);
        let [xx, yy, xy] = stress;
        let on_x = add_outer(y, mix(weight[2][0], x, weight[2][2], y), diagonal(xx));
        let on_y = add_outer(x, shear, diagonal(yy));
        form.set(0, 0, add_outer(x, mix(weight[0][0], x, weight[0][2], y), on_x));
        form.set(0, 1, add_outer(x, mix(weight[0][2], x, weight[0][1], y), add_outer(y, shear, diagonal(xy))));
        form.set(1, 1, add_outer(y, mix(weight[1][2], x, weight[1][1], y), on_y));
    }
}

/// `by_x x + by_y y`.
#[inline(always)]
fn mix<S: Simd>(by_x: Lanes<S>, x: Vector<S>, by_y: Lanes<S>, y: Vector<S>) -> Vector<S> {
    axpy(by_x, x, scale(by_y, y))
}

/// `value` times the identity.
#[inline(always)]
fn diagonal<S: Simd>(value: Lanes<S>) -> Block<S> {
    let zero = value.like(0.0);
    [[value, zero, zero], [zero, value, zero], [zero, zero, value]]
}
