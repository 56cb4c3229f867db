//! The state of a motion, and what is accumulated along it.

use crate::linear::dot;
use crate::observe::State;

use super::equations::Equations;

/// The state of a motion at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Instantaneous {
    pub t: f64,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    /// Accelerations, which some integrators know only for a time somewhat earlier than `t`.
    pub a: Vec<f64>,
    /// How much earlier, s.
    pub lag: f64,
    /// Force of the loads, and of supports where they are moved.
    pub external: Vec<f64>,
    /// Power that damping takes, W.
    pub damping: f64,
    /// Work of the loads and of moved supports since the start, J.
    pub work: f64,
    /// Energy that damping has taken since the start, J.
    pub dissipated: f64,
    pub negative_pivots: Option<usize>,
}

impl Instantaneous {
    /// Work and dissipation of a step that comes from `from`, by the trapezoidal rule.
    pub fn accumulate(&mut self, from: &Self) {
        let path: Vec<f64> = self.q.iter().zip(&from.q).map(|(to, from)| to - from).collect();
        self.work = from.work + 0.5 * (dot(&path, &self.external) + dot(&path, &from.external));
        self.dissipated = from.dissipated + 0.5 * (self.t - from.t) * (self.damping + from.damping);
    }

    /// The output for this state.
    pub fn output(&self, equations: &mut Equations<'_>) -> State {
        let (kinetic, momentum, angular_momentum) =
            equations.system.motion(equations.inertia.matrix(), &self.q, &self.v);
        let (strain, reactions) = equations.reactions(self);
        State {
            t: self.t,
            q: self.q.clone(),
            v: self.v.clone(),
            a: self.a.clone(),
            strain,
            kinetic,
            work: self.work,
            dissipated: self.dissipated,
            momentum,
            angular_momentum,
            reactions,
            negative_pivots: self.negative_pivots,
        }
    }

    /// The state at time `t` between `from` and `to`: the polynomial through positions and velocities at both, and
    /// through accelerations too where `quintic`; its derivatives; all else linear.
    pub fn between(from: &Self, to: &Self, t: f64, quintic: bool) -> Self {
        let h = to.t - from.t;
        let s = (t - from.t) / h;
        let linear = |a: f64, b: f64| a + s * (b - a);
        let each = |f: &dyn Fn(usize) -> f64| (0..from.q.len()).map(f).collect::<Vec<_>>();
        // Coefficients of s^2 to s^5; those of 1 and s are q and h v.
        let coefficients = |i: usize| {
            let r = to.q[i] - from.q[i] - h * from.v[i];
            let u = h * (to.v[i] - from.v[i]);
            if quintic {
                let (a, b) = (0.5 * h * h * from.a[i], 0.5 * h * h * to.a[i]);
                let (r, u, w) = (r - a, u - 2.0 * a, b - a);
                [a, 10.0 * r - 4.0 * u + w, -15.0 * r + 7.0 * u - 2.0 * w, 6.0 * r - 3.0 * u + w]
            } else {
                [3.0 * r - u, u - 2.0 * r, 0.0, 0.0]
            }
        };
        let position = |i: usize| {
            let [c2, c3, c4, c5] = coefficients(i);
            from.q[i] + s * (h * from.v[i] + s * (c2 + s * (c3 + s * (c4 + s * c5))))
        };
        let velocity = |i: usize| {
            let [c2, c3, c4, c5] = coefficients(i);
            from.v[i] + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5))) / h
        };
        Self {
            t,
            q: each(&position),
            v: each(&velocity),
            a: each(&|i| linear(from.a[i], to.a[i])),
            lag: linear(from.lag, to.lag),
            external: each(&|i| linear(from.external[i], to.external[i])),
            damping: linear(from.damping, to.damping),
            work: linear(from.work, to.work),
            dissipated: linear(from.dissipated, to.dissipated),
            negative_pivots: to.negative_pivots,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Motions that the polynomials contain are interpolated exactly.
    #[test]
    fn polynomials_are_exact() {
        for (degree, quintic) in [(3, false), (5, true)] {
            let d = f64::from(degree);
            let at = |t: f64| Instantaneous {
                t,
                q: vec![1.0 - t + t * t + 2.0 * t.powi(degree)],
                v: vec![-1.0 + 2.0 * t + 2.0 * d * t.powi(degree - 1)],
                a: vec![2.0 + 2.0 * d * (d - 1.0) * t.powi(degree - 2)],
                external: vec![0.0],
                ..Instantaneous::default()
            };
            let middle = Instantaneous::between(&at(0.5), &at(0.9), 0.6, quintic);
            let exact = at(0.6);
            assert!((middle.q[0] - exact.q[0]).abs() < 1e-14);
            assert!((middle.v[0] - exact.v[0]).abs() < 1e-13);
        }
    }
}
