//! Reference surfaces.

use ancf_core::mesh::{Surface, SurfacePoint};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::arrays::states;
use crate::errors::checked;

/// A reference surface over two natural coordinates.
#[pyclass(frozen, module = "ancf._core")]
pub struct Shape(pub Surface);

#[pymethods]
impl Shape {
    /// A flat rectangle in the X-Y plane with the given sides, m.
    #[staticmethod]
    fn rectangle(py: Python<'_>, size: [f64; 2]) -> PyResult<Self> {
        Ok(Self(checked(py, Surface::rectangle(size))?))
    }

    /// A flat sector of an annulus in the X-Y plane.
    #[staticmethod]
    fn annulus(py: Python<'_>, radii: [f64; 2], angle: f64) -> PyResult<Self> {
        Ok(Self(checked(py, Surface::annulus(radii, angle))?))
    }

    /// A part of a circular cylinder about the Z axis.
    #[staticmethod]
    fn cylinder(py: Python<'_>, radius: f64, angle: [f64; 2], length: [f64; 2]) -> PyResult<Self> {
        Ok(Self(checked(py, Surface::cylinder(radius, angle, length))?))
    }

    /// A part of a sphere about the origin.
    #[staticmethod]
    fn sphere(py: Python<'_>, radius: f64, longitude: [f64; 2], latitude: [f64; 2]) -> PyResult<Self> {
        Ok(Self(checked(py, Surface::sphere(radius, longitude, latitude))?))
    }

    /// A surface given at the nodes of a grid.
    #[staticmethod]
    fn nodes(
        py: Python<'_>,
        domain: [[f64; 2]; 2],
        divisions: [usize; 2],
        points: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Self> {
        let point = |p: Vec<f64>| {
            let vector = |i: usize| [p[i], p[i + 1], p[i + 2]];
            SurfacePoint { r: vector(0), r_x: vector(3), r_y: vector(6), r_xy: vector(9) }
        };
        let points = states(py, "points", &points, 12)?.into_iter().map(point).collect();
        Ok(Self(checked(py, Surface::from_nodes(domain, divisions, points))?))
    }
}
