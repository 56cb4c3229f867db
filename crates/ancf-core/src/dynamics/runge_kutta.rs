//! Runge-Kutta methods, explicit and diagonally implicit, from their tableaux.

use crate::linear::dot;
use crate::nonlinear::Failure;
use crate::observe::Observer;

use super::equations::Equations;
use super::method::Integrator;
use super::stage::Stage;
use super::state::Instantaneous;

/// A Runge-Kutta pair whose first stage is the end of the last step and whose last stage is the end of this one.
///
/// Applied to `q' = v`, `v' = a(t, q, v)`. A stage with a diagonal entry `g` is implicit: eliminating its velocity
/// leaves `M (Q - Q*) / (g h)^2 + F(Q) = 0`.
#[derive(Debug)]
pub(super) struct Tableau {
    /// Order of the solution.
    pub order: usize,
    /// Order of the other solution of the pair.
    pub embedded_order: usize,
    /// Rows of the coefficients, each up to and including its diagonal; the last row has the weights.
    pub a: &'static [&'static [f64]],
    /// Weights of the other solution.
    pub embedded: &'static [f64],
}

/// An error of the velocity goes on to move positions. It is counted with what it has done after so many steps: enough
/// that plates of rubber and of steel keep the tolerances in `tests/integration/motion/control.rs`.
pub(super) const CARRIED: f64 = 4.0;

/// Share of the stiff part of a difference that counts. Where stiff forces keep a body in shape while it turns, the order of
/// velocities and of these forces falls to that of the stages. Both solutions of a pair then have the same error, and
/// only the stiff part of their difference shows it. The share is as small as keeps the thick steel plates in
/// `tests/integration/motion/control.rs` near their tolerance, because stiff parts that just die out count too.
///
/// # Source
///
/// Lubich (1993), Integration of stiff mechanical systems by Runge-Kutta methods, for the orders.
const STIFF_SHARE: f64 = 0.1;

impl Tableau {
    /// Where each stage lies in the step, from 0 to 1.
    fn place(&self, stage: usize) -> f64 {
        self.a[stage].iter().sum()
    }

    /// The weights of the solution.
    fn weights(&self) -> &'static [f64] {
        self.a[self.a.len() - 1]
    }

    fn is_explicit(&self) -> bool {
        (0..self.a.len()).all(|i| self.a[i].get(i).is_none_or(|diagonal| *diagonal == 0.0))
    }

    /// Growth of the oscillation `y' = i omega y` in a step with `z = omega h`, squared.
    fn growth(&self, z: f64) -> f64 {
        let mut stages: Vec<[f64; 2]> = Vec::new();
        for row in self.a {
            let sum = |c: usize| row.iter().zip(&stages).map(|(a, stage)| a * stage[c]).sum::<f64>();
            // The stage y is the number whose derivative, z i y, is summed.
            stages.push([1.0 - z * sum(1), z * sum(0)]);
        }
        let [re, im] = stages[stages.len() - 1];
        re * re + im * im
    }
}

impl Integrator for Tableau {
    fn order(&self) -> usize {
        self.order
    }

    fn error_order(&self) -> usize {
        self.order.min(self.embedded_order)
    }

    /// The end of the interval on which oscillations do not grow, found from the tableau.
    fn explicit_limit(&self) -> Option<f64> {
        const RESOLUTION: f64 = 1e-3;
        let stable = |k: &u32| self.growth(f64::from(*k) * RESOLUTION) <= 1.0 + 1e-12;
        self.is_explicit().then(|| RESOLUTION * f64::from((1..).take_while(stable).last().unwrap_or(0)))
    }

    fn step(
        &self,
        equations: &mut Equations<'_>,
        now: &Instantaneous,
        next: &mut Instantaneous,
        error: &mut [f64],
        observer: &dyn Observer,
    ) -> Result<(), Failure> {
        let h = next.t - now.t;
        let n = now.q.len();
        let mut stages = vec![now.clone()];
        let mut factor = 0.0;
        for (i, row) in self.a.iter().enumerate().skip(1) {
            let mut stage = Instantaneous { lag: 0.0, ..next.clone() };
            if i + 1 < self.a.len() {
                stage.t = now.t + self.place(i) * h;
            }
            let g = h * row.get(i).copied().unwrap_or(0.0);
            let known = |of: &dyn Fn(&Instantaneous) -> &[f64], start: &[f64]| -> Vec<f64> {
                let mut sum = start.to_vec();
                for (a, stage) in row.iter().zip(&stages) {
                    for (sum, x) in sum.iter_mut().zip(of(stage)) {
                        *sum += h * a * x;
                    }
                }
                sum
            };
            // Without what the stage itself adds.
            let position = known(&|stage| &stage.v, &now.q);
            let velocity = known(&|stage| &stage.a, &now.v);
            if g == 0.0 {
                (stage.q, stage.v) = (position, velocity);
                equations.prescribe(&mut stage);
                equations.accelerate(&mut stage)?;
            } else {
                factor = 1.0 / (g * g);
                equations.prescribe(&mut stage);
                let last = &stages[i - 1];
                let problem = Stage {
                    position: (0..n).map(|k| position[k] + g * velocity[k]).collect(),
                    velocity,
                    length: g,
                    slope: 1.0,
                    inertia: 1.0,
                    forces: 1.0,
                    constant: None,
                    start: None,
                };
                problem.solve(equations, &mut stage, &last.a, &last.q, observer)?;
                equations.load(&mut stage);
            }
            stages.push(stage);
        }

        error.fill(0.0);
        let (mut work, mut dissipated) = (now.work, now.dissipated);
        for (i, stage) in stages.iter().enumerate() {
            let weight = h * self.weights().get(i).copied().unwrap_or(0.0);
            work += weight * dot(&stage.external, &stage.v);
            dissipated += weight * stage.damping;
            let difference = weight - h * self.embedded[i];
            for ((error, v), a) in error.iter_mut().zip(&stage.v).zip(&stage.a) {
                *error += difference * (v + CARRIED * h * a);
            }
        }
        if factor != 0.0 {
            // What is stiff in the difference is not in the solution and is taken out, but for a share.
            let mut right = vec![0.0; n];
            let scaled: Vec<f64> = error.iter().map(|error| factor * error).collect();
            equations.inertia.add_product(&scaled, &mut right);
            let mut soft = scaled;
            equations.system.solve(&right, &mut soft);
            for (error, soft) in error.iter_mut().zip(soft) {
                *error = soft + STIFF_SHARE * (*error - soft);
            }
        }
        *next = Instantaneous { work, dissipated, lag: 0.0, ..stages.pop().expect("at least one stage") };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{dormand_prince, esdirk, tr_bdf2};
    use super::*;

    /// What is left of the order conditions up to the given order.
    ///
    /// # Source
    ///
    /// Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), II.2.
    fn conditions(tableau: &Tableau, weights: &[f64], order: usize) -> Vec<f64> {
        let s = tableau.a.len();
        let c: Vec<f64> = (0..s).map(|i| tableau.place(i)).collect();
        let apply = |x: &[f64]| -> Vec<f64> {
            tableau.a.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
        };
        let times = |x: &[f64], y: &[f64]| -> Vec<f64> { x.iter().zip(y).map(|(x, y)| x * y).collect() };
        let one = vec![1.0; s];
        let c2 = times(&c, &c);
        let (c3, c4) = (times(&c2, &c), times(&c2, &c2));
        let (ac, ac2, ac3) = (apply(&c), apply(&c2), apply(&c3));
        let (aac, aac2) = (apply(&ac), apply(&ac2));
        let mut trees = vec![(1, one, 1.0), (2, c.clone(), 2.0), (3, c2.clone(), 3.0), (3, ac.clone(), 6.0)];
        trees.push((4, c3, 4.0));
        trees.push((4, times(&c, &ac), 8.0));
        trees.push((4, ac2.clone(), 12.0));
        trees.push((4, aac.clone(), 24.0));
        trees.push((5, c4, 5.0));
        trees.push((5, times(&c2, &ac), 10.0));
        trees.push((5, times(&ac, &ac), 20.0));
        trees.push((5, times(&c, &ac2), 15.0));
        trees.push((5, times(&c, &aac), 30.0));
        trees.push((5, ac3, 20.0));
        trees.push((5, apply(&times(&c, &ac)), 40.0));
        trees.push((5, aac2, 60.0));
        trees.push((5, apply(&aac), 120.0));
        let of_order = trees.into_iter().filter(|tree| tree.0 <= order);
        of_order
            .map(|(_, tree, density)| weights.iter().zip(&tree).map(|(b, x)| b * x).sum::<f64>() - 1.0 / density)
            .collect()
    }

    #[test]
    fn tableaux_have_their_orders_and_no_higher_ones() {
        for tableau in [&tr_bdf2::TR_BDF2, &esdirk::ESDIRK, &dormand_prince::DORMAND_PRINCE] {
            for (weights, order) in [(tableau.weights(), tableau.order), (tableau.embedded, tableau.embedded_order)] {
                let worst =
                    |order| conditions(tableau, weights, order).into_iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                assert!(worst(order) < 1e-15, "{tableau:?} {order}: {}", worst(order));
                assert!(order == 5 || worst(order + 1) > 1e-4, "{tableau:?}");
            }
        }
    }

    /// The implicit methods remove an infinite frequency, and damp all others.
    #[test]
    fn implicit_methods_are_l_stable() {
        // Growth of y' = z y for real z with implicit stages solved.
        let decay = |tableau: &Tableau, re: f64, im: f64| {
            let mut stages: Vec<[f64; 2]> = Vec::new();
            for (i, row) in tableau.a.iter().enumerate() {
                let sum = |c: usize| row.iter().zip(&stages).map(|(a, stage)| a * stage[c]).sum::<f64>();
                let (x, y) = (1.0 + re * sum(0) - im * sum(1), re * sum(1) + im * sum(0));
                let g = row.get(i).copied().unwrap_or(0.0);
                let (dx, dy) = (1.0 - g * re, -g * im);
                let d = dx * dx + dy * dy;
                stages.push([(x * dx + y * dy) / d, (y * dx - x * dy) / d]);
            }
            let [x, y] = stages[stages.len() - 1];
            x.hypot(y)
        };
        for tableau in [&tr_bdf2::TR_BDF2, &esdirk::ESDIRK] {
            assert!(decay(tableau, -1e9, 0.0) < 1e-8 && decay(tableau, 0.0, 1e9) < 1e-8);
            for k in -40..40 {
                assert!(decay(tableau, 0.0, 10.0_f64.powf(f64::from(k) / 10.0)) <= 1.0 + 1e-12);
            }
        }
    }

    /// Dormand and Prince's method is stable for oscillations up to about 1: y^6 / 1800 against y^8 / 1600 in `|R|^2`.
    #[test]
    fn explicit_limit_is_that_of_the_stability_polynomial() {
        let limit = dormand_prince::DORMAND_PRINCE.explicit_limit().unwrap();
        assert!((0.9..1.1).contains(&limit), "{limit}");
        assert_eq!(tr_bdf2::TR_BDF2.explicit_limit(), None);
    }
}
