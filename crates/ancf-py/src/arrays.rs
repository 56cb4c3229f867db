//! NumPy arrays in and out.

use ancf_core::InputError;
use numpy::ndarray::{Array2, Array3};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::errors::checked;

/// The numbers of a vector over all nodal coordinates.
pub fn coordinates(py: Python<'_>, name: &str, array: &PyReadonlyArray1<'_, f64>, n: usize) -> PyResult<Vec<f64>> {
    let values = array.as_array().to_vec();
    let found = values.len();
    checked(py, if found == n { Ok(values) } else { Err(InputError::new(name, shape(&[found]), shape(&[n]))) })
}

/// The states of an array (states, n).
pub fn states(py: Python<'_>, name: &str, array: &PyReadonlyArray2<'_, f64>, n: usize) -> PyResult<Vec<Vec<f64>>> {
    let array = array.as_array();
    if array.ncols() != n {
        let error = InputError::new(name, shape(array.shape()), format!("shape (states, {n})"));
        return checked(py, Err(error));
    }
    Ok(array.rows().into_iter().map(|row| row.to_vec()).collect())
}

fn shape(lengths: &[usize]) -> String {
    let lengths: Vec<_> = lengths.iter().map(ToString::to_string).collect();
    format!("shape ({})", lengths.join(", "))
}

/// A one-dimensional array.
pub fn vector<T: numpy::Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    values.into_pyarray(py)
}

/// A two-dimensional array from its rows put together.
pub fn matrix<T: numpy::Element>(py: Python<'_>, columns: usize, values: Vec<T>) -> Bound<'_, PyArray2<T>> {
    let rows = values.len().checked_div(columns).unwrap_or(0);
    Array2::from_shape_vec((rows, columns), values).expect("whole rows").into_pyarray(py)
}

/// A three-dimensional array from its parts put together.
pub fn stack(py: Python<'_>, lengths: (usize, usize, usize), values: Vec<f64>) -> Bound<'_, PyArray3<f64>> {
    Array3::from_shape_vec(lengths, values).expect("as many numbers as the shape says").into_pyarray(py)
}
