//! Reference surfaces.

use ancf_core::mesh::Surface;
use pyo3::prelude::*;

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
}
