//! What a solve leaves.

use ancf_core::observe::State;
use ancf_core::report::{self, Outcome};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{matrix, stack, vector};

/// Every output of a solve up to its end, and how it ended.
#[pyclass(frozen, module = "ancf._core")]
pub struct Run {
    /// None if the solve did not answer in time after it was stopped.
    end: Option<report::Run>,
    states: Vec<State>,
    coordinates: usize,
    reached: f64,
    /// Why the last checkpoint could not be written.
    unsaved: Option<std::io::Error>,
    exception: Option<PyErr>,
}

impl Run {
    /// Puts together what a solve left.
    pub fn new(
        end: Option<report::Run>,
        states: Vec<State>,
        coordinates: usize,
        reached: f64,
        unsaved: Option<std::io::Error>,
        exception: Option<PyErr>,
    ) -> Self {
        Self { end, states, coordinates, reached, unsaved, exception }
    }

    fn series<'py>(&self, py: Python<'py>, number: impl Fn(&State) -> f64) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.states.iter().map(number).collect())
    }

    fn table<'py, 's>(
        &'s self,
        py: Python<'py>,
        columns: usize,
        row: impl Fn(&'s State) -> &'s [f64],
    ) -> Bound<'py, PyArray2<f64>> {
        let mut values = Vec::with_capacity(columns * self.states.len());
        for state in &self.states {
            values.extend_from_slice(row(state));
        }
        if self.states.is_empty() {
            return PyArray2::zeros(py, [0, columns], false);
        }
        matrix(py, columns, values)
    }
}

#[pymethods]
impl Run {
    #[getter]
    fn status(&self) -> &'static str {
        match self.end.as_ref().map(|end| &end.outcome) {
            Some(Outcome::Ok) => "ok",
            Some(Outcome::Failed(_)) => "failed",
            Some(Outcome::Interrupted) | None => "interrupted",
        }
    }

    #[getter]
    fn reason(&self) -> String {
        match self.end.as_ref().map(|end| &end.outcome) {
            Some(Outcome::Ok) => String::new(),
            Some(Outcome::Failed(failure)) => failure.to_string(),
            Some(Outcome::Interrupted) | None => "stopped on request".to_owned(),
        }
    }

    #[getter]
    fn unsaved(&self) -> Option<String> {
        self.unsaved.as_ref().map(ToString::to_string)
    }

    #[getter]
    fn advice(&self) -> &'static str {
        match self.end.as_ref().map(|end| &end.outcome) {
            Some(Outcome::Ok) => "",
            Some(Outcome::Failed(failure)) => failure.advice(),
            Some(Outcome::Interrupted) | None => "run it again; a motion with a checkpoint goes on from there",
        }
    }

    #[getter]
    fn reached(&self) -> f64 {
        self.end.as_ref().map_or(self.reached, |end| end.reached)
    }

    #[getter]
    fn jumps<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.end.as_ref().map(|end| end.jumps.clone()).unwrap_or_default())
    }

    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.series(py, |state| state.t)
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.table(py, self.coordinates, |state| &state.q)
    }

    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.table(py, self.coordinates, |state| &state.v)
    }

    #[getter]
    fn a<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.table(py, self.coordinates, |state| &state.a)
    }

    #[getter]
    fn energy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let energy = PyDict::new(py);
        energy.set_item("kinetic", self.series(py, |state| state.kinetic))?;
        energy.set_item("membrane", self.series(py, |state| state.strain.membrane))?;
        energy.set_item("bending", self.series(py, |state| state.strain.bending))?;
        energy.set_item("loads", self.series(py, |state| state.work))?;
        energy.set_item("dissipated", self.series(py, |state| state.dissipated))?;
        Ok(energy)
    }

    #[getter]
    fn momentum<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.table(py, 3, |state| &state.momentum)
    }

    #[getter]
    fn angular_momentum<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.table(py, 3, |state| &state.angular_momentum)
    }

    /// Of each state and support: point, force, moment.
    #[getter]
    fn reactions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        let supports = self.states.first().map_or(0, |state| state.reactions.len());
        let all = self.states.iter().flat_map(|state| &state.reactions);
        let values = all.flat_map(|r| [r.point, r.force, r.moment]).flatten().collect();
        stack(py, (self.states.len(), supports, 9), values)
    }

    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let counts = self.end.as_ref().map(|end| end.counts).unwrap_or_default();
        let dictionary = PyDict::new(py);
        dictionary.set_item("elements", counts.elements)?;
        dictionary.set_item("dofs", counts.dofs)?;
        dictionary.set_item("steps", counts.steps)?;
        dictionary.set_item("rejected", counts.rejected.total())?;
        dictionary.set_item("inaccurate", counts.rejected.inaccurate)?;
        dictionary.set_item("unsolved", counts.rejected.unsolved)?;
        dictionary.set_item("singular", counts.rejected.singular)?;
        dictionary.set_item("not_finite", counts.rejected.not_finite)?;
        dictionary.set_item("iterations", counts.iterations)?;
        dictionary.set_item("forces", counts.forces)?;
        dictionary.set_item("factorizations", counts.factorizations)?;
        Ok(dictionary)
    }

    #[getter]
    fn seconds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let seconds = self.end.as_ref().map(|end| end.seconds).unwrap_or_default();
        let dictionary = PyDict::new(py);
        dictionary.set_item("total", seconds.total)?;
        dictionary.set_item("setup", seconds.setup)?;
        dictionary.set_item("assembly", seconds.assembly)?;
        dictionary.set_item("factorization", seconds.factorization)?;
        dictionary.set_item("solve", seconds.solve)?;
        Ok(dictionary)
    }

    #[getter]
    fn negative_pivots<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let count = |state: &State| state.negative_pivots.map_or(-1, |n| n as i64);
        vector(py, self.states.iter().map(count).collect())
    }

    #[getter]
    fn exception(&self, py: Python<'_>) -> Option<PyErr> {
        self.exception.as_ref().map(|error| error.clone_ref(py))
    }
}
