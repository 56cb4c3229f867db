//! Bodies that do not deform: six motions each, or as many as their supports leave.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::error::InputError;
use crate::model::{Body, Model};
use crate::nonlinear::Failure;
use crate::observe::Observer;

use super::dormand_prince::DORMAND_PRINCE;
use super::equations::Equations;
use super::method::Integrator;
use super::runge_kutta::CARRIED;
use super::state::Instantaneous;

/// Every body moves rigidly: the Newton-Euler equations, by the Runge-Kutta pair of Dormand and Prince.
///
/// The nodal coordinates are kept: a step turns and shifts those at its start, so that mass, inertia and loads are those
/// of the mesh. Loads are work-consistent: the power of `Q_e` in a rigid motion is that of its force and torque. Elastic
/// forces and viscosity do no work in it.
///
/// # Source
///
/// Hairer, Lubich and Wanner, Geometric Numerical Integration (2006), VII.5, for the equations with quaternions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rigid;

/// Numbers of a body in the state of a step: pivot, rotation since the start of the step (w, i, j, k), velocity of the
/// pivot, angular velocity.
const NUMBERS: usize = 13;
/// Distance from an axis, relative to the farthest fixed vector, that counts as none.
const ON_AXIS: f64 = 1e-9;

/// What the supports of a body leave it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Turning {
    Free,
    About(Vector3<f64>),
    Held,
}

impl Turning {
    /// The part of a rotation that is free.
    fn part(self, x: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Free => x,
            Self::About(axis) => axis * axis.dot(&x),
            Self::Held => Vector3::zeros(),
        }
    }

    /// The free rotation `x` for which `inertia x - right` has no free part.
    fn solve(self, inertia: &Matrix3<f64>, right: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Free => inertia.cholesky().map_or(Vector3::repeat(f64::NAN), |factors| factors.solve(&right)),
            Self::About(axis) => axis * (axis.dot(&right) / axis.dot(&(inertia * axis))),
            Self::Held => Vector3::zeros(),
        }
    }
}

fn vector(x: &[f64], index: usize) -> Vector3<f64> {
    Vector3::from_column_slice(&x[3 * index..3 * index + 3])
}

/// Refuses supports that a rigid body cannot have: they fix whole nodal vectors and do not move.
pub(super) fn check(model: &Model) -> Result<(), InputError> {
    let whole = model.fixed().chunks(3).all(|fixed| fixed.iter().all(|f| *f == fixed[0]));
    let allowed = "a method for flexible bodies, or supports that fix all components of r, r_x or r_y and do not move";
    InputError::check("method", "\"rigid\"", whole && model.moved().is_empty(), allowed)
}

/// The equations of one body in one step.
struct Rotor {
    /// Its nodal vectors.
    vectors: std::ops::Range<usize>,
    /// Where they are at the start of the step: positions from the pivot, other vectors as they are.
    arms: Vec<Vector3<f64>>,
    is_position: Vec<bool>,
    mass: f64,
    /// Mass-proportional damping, 1/s.
    drag: f64,
    /// At the start of the step, about the pivot, kg m2.
    inertia: Matrix3<f64>,
    turning: Turning,
    pinned: bool,
}

impl Rotor {
    /// The body at the start of a step, and its part of the state there.
    fn new(
        body: &Body,
        equations: &Equations<'_>,
        q: &[f64],
        momenta: &[f64],
        arms_times_mass: &mut [f64],
    ) -> (Self, Vec<f64>) {
        let count = body.nodal_vectors().len();
        let vectors = body.vector(0, 0)..body.vector(body.grid().nodes(), 0);
        let is_position: Vec<bool> = vectors.clone().map(|v| (v - vectors.start) % count == 0).collect();
        let positions = || vectors.clone().zip(&is_position).filter(|(_, is)| **is).map(|(v, _)| v);
        let weight = equations.system.weight();
        let mass: f64 = positions().map(|v| weight[v]).sum();

        let fixed = |v: &usize| equations.system.model().fixed()[3 * v];
        let pin = positions().find(|v| fixed(v));
        let pivot = match pin {
            Some(v) => vector(q, v),
            None => vectors.clone().map(|v| weight[v] * vector(q, v)).sum::<Vector3<f64>>() / mass,
        };
        let arms: Vec<Vector3<f64>> = vectors
            .clone()
            .zip(&is_position)
            .map(|(v, is)| if *is { vector(q, v) - pivot } else { vector(q, v) })
            .collect();
        let held: Vec<_> = vectors.clone().filter(fixed).map(|v| arms[v - vectors.start]).collect();
        let longest =
            held.iter().copied().fold(Vector3::zeros(), |a: Vector3<f64>, b| if b.norm() > a.norm() { b } else { a });
        let turning = if longest == Vector3::zeros() {
            Turning::Free
        } else {
            let axis = longest.normalize();
            let about = held.iter().all(|arm| arm.cross(&axis).norm() <= ON_AXIS * longest.norm());
            if about { Turning::About(axis) } else { Turning::Held }
        };

        for (v, arm) in vectors.clone().zip(&arms) {
            arms_times_mass[3 * v..3 * v + 3].copy_from_slice(arm.as_slice());
        }
        let mut products = vec![0.0; q.len()];
        equations.inertia.add_product(arms_times_mass, &mut products);
        let second: Matrix3<f64> =
            vectors.clone().zip(&arms).map(|(v, arm)| vector(&products, v) * arm.transpose()).sum();
        let inertia = Matrix3::identity() * second.trace() - second;

        let momentum: Vector3<f64> = positions().map(|v| vector(momenta, v)).sum();
        let angular: Vector3<f64> = vectors.clone().zip(&arms).map(|(v, arm)| arm.cross(&vector(momenta, v))).sum();
        let pinned = pin.is_some();
        let velocity = if pinned { Vector3::zeros() } else { momentum / mass };
        let spin = turning.solve(&inertia, angular);
        let drag = body.plate().material.damping().mass;
        let state = [pivot.as_slice(), &[1.0, 0.0, 0.0, 0.0], velocity.as_slice(), spin.as_slice()].concat();
        (Self { vectors, arms, is_position, mass, drag, inertia, turning, pinned }, state)
    }

    /// Writes positions and velocities of the body.
    fn place(&self, y: &[f64], q: &mut [f64], v: &mut [f64]) {
        let (pivot, turn, velocity, spin) = split(y);
        for ((index, arm), is_position) in self.vectors.clone().zip(&self.arms).zip(&self.is_position) {
            let arm = turn * arm;
            let shift = f64::from(u8::from(*is_position));
            q[3 * index..3 * index + 3].copy_from_slice((shift * pivot + arm).as_slice());
            v[3 * index..3 * index + 3].copy_from_slice((shift * velocity + spin.cross(&arm)).as_slice());
        }
    }

    /// The rate of the body's part of the state under the loads, and the power of loads and of damping.
    fn rate(&self, y: &[f64], loads: &[f64]) -> ([f64; NUMBERS], f64, f64) {
        let (_, turn, velocity, spin) = split(y);
        let rotation = turn.to_rotation_matrix();
        let inertia = rotation * self.inertia * rotation.transpose();
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for ((index, arm), is_position) in self.vectors.clone().zip(&self.arms).zip(&self.is_position) {
            let load = vector(loads, index);
            torque += (turn * arm).cross(&load);
            if *is_position {
                force += load;
            }
        }
        let power = force.dot(&velocity) + torque.dot(&spin);
        let angular = inertia * spin;
        let damping = self.drag * (self.mass * velocity.norm_squared() + spin.dot(&angular));
        let acceleration = if self.pinned { Vector3::zeros() } else { force / self.mass - self.drag * velocity };
        let angular_acceleration =
            self.turning.solve(&inertia, torque - self.drag * angular - self.turning.part(spin).cross(&angular));
        let turning = Quaternion::from_imag(0.5 * spin) * turn.into_inner();
        let mut rate = [0.0; NUMBERS];
        rate[..3].copy_from_slice(velocity.as_slice());
        rate[3..7].copy_from_slice(&[turning.w, turning.i, turning.j, turning.k]);
        rate[7..10].copy_from_slice(acceleration.as_slice());
        rate[10..].copy_from_slice(angular_acceleration.as_slice());
        (rate, power, damping)
    }

    /// Writes accelerations of the body.
    fn accelerate(&self, y: &[f64], rate: &[f64], a: &mut [f64]) {
        let (_, turn, _, spin) = split(y);
        let (acceleration, angular) = (vector(&rate[7..], 0), vector(&rate[10..], 0));
        for ((index, arm), is_position) in self.vectors.clone().zip(&self.arms).zip(&self.is_position) {
            let arm = turn * arm;
            let shift = f64::from(u8::from(*is_position));
            let of_arm = angular.cross(&arm) + spin.cross(&spin.cross(&arm));
            a[3 * index..3 * index + 3].copy_from_slice((shift * acceleration + of_arm).as_slice());
        }
    }
}

fn split(y: &[f64]) -> (Vector3<f64>, UnitQuaternion<f64>, Vector3<f64>, Vector3<f64>) {
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(y[3], y[4], y[5], y[6]));
    (vector(y, 0), turn, vector(&y[7..], 0), vector(&y[10..], 0))
}

/// All bodies in one step. The last two numbers of the state are the work of the loads and what damping has taken.
struct Rotors(Vec<Rotor>);

impl Rotors {
    fn new(equations: &Equations<'_>, now: &Instantaneous) -> (Self, Vec<f64>) {
        let n = now.q.len();
        let mut momenta = vec![0.0; n];
        equations.inertia.add_product(&now.v, &mut momenta);
        let mut work = vec![0.0; n];
        let bodies = equations.system.model().bodies().iter();
        let (rotors, parts): (Vec<_>, Vec<_>) =
            bodies.map(|body| Rotor::new(body, equations, &now.q, &momenta, &mut work)).unzip();
        let mut state = parts.concat();
        state.extend([now.work, now.dissipated]);
        (Self(rotors), state)
    }

    /// Sets `at` from the state, and returns the rate of the state there.
    fn rate(&self, equations: &Equations<'_>, y: &[f64], at: &mut Instantaneous) -> Vec<f64> {
        for (rotor, y) in self.0.iter().zip(y.chunks(NUMBERS)) {
            rotor.place(y, &mut at.q, &mut at.v);
        }
        equations.system.external_force(&at.q, at.t, &mut at.external);
        let mut rates = Vec::with_capacity(y.len());
        let mut work = 0.0;
        at.damping = 0.0;
        for (rotor, y) in self.0.iter().zip(y.chunks(NUMBERS)) {
            let (rate, power, damping) = rotor.rate(y, &at.external);
            rates.extend(rate);
            work += power;
            at.damping += damping;
        }
        rates.extend([work, at.damping]);
        rates
    }

    fn accelerate(&self, y: &[f64], rates: &[f64], a: &mut [f64]) {
        for ((rotor, y), rate) in self.0.iter().zip(y.chunks(NUMBERS)).zip(rates.chunks(NUMBERS)) {
            rotor.accelerate(y, rate, a);
        }
    }
}

impl Integrator for Rigid {
    fn order(&self) -> usize {
        DORMAND_PRINCE.order
    }

    fn error_order(&self) -> usize {
        DORMAND_PRINCE.embedded_order
    }

    /// Takes of the velocities their rigid part.
    fn begin(&self, equations: &mut Equations<'_>, at: &mut Instantaneous) -> Result<(), Failure> {
        let (rotors, state) = Rotors::new(equations, at);
        let rates = rotors.rate(equations, &state, at);
        rotors.accelerate(&state, &rates, &mut at.a);
        Ok(())
    }

    fn step(
        &self,
        equations: &mut Equations<'_>,
        now: &Instantaneous,
        next: &mut Instantaneous,
        error: &mut [f64],
        _observer: &dyn Observer,
    ) -> Result<(), Failure> {
        let h = next.t - now.t;
        let (rotors, start) = Rotors::new(equations, now);
        let mut at = now.clone();
        let mut stages: Vec<Vec<f64>> = Vec::new();
        let mut state = start.clone();
        for row in DORMAND_PRINCE.a {
            state.clone_from(&start);
            for (a, rates) in row.iter().zip(&stages) {
                for (y, rate) in state.iter_mut().zip(rates) {
                    *y += h * a * rate;
                }
            }
            at.t = now.t + h * row.iter().sum::<f64>();
            stages.push(rotors.rate(equations, &state, &mut at));
        }
        let rates = stages.last().expect("a tableau has stages");
        rotors.accelerate(&state, rates, &mut at.a);
        let fixed = equations.system.model().fixed();
        for i in (0..fixed.len()).filter(|i| fixed[*i]) {
            at.q[i] = now.q[i];
        }

        let weights = DORMAND_PRINCE.a[DORMAND_PRINCE.a.len() - 1];
        let mut missed = vec![0.0; state.len()];
        for (i, rates) in stages.iter().enumerate() {
            let difference = h * (weights.get(i).copied().unwrap_or(0.0) - DORMAND_PRINCE.embedded[i]);
            for (missed, rate) in missed.iter_mut().zip(rates) {
                *missed += difference * rate;
            }
        }
        for (rotor, missed) in rotors.0.iter().zip(missed.chunks(NUMBERS)) {
            let shift = vector(missed, 0) + CARRIED * h * vector(&missed[7..], 0);
            let turn = 2.0 * vector(&missed[4..], 0) + CARRIED * h * vector(&missed[10..], 0);
            for ((index, arm), is_position) in rotor.vectors.clone().zip(&rotor.arms).zip(&rotor.is_position) {
                let of_arm = turn.cross(arm) + if *is_position { shift } else { Vector3::zeros() };
                error[3 * index..3 * index + 3].copy_from_slice(of_arm.as_slice());
            }
        }
        let [.., work, dissipated] = state[..] else { unreachable!("work and dissipation are the last numbers") };
        *next = Instantaneous { t: next.t, lag: 0.0, work, dissipated, negative_pivots: None, ..at };
        Ok(())
    }
}
