//! Errors as Python sees them.

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

create_exception!(
    ancf._core,
    InputError,
    PyValueError,
    "A value that cannot be used: `argument` names it, `value` shows it, `allowed` says what would do."
);

/// The Python exception for an error of the core.
pub fn input_error(py: Python<'_>, error: &ancf_core::InputError) -> PyErr {
    let exception = InputError::new_err(error.to_string());
    let value = exception.value(py);
    let set = [("argument", &error.argument), ("value", &error.value), ("allowed", &error.allowed)]
        .into_iter()
        .try_for_each(|(name, text)| value.setattr(name, text));
    set.err().unwrap_or(exception)
}

/// The value, or the Python exception for the error.
pub fn checked<T>(py: Python<'_>, result: Result<T, ancf_core::InputError>) -> PyResult<T> {
    result.map_err(|error| input_error(py, &error))
}
