//! What Python says in words or numbers: places, histories, names.

use ancf_core::InputError;
use ancf_core::mesh::Place;
use ancf_core::model::{Fix, History};
use pyo3::prelude::*;

use crate::errors::{checked, input_error};

/// A place on a body as Python says it.
#[derive(FromPyObject)]
pub enum At {
    /// "corner:x0y0", "edge:x1", "all".
    Name(String),
    /// A material point.
    Point([f64; 2]),
}

impl At {
    /// The place, if the name is that of one.
    pub fn place(self, py: Python<'_>) -> PyResult<Place> {
        match self {
            Self::Name(name) => checked(py, name.parse()),
            Self::Point(point) => Ok(Place::Point(point)),
        }
    }
}

/// A history as Python says it.
#[derive(FromPyObject)]
pub enum Factors {
    /// "constant", "ramp".
    Name(String),
    /// Rows [t, factor].
    Table(Vec<[f64; 2]>),
}

impl Factors {
    /// The history, if there is such a one.
    pub fn history(self, py: Python<'_>) -> PyResult<History> {
        match self {
            Self::Name(name) if name == "constant" => Ok(History::Constant),
            Self::Name(name) if name == "ramp" => Ok(History::Ramp),
            Self::Name(name) => {
                let error = InputError::new("history", format!("\"{name}\""), "constant, ramp, or rows [t, factor]");
                Err(input_error(py, &error))
            }
            Self::Table(rows) => checked(py, History::table(rows)),
        }
    }
}

/// The coordinates that a support fixes, from their names.
pub fn fixes(py: Python<'_>, names: &[String]) -> PyResult<Vec<Fix>> {
    names.iter().map(|name| checked(py, name.parse())).collect()
}

/// Finds what `name` names among `all`.
pub fn named<T: Copy>(
    py: Python<'_>,
    argument: &str,
    name: &str,
    all: &[T],
    name_of: fn(T) -> &'static str,
) -> PyResult<T> {
    let found = all.iter().copied().find(|item| name_of(*item) == name);
    let allowed = || all.iter().map(|item| name_of(*item)).collect::<Vec<_>>().join(", ");
    checked(py, found.ok_or_else(|| InputError::new(argument, format!("\"{name}\""), allowed())))
}
