//! States between two steps.

use super::Instantaneous;

/// The state at time `t` between two accepted ones: the cubic through positions and velocities, its derivative, and
/// linear accelerations, loads and work.
pub(super) fn between(from: &Instantaneous, to: &Instantaneous, t: f64) -> Instantaneous {
    let h = to.t - from.t;
    let s = (t - from.t) / h;
    let linear = |a: f64, b: f64| a + s * (b - a);
    let each = |f: &dyn Fn(usize) -> f64| (0..from.q.len()).map(f).collect::<Vec<_>>();
    let position = |i: usize| {
        let (p, r) = (from.q[i], to.q[i] - from.q[i]);
        let (u, w) = (h * from.v[i], h * to.v[i]);
        p + s * (u + s * (3.0 * r - 2.0 * u - w + s * (u + w - 2.0 * r)))
    };
    let velocity = |i: usize| {
        let r = to.q[i] - from.q[i];
        let (u, w) = (h * from.v[i], h * to.v[i]);
        (u + s * (2.0 * (3.0 * r - 2.0 * u - w) + 3.0 * s * (u + w - 2.0 * r))) / h
    };
    Instantaneous {
        t,
        q: each(&position),
        v: each(&velocity),
        a: each(&|i| linear(from.a[i], to.a[i])),
        external: each(&|i| linear(from.external[i], to.external[i])),
        work: linear(from.work, to.work),
        negative_pivots: to.negative_pivots,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic motion is interpolated exactly.
    #[test]
    fn cubics_are_exact() {
        let at = |t: f64| Instantaneous {
            t,
            q: vec![1.0 - t + t * t + 2.0 * t.powi(3)],
            v: vec![-1.0 + 2.0 * t + 6.0 * t * t],
            a: vec![2.0 + 12.0 * t],
            external: vec![0.0],
            ..Instantaneous::default()
        };
        let middle = between(&at(0.5), &at(0.9), 0.6);
        let exact = at(0.6);
        assert!((middle.q[0] - exact.q[0]).abs() < 1e-15);
        assert!((middle.v[0] - exact.v[0]).abs() < 1e-14);
        assert!((middle.a[0] - exact.a[0]).abs() < 1e-14);
    }
}
