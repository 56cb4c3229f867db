//! Quantities at material points.

use std::str::FromStr;

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use pulp::Scalar;

use crate::error::InputError;
use crate::lanes::{Lanes, Vector};
use crate::model::{Body, BodyId, Model, Plate};
use crate::quadrature::Rule;
use crate::strain::{Curvature, CurvatureLaw, Measure, Metric};

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
    /// Membrane force per length `N = h D E`: `xx`, `yy`, `xy`, N/m.
    MembraneForce,
    /// Bending moment per length `M = h^3/12 D kappa`: `xx`, `yy`, `xy`, N m/m.
    Moment,
    /// Transverse shear force per length, `xz`, `yz`, N/m, from the equilibrium of moments, `-div M`: what the part
    /// beyond a cut across x or y exerts along the normal.
    ShearForce,
    /// Second Piola-Kirchhoff stress `xx`, `yy`, `xy`, Pa, on the face that the normal `r_x x r_y` points to.
    StressTop,
    /// The same on the other face.
    StressBottom,
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Self; 11] = [
        Self::Position,
        Self::Displacement,
        Self::Velocity,
        Self::Normal,
        Self::MembraneStrain,
        Self::Curvature,
        Self::MembraneForce,
        Self::Moment,
        Self::ShearForce,
        Self::StressTop,
        Self::StressBottom,
    ];

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Normal => "normal",
            Self::MembraneStrain => "membrane_strain",
            Self::Curvature => "curvature",
            Self::MembraneForce => "membrane_force",
            Self::Moment => "moment",
            Self::ShearForce => "shear_force",
            Self::StressTop => "stress_top",
            Self::StressBottom => "stress_bottom",
        }
    }

    /// How many components it has.
    pub fn components(self) -> usize {
        if self == Self::ShearForce { 2 } else { 3 }
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

/// A quantity at a material point, ready to be evaluated in many states.
///
/// Strains, forces and stresses have their components in the orthonormal frame that the reference surface has at the
/// point: x along `R_x`, y across it in the tangent plane. Those of the solid elements are the ones of a thin plate with
/// their middle surface.
pub struct MaterialPoint {
    quantity: Quantity,
    plate: Plate,
    at: Station,
    /// For the shear force: points around, with the derivatives there of a field that is given at these points.
    around: Vec<(Station, [f64; 2])>,
}

impl MaterialPoint {
    /// A quantity at the point of a body with the given natural coordinates.
    ///
    /// # Errors
    ///
    /// The point must lie in the body.
    pub fn new(model: &Model, body: BodyId, point: [f64; 2], quantity: Quantity) -> Result<Self, InputError> {
        let body = model.body(body);
        let (element, at) = body.grid().locate(point)?;
        let station = |at| Station::new(model, body, element, at);
        let around = match quantity {
            Quantity::ShearForce => moment_points(body.grid().element_sides(), at)
                .map(|(point, derivative)| (station(point), derivative))
                .collect(),
            _ => Vec::new(),
        };
        Ok(Self { quantity, plate: *body.plate(), at: station(at), around })
    }

    /// The components at nodal coordinates `q` and velocities `v`; of two components, the third is zero.
    pub fn evaluate(&self, q: &[f64], v: &[f64]) -> [f64; 3] {
        let (at, h) = (&self.at, self.plate.thickness);
        let stiffness = self.plate.material.plane_stress([1.0, 1.0, 0.0]);
        let stress = |strain: Vector3<f64>| Vector3::from(stiffness.map(|row| Vector3::from(row).dot(&strain)));
        let moment = |station: &Station| h.powi(3) / 12.0 * stress(station.curvature(q));
        let face = |side: f64| stress(at.membrane_strain(q) - side * 0.5 * h * at.curvature(q));
        let values = match self.quantity {
            Quantity::Position => at.interpolate(0, q),
            Quantity::Displacement => at.interpolate(0, q) - at.reference[0],
            Quantity::Velocity => at.interpolate(0, v),
            Quantity::Normal => at.interpolate(1, q).cross(&at.interpolate(2, q)).normalize(),
            Quantity::MembraneStrain => at.membrane_strain(q),
            Quantity::Curvature => at.curvature(q),
            Quantity::MembraneForce => h * stress(at.membrane_strain(q)),
            Quantity::Moment => moment(at),
            Quantity::ShearForce => {
                let moments = self.around.iter().map(|(station, by)| (station.frame.tensor(moment(station)), by));
                let divergence: Vector3<f64> = moments.map(|(m, by)| m * at.frame.gradient(*by)).sum();
                let [x, y] = at.frame.axes;
                Vector3::new(-divergence.dot(&x), -divergence.dot(&y), 0.0)
            }
            Quantity::StressTop => face(1.0),
            Quantity::StressBottom => face(-1.0),
        };
        values.into()
    }
}

/// The 2 x 2 Gauss points of an element, where moments are most accurate, and the derivatives at `at` along x and y of
/// the bilinear function that is one at each of them.
fn moment_points([l, w]: [f64; 2], at: [f64; 2]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    let points: Vec<f64> = Rule::Gauss(2).points().into_iter().map(|(x, _)| x).collect();
    let slope = 1.0 / (points[1] - points[0]);
    let linear = [0, 1].map(|i| [(points[1] - at[i]) * slope, (at[i] - points[0]) * slope]);
    let slopes = [-slope, slope];
    (0..4).map(move |k| {
        let [i, j] = [k % 2, k / 2];
        ([points[i], points[j]], [slopes[i] * linear[1][j] / l, linear[0][i] * slopes[j] / w])
    })
}

/// A point of an element: what the quantities there are made of.
struct Station {
    vectors: Vec<usize>,
    /// `N`, `N_x`, `N_y`, `N_xx`, `N_yy`, `N_xy`.
    tables: [Vec<f64>; 6],
    /// The reference position and its derivatives.
    reference: [Vector3<f64>; 6],
    frame: Frame,
    law: CurvatureLaw,
}

impl Station {
    fn new(model: &Model, body: &Body, element: usize, at: [f64; 2]) -> Self {
        let (vectors, tables) = body.shape(element, at);
        let reference = tables.each_ref().map(|table| interpolate(table, &vectors, model.reference()));
        let frame = Frame::new(reference[1], reference[2]);
        Self { vectors, tables, reference, frame, law: body.curvature() }
    }

    fn interpolate(&self, derivative: usize, q: &[f64]) -> Vector3<f64> {
        interpolate(&self.tables[derivative], &self.vectors, q)
    }

    /// `E_xx`, `E_yy`, `2 E_xy`.
    fn membrane_strain(&self, q: &[f64]) -> Vector3<f64> {
        let strain = |r: [Vector3<f64>; 2]| self.measure::<Metric<Scalar>, 2>((), r);
        self.frame.strain(strain([1, 2].map(|d| self.interpolate(d, q))) - strain([1, 2].map(|d| self.reference[d])))
    }

    /// `kappa_xx`, `kappa_yy`, `2 kappa_xy`.
    fn curvature(&self, q: &[f64]) -> Vector3<f64> {
        const ORDER: [usize; 5] = [1, 2, 3, 4, 5];
        let strain = |r: [Vector3<f64>; 5]| self.measure::<Curvature<Scalar>, 5>(self.law, r);
        self.frame.strain(strain(ORDER.map(|d| self.interpolate(d, q))) - strain(ORDER.map(|d| self.reference[d])))
    }

    /// A strain measure for the given gradient vectors, covariant components.
    fn measure<M: Measure<Scalar, D, 3>, const D: usize>(
        &self,
        law: M::Law,
        gradients: [Vector3<f64>; D],
    ) -> Vector3<f64> {
        let splat = |x: f64| Lanes::splat(Scalar::new(), x);
        let area = self.reference[1].cross(&self.reference[2]).norm();
        let lanes: [Vector<Scalar>; D] = gradients.map(|g| [splat(g.x), splat(g.y), splat(g.z)]);
        M::new(law, lanes, splat(area)).strain().map(Lanes::value).into()
    }
}

/// The orthonormal frame of the reference surface.
struct Frame {
    axes: [Vector3<f64>; 2],
    /// Derivatives of the natural coordinates along the axes: `dx^a / ds_i` in row a, column i.
    inverse: Matrix2<f64>,
}

impl Frame {
    fn new(x: Vector3<f64>, y: Vector3<f64>) -> Self {
        let first = x.normalize();
        let second = (y - first.dot(&y) * first).normalize();
        let (x_length, along, across) = (x.norm(), first.dot(&y), second.dot(&y));
        let inverse = Matrix2::new(1.0 / x_length, -along / (x_length * across), 0.0, 1.0 / across);
        Self { axes: [first, second], inverse }
    }

    /// Components in the frame from covariant ones; `xy` doubled in both.
    ///
    /// # Source
    ///
    /// Dufva and Shabana (2005), (33), (34).
    fn strain(&self, covariant: Vector3<f64>) -> Vector3<f64> {
        let half = 0.5 * covariant.z;
        let local = self.inverse.transpose() * Matrix2::new(covariant.x, half, half, covariant.y) * self.inverse;
        Vector3::new(local.m11, local.m22, 2.0 * local.m12)
    }

    /// The tensor with the components `xx`, `yy`, `xy`.
    fn tensor(&self, components: Vector3<f64>) -> Matrix3<f64> {
        let [x, y] = self.axes;
        components.x * x * x.transpose()
            + components.y * y * y.transpose()
            + components.z * (x * y.transpose() + y * x.transpose())
    }

    /// The gradient on the surface from derivatives with respect to the natural coordinates.
    fn gradient(&self, derivatives: [f64; 2]) -> Vector3<f64> {
        let along = self.inverse.transpose() * Vector2::from(derivatives);
        along.x * self.axes[0] + along.y * self.axes[1]
    }
}

/// `sum_a table_a e_a`.
fn interpolate(table: &[f64], vectors: &[usize], q: &[f64]) -> Vector3<f64> {
    table.iter().zip(vectors).map(|(t, v)| *t * Vector3::from_column_slice(&q[3 * v..3 * v + 3])).sum()
}
