//! Supports that move: rigid motions as functions of time.

use nalgebra::{Rotation3, Unit, Vector3};

use crate::error::InputError;

use super::knots::knots;

/// A number as a function of time (s), with its first and second derivative.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// `amplitude sin(2 pi frequency t)`.
    Sine {
        /// Largest value.
        amplitude: f64,
        /// Frequency, Hz.
        frequency: f64,
    },
    /// A smooth curve through given points, see [`Course::table`].
    Table(Spline),
}

impl Course {
    /// The smooth curve (cubic spline) through rows `[t, value]`. It is at rest before the first row and goes on with
    /// constant velocity after the last.
    ///
    /// # Errors
    ///
    /// At least two rows, all finite, the times strictly increasing; `argument` is what they are called.
    pub fn table(argument: &str, rows: Vec<[f64; 2]>) -> Result<Self, InputError> {
        let increasing = rows.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        let finite = rows.iter().flatten().all(|x| x.is_finite());
        let allowed = "at least two rows [t, value] of finite numbers, t strictly increasing";
        InputError::check(argument, format!("{rows:?}"), rows.len() > 1 && increasing && finite, allowed)?;
        Ok(Self::Table(Spline::new(rows)))
    }

    /// Value, first and second derivative.
    pub fn at(&self, t: f64) -> [f64; 3] {
        match self {
            Self::Sine { amplitude, frequency } => {
                let omega = std::f64::consts::TAU * frequency;
                let (sin, cos) = (omega * t).sin_cos();
                [amplitude * sin, amplitude * omega * cos, -amplitude * omega * omega * sin]
            }
            Self::Table(spline) => spline.at(t),
        }
    }

    /// Times between which the rows of a table are straight lines within `tolerance` of the largest value: steps that end
    /// there miss none of them.
    fn kinks(&self, tolerance: f64) -> Vec<f64> {
        if let Self::Table(spline) = self { knots(&spline.rows, tolerance) } else { Vec::new() }
    }
}

/// A cubic spline, at rest at its first point and not accelerated at its last.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    rows: Vec<[f64; 2]>,
    /// Second derivatives at the points.
    second: Vec<f64>,
}

impl Spline {
    /// # Source
    ///
    /// De Boor, A Practical Guide to Splines (2001), IV.
    fn new(rows: Vec<[f64; 2]>) -> Self {
        let n = rows.len();
        let step = |k: usize| rows[k + 1][0] - rows[k][0];
        let slope = |k: usize| (rows[k + 1][1] - rows[k][1]) / step(k);
        // Elimination in the tridiagonal equations for the second derivatives.
        let mut diagonal = vec![2.0 * step(0)];
        let mut second = vec![6.0 * slope(0)];
        for k in 1..n - 1 {
            let factor = step(k - 1) / diagonal[k - 1];
            diagonal.push(2.0 * (step(k - 1) + step(k)) - factor * step(k - 1));
            second.push(6.0 * (slope(k) - slope(k - 1)) - factor * second[k - 1]);
        }
        second.push(0.0);
        for k in (0..n - 1).rev() {
            second[k] = (second[k] - step(k) * second[k + 1]) / diagonal[k];
        }
        Self { rows, second }
    }

    fn at(&self, t: f64) -> [f64; 3] {
        let Self { rows, second } = self;
        let last = rows.len() - 1;
        if t <= rows[0][0] {
            return [rows[0][1], 0.0, if t == rows[0][0] { second[0] } else { 0.0 }];
        }
        if t > rows[last][0] {
            let [value, velocity, _] = self.at(rows[last][0]);
            return [value + velocity * (t - rows[last][0]), velocity, 0.0];
        }
        let k = rows.partition_point(|row| row[0] < t) - 1;
        let ([t0, f0], [t1, f1]) = (rows[k], rows[k + 1]);
        let h = t1 - t0;
        let s = t - t0;
        let slope = (f1 - f0) / h - h / 6.0 * (2.0 * second[k] + second[k + 1]);
        let third = (second[k + 1] - second[k]) / h;
        [
            f0 + s * (slope + s * (0.5 * second[k] + s * third / 6.0)),
            slope + s * (second[k] + 0.5 * s * third),
            second[k] + s * third,
        ]
    }
}

/// A rigid motion of a support: a rotation about a fixed axis, then a translation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SupportMotion {
    /// Directions and distances (m) of the translation, which are added.
    pub translation: Vec<([f64; 3], Course)>,
    /// A point of the axis, its direction, and the angle, rad.
    pub rotation: Option<([f64; 3], [f64; 3], Course)>,
}

impl SupportMotion {
    /// Checks the numbers.
    ///
    /// # Errors
    ///
    /// All must be finite, an axis must have a direction, and the motion must begin where the support is.
    pub(super) fn validate(&self) -> Result<(), InputError> {
        let courses = self.translation.iter().map(|(direction, course)| ("translation", direction, course));
        let courses = courses.chain(self.rotation.iter().map(|(_, axis, course)| ("rotation.angle", axis, course)));
        for (argument, direction, course) in courses {
            let finite = direction.iter().chain(&course.at(1.0)).all(|x| x.is_finite());
            InputError::check(argument, format!("{course:?}"), finite, "finite numbers")?;
            InputError::check(argument, course.at(0.0)[0], course.at(0.0)[0] == 0.0, "0 at time 0")?;
        }
        if let Some((_, axis, _)) = self.rotation {
            let length = Vector3::from(axis).norm();
            InputError::check("rotation.axis", format!("{axis:?}"), length > 0.0, "an axis that has a direction")?;
        }
        Ok(())
    }

    /// Times between which the rows of its tables are straight lines within `tolerance` of the largest value of each.
    pub(super) fn kinks(&self, tolerance: f64) -> Vec<f64> {
        let courses = self.translation.iter().map(|(_, course)| course);
        let courses = courses.chain(self.rotation.iter().map(|(_, _, angle)| angle));
        courses.flat_map(|course| course.kinks(tolerance)).collect()
    }

    /// Position, velocity and acceleration of a nodal vector whose reference value is `reference`: a position, which is
    /// moved, or a gradient, which is turned.
    pub(super) fn at(&self, t: f64, reference: [f64; 3], is_position: bool) -> [Vector3<f64>; 3] {
        let mut vector = [reference.into(), Vector3::zeros(), Vector3::zeros()];
        if let Some((center, axis, angle)) = &self.rotation {
            let center = if is_position { Vector3::from(*center) } else { Vector3::zeros() };
            let axis = Unit::new_normalize(Vector3::from(*axis));
            let [angle, rate, second] = angle.at(t);
            let arm = Rotation3::from_axis_angle(&axis, angle) * (vector[0] - center);
            let across = axis.cross(&arm);
            vector = [center + arm, rate * across, second * across + rate * rate * axis.cross(&across)];
        }
        if is_position {
            for (direction, course) in &self.translation {
                for (derivative, value) in vector.iter_mut().zip(course.at(t)) {
                    *derivative += value * Vector3::from(*direction);
                }
            }
        }
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn courses() -> Vec<Course> {
        let table = vec![[0.0, 0.0], [0.3, 0.5], [0.4, 0.7], [1.0, -0.2]];
        vec![Course::Sine { amplitude: 0.3, frequency: 2.0 }, Course::table("translation", table).unwrap()]
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        for course in courses() {
            for t in [0.05, 0.3, 0.35, 0.9, 1.2] {
                let h = 1e-5;
                let [before, at, after] = [t - h, t, t + h].map(|t| course.at(t));
                for i in 0..2 {
                    let difference = (after[i] - before[i]) / (2.0 * h);
                    assert!((difference - at[i + 1]).abs() < 1e-3, "{course:?} {t} {i}: {difference} {}", at[i + 1]);
                }
            }
        }
    }

    #[test]
    fn tables_pass_through_their_rows_and_begin_at_rest() {
        let course = &courses()[1];
        for (t, value) in [(0.0, 0.0), (0.3, 0.5), (0.4, 0.7), (1.0, -0.2)] {
            assert!((course.at(t)[0] - value).abs() < 1e-15);
        }
        assert!(course.at(1e-12)[1].abs() < 1e-9);
        assert!(course.at(1.0)[2].abs() < 1e-12);
    }

    /// Rotation about an axis: the velocity is `omega x arm`, the acceleration points to the axis at constant speed.
    #[test]
    fn a_turning_point_is_accelerated_towards_the_axis() {
        let rows = vec![[0.0, 0.0], [1.0, 1.0]];
        let spin = Course::table("rotation.angle", rows).unwrap();
        let speed = spin.at(2.0)[1];
        let motion = SupportMotion { rotation: Some(([1.0, 0.0, 0.0], [0.0, 0.0, 2.0], spin)), ..Default::default() };
        let [r, v, a] = motion.at(3.0, [3.0, 0.0, 0.5], true);
        let arm = r - Vector3::new(1.0, 0.0, 0.5);
        assert!((arm.norm() - 2.0).abs() < 1e-15);
        assert!((v - speed * Vector3::z().cross(&arm)).norm() < 1e-14);
        assert!((a + speed * speed * arm).norm() < 1e-14);
        let [gradient, ..] = motion.at(3.0, [1.0, 0.0, 0.0], false);
        assert!((gradient - arm / 2.0).norm() < 1e-14);
    }
}
