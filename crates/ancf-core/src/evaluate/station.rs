//! Points of elements: gradient vectors, strains and the frame of the reference surface.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use pulp::Scalar;

use crate::lanes::{Lanes, Vector};
use crate::model::{Body, Model};
use crate::strain::{Curvature, CurvatureLaw, Measure, Metric};

/// A point of an element: what the quantities there are made of.
pub(super) struct Station {
    vectors: Vec<usize>,
    /// `N`, `N_x`, `N_y`, `N_xx`, `N_yy`, `N_xy`.
    tables: [Vec<f64>; 6],
    /// The same of the vector through the thickness of a solid: `N_z`, `N_xz`, `N_yz`.
    director: Option<[Vec<f64>; 3]>,
    /// The reference position and its derivatives.
    pub reference: [Vector3<f64>; 6],
    /// Gradients of a solid in the reference state: `R_z`, `R_xz`, `R_yz`.
    reference_director: [Vector3<f64>; 3],
    pub frame: Frame,
    law: CurvatureLaw,
}

impl Station {
    pub fn new(model: &Model, body: &Body, element: usize, at: [f64; 2]) -> Self {
        let (vectors, tables) = body.shape(element, at);
        let director = body.director(at);
        let reference = tables.each_ref().map(|table| interpolate(table, &vectors, model.reference()));
        let of_director =
            |tables: &[Vec<f64>; 3]| tables.each_ref().map(|table| interpolate(table, &vectors, model.reference()));
        let reference_director = director.as_ref().map_or([Vector3::zeros(); 3], of_director);
        let frame = Frame::new(reference[1], reference[2]);
        Self { vectors, tables, director, reference, reference_director, frame, law: body.curvature() }
    }

    /// The position or one of its derivatives.
    pub fn interpolate(&self, derivative: usize, q: &[f64]) -> Vector3<f64> {
        interpolate(&self.tables[derivative], &self.vectors, q)
    }

    /// Covariant membrane strain `E_xx`, `E_yy`, `2 E_xy`.
    pub fn covariant_strain(&self, q: &[f64]) -> Vector3<f64> {
        let strain = |r: [Vector3<f64>; 2]| self.measure::<Metric<Scalar>, 2>((), r);
        strain([1, 2].map(|d| self.interpolate(d, q))) - strain([1, 2].map(|d| self.reference[d]))
    }

    /// `E_xx`, `E_yy`, `2 E_xy` in the frame.
    pub fn membrane_strain(&self, q: &[f64]) -> Vector3<f64> {
        self.frame.strain(self.covariant_strain(q))
    }

    /// Green-Lagrange strain of a solid at the height z, in the frame and the normal to it.
    ///
    /// # Source
    ///
    /// Dufva and Shabana (2005), (13).
    pub fn solid_strain(&self, z: f64, q: &[f64]) -> Matrix3<f64> {
        let director = self.director.as_ref().expect("the element is a solid");
        let [d, d_x, d_y] = director.each_ref().map(|table| interpolate(table, &self.vectors, q));
        let [e, e_x, e_y] = self.reference_director;
        let now = Matrix3::from_columns(&[self.interpolate(1, q) + z * d_x, self.interpolate(2, q) + z * d_y, d]);
        let rest = Matrix3::from_columns(&[self.reference[1] + z * e_x, self.reference[2] + z * e_y, e]);
        let [x, y] = self.frame.axes;
        let frame = Matrix3::from_columns(&[x, y, x.cross(&y)]);
        let gradient = now * rest.try_inverse().expect("a body is not degenerate") * frame;
        0.5 * (gradient.transpose() * gradient - Matrix3::identity())
    }

    /// `kappa_xx`, `kappa_yy`, `2 kappa_xy`.
    pub fn curvature(&self, q: &[f64]) -> Vector3<f64> {
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
pub(super) struct Frame {
    pub axes: [Vector3<f64>; 2],
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
    pub fn strain(&self, covariant: Vector3<f64>) -> Vector3<f64> {
        let half = 0.5 * covariant.z;
        let local = self.inverse.transpose() * Matrix2::new(covariant.x, half, half, covariant.y) * self.inverse;
        Vector3::new(local.m11, local.m22, 2.0 * local.m12)
    }

    /// The tensor with the components `xx`, `yy`, `xy`.
    pub fn tensor(&self, components: Vector3<f64>) -> Matrix3<f64> {
        let [x, y] = self.axes;
        components.x * x * x.transpose()
            + components.y * y * y.transpose()
            + components.z * (x * y.transpose() + y * x.transpose())
    }

    /// The gradient on the surface from derivatives with respect to the natural coordinates.
    pub fn gradient(&self, derivatives: [f64; 2]) -> Vector3<f64> {
        let along = self.inverse.transpose() * Vector2::from(derivatives);
        along.x * self.axes[0] + along.y * self.axes[1]
    }
}

/// `sum_a table_a e_a`.
fn interpolate(table: &[f64], vectors: &[usize], q: &[f64]) -> Vector3<f64> {
    table.iter().zip(vectors).map(|(t, v)| *t * Vector3::from_column_slice(&q[3 * v..3 * v + 3])).sum()
}
