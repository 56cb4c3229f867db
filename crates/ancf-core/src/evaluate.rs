//! Quantities at material points.

use std::str::FromStr;

use nalgebra::Vector3;
use pulp::Scalar;

use crate::error::InputError;
use crate::lanes::{Lanes, Vector};
use crate::model::{BodyId, Model};
use crate::strain::{Curvature, Measure, Metric};

/// What can be evaluated at a material point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Position, m.
    Position,
    /// Displacement from the reference position, m.
    Displacement,
    /// Velocity, m/s.
    Velocity,
    /// Unit normal along `r_x x r_y`.
    Normal,
    /// Membrane strain `E_xx`, `E_yy`, `2 E_xy`: Dufva and Shabana (2005), (30), (31).
    MembraneStrain,
    /// Change of curvature `kappa_xx`, `kappa_yy`, `2 kappa_xy`, 1/m: Dufva and Shabana (2005), (32).
    Curvature,
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Self; 6] =
        [Self::Position, Self::Displacement, Self::Velocity, Self::Normal, Self::MembraneStrain, Self::Curvature];

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Normal => "normal",
            Self::MembraneStrain => "membrane_strain",
            Self::Curvature => "curvature",
        }
    }
}

impl FromStr for Quantity {
    type Err = InputError;

    fn from_str(name: &str) -> Result<Self, InputError> {
        Self::ALL
            .into_iter()
            .find(|quantity| quantity.name() == name)
            .ok_or_else(|| InputError::new("quantity", format!("\"{name}\""), Self::ALL.map(Self::name).join(", ")))
    }
}

/// A material point, ready to be evaluated in many states.
pub struct MaterialPoint {
    vectors: Vec<usize>,
    /// `N`, `N_x`, `N_y`, `N_xx`, `N_yy`, `N_xy`.
    tables: [Vec<f64>; 6],
    /// The reference position and its derivatives.
    reference: [Vector3<f64>; 6],
    law: crate::strain::CurvatureLaw,
}

impl MaterialPoint {
    /// The point of a body with the given natural coordinates.
    ///
    /// # Errors
    ///
    /// The point must lie in the body.
    pub fn new(model: &Model, body: BodyId, point: [f64; 2]) -> Result<Self, InputError> {
        let law = model.body(body).curvature();
        let (element, at) = model.body(body).grid().locate(point)?;
        let (vectors, tables) = model.body(body).shape(element, at);
        let reference = tables.each_ref().map(|table| interpolate(table, &vectors, model.reference()));
        Ok(Self { vectors, tables, reference, law })
    }

    /// A quantity at nodal coordinates `q` and velocities `v`: three components.
    pub fn evaluate(&self, quantity: Quantity, q: &[f64], v: &[f64]) -> [f64; 3] {
        let at = |derivative: usize| interpolate(&self.tables[derivative], &self.vectors, q);
        let vector: Vector3<f64> = match quantity {
            Quantity::Position => at(0),
            Quantity::Displacement => at(0) - self.reference[0],
            Quantity::Velocity => interpolate(&self.tables[0], &self.vectors, v),
            Quantity::Normal => at(1).cross(&at(2)).normalize(),
            Quantity::MembraneStrain => {
                let strain = |r: [Vector3<f64>; 2]| self.measure::<Metric<Scalar>, 2>((), r);
                return difference(strain([at(1), at(2)]), strain([self.reference[1], self.reference[2]]));
            }
            Quantity::Curvature => {
                let strain = |r: [Vector3<f64>; 5]| self.measure::<Curvature<Scalar>, 5>(self.law, r);
                let [_, x, y, xx, yy, xy] = self.reference;
                return difference(strain([at(1), at(2), at(3), at(4), at(5)]), strain([x, y, xx, yy, xy]));
            }
        };
        vector.into()
    }

    /// A strain measure for the given gradient vectors.
    fn measure<M: Measure<Scalar, D, 3>, const D: usize>(&self, law: M::Law, gradients: [Vector3<f64>; D]) -> [f64; 3] {
        let splat = |x: f64| Lanes::splat(Scalar::new(), x);
        let area = self.reference[1].cross(&self.reference[2]).norm();
        let lanes: [Vector<Scalar>; D] = gradients.map(|g| [splat(g.x), splat(g.y), splat(g.z)]);
        M::new(law, lanes, splat(area)).strain().map(Lanes::value)
    }
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `sum_a table_a e_a`.
fn interpolate(table: &[f64], vectors: &[usize], q: &[f64]) -> Vector3<f64> {
    table.iter().zip(vectors).map(|(t, v)| *t * Vector3::from_column_slice(&q[3 * v..3 * v + 3])).sum()
}
