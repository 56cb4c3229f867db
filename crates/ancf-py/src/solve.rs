//! Solves: their options as Python says them.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use ancf_core::dynamics::{self, Checkpoint, Method, Steps, Tolerances};
use ancf_core::nonlinear::{Options as NewtonOptions, Variant};
use ancf_core::statics::Control;
use ancf_core::{InputError, modes as oscillations, statics};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::arrays::{coordinates, matrix, vector};
use crate::background::run;
use crate::errors::{checked, input_error};
use crate::model::Model;
use crate::run::Run;

fn newton_options(
    py: Python<'_>,
    newton: &str,
    tolerance: f64,
    max_iterations: usize,
    reuse: bool,
) -> PyResult<NewtonOptions> {
    let variant = match newton {
        "mip" => Variant::MixedIntegrationPoint,
        "plain" => Variant::Plain,
        _ => return Err(input_error(py, &InputError::new("newton", format!("\"{newton}\""), "mip, plain"))),
    };
    Ok(NewtonOptions { variant, tolerance, max_iterations, reuse })
}

/// Finds equilibria along a load path.
#[pyfunction]
#[pyo3(signature = (model, *, load_factors, path, newton, tolerance, max_iterations, first_step, min_step, max_steps, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
pub fn solve_static(
    py: Python<'_>,
    model: &Model,
    load_factors: Vec<f64>,
    path: &str,
    newton: &str,
    tolerance: f64,
    max_iterations: usize,
    first_step: Option<f64>,
    min_step: f64,
    max_steps: usize,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Run> {
    let newton = newton_options(py, newton, tolerance, max_iterations, false)?;
    let control = match path {
        "load" => Control::Load,
        "arc" => Control::Arc,
        _ => return Err(input_error(py, &InputError::new("path", format!("\"{path}\""), "load, arc"))),
    };
    let options = statics::Options { control, load_factors, newton, first_step, min_step, max_steps };
    run(py, model, threads, progress, Vec::new(), None, move |system, observer| {
        statics::solve(system, &options, observer)
    })
}

/// The length of steps as Python says it.
#[derive(FromPyObject)]
pub enum StepLength {
    /// Fixed steps: their length, s, and whether an explicit method may exceed its limit.
    #[pyo3(transparent)]
    Fixed((f64, bool)),
    /// Error control: `rtol`, `atol`, first, longest and shortest step.
    #[pyo3(transparent)]
    Controlled((f64, f64, Option<f64>, Option<f64>, f64)),
}

impl From<StepLength> for Steps {
    fn from(length: StepLength) -> Self {
        match length {
            StepLength::Fixed((step, force)) => Self::Fixed { step, force },
            StepLength::Controlled((rtol, atol, first_step, max_step, min_step)) => {
                let max_step = max_step.unwrap_or(f64::INFINITY);
                Self::Controlled(Tolerances { rtol, atol, first_step, max_step, min_step })
            }
        }
    }
}

/// Integrates a motion.
#[pyfunction]
#[pyo3(signature = (model, *, until, steps, method, alpha, rho_inf, lumped, outputs, velocity, newton, tolerance, max_iterations, reuse, checkpoint, resume, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
pub fn simulate(
    py: Python<'_>,
    model: &Model,
    until: f64,
    steps: StepLength,
    method: &str,
    alpha: Option<f64>,
    rho_inf: Option<f64>,
    lumped: bool,
    outputs: Vec<f64>,
    velocity: Option<PyReadonlyArray1<'_, f64>>,
    newton: &str,
    tolerance: f64,
    max_iterations: usize,
    reuse: bool,
    checkpoint: Option<PathBuf>,
    resume: Option<PathBuf>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Run> {
    let newton = newton_options(py, newton, tolerance, max_iterations, reuse)?;
    let method = match checked(py, Method::find(method))? {
        Method::Hht { alpha: usual } => Method::Hht { alpha: alpha.unwrap_or(usual) },
        Method::GeneralizedAlpha { rho_inf: usual } => Method::GeneralizedAlpha { rho_inf: rho_inf.unwrap_or(usual) },
        Method::Verlet { .. } => Method::Verlet { lumped },
        other => other,
    };
    let n = model.core().reference().len();
    let velocity = velocity.map(|v| coordinates(py, "velocity", &v, n)).transpose()?;
    let options = dynamics::Options { until, steps: steps.into(), method, outputs, velocity, newton };
    let mut states = Vec::new();
    let mut from = None;
    if let Some(path) = resume {
        let (checkpoint, before) = checked(py, Checkpoint::from_bytes(&std::fs::read(path)?))?;
        (from, states) = (Some(checkpoint), before);
    }
    run(py, model, threads, progress, states, checkpoint, move |system, observer| {
        dynamics::simulate(system, &options, from, observer)
    })
}

/// The run, the squared circular frequencies and the shapes.
type Modes<'py> = (Run, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);

/// Finds the modes with the smallest eigenvalues about a state.
#[pyfunction]
#[pyo3(signature = (model, *, count, q, load_factor, threads, progress))]
pub fn modes<'py>(
    py: Python<'py>,
    model: &Model,
    count: usize,
    q: PyReadonlyArray1<'py, f64>,
    load_factor: f64,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Modes<'py>> {
    let n = model.core().reference().len();
    let q = coordinates(py, "q", &q, n)?;
    let options = oscillations::Options { count, q, t: load_factor };
    let found = Arc::new(Mutex::new(Vec::new()));
    let place = Arc::clone(&found);
    let run = run(py, model, threads, progress, Vec::new(), None, move |system, observer| {
        let (modes, run) = oscillations::solve(system, &options, observer)?;
        *place.lock().unwrap_or_else(PoisonError::into_inner) = modes;
        Ok(run)
    })?;
    let modes = found.lock().unwrap_or_else(PoisonError::into_inner);
    let eigenvalues = vector(py, modes.iter().map(|mode| mode.eigenvalue).collect());
    let shapes = if modes.is_empty() {
        PyArray2::zeros(py, [0, n], false)
    } else {
        matrix(py, n, modes.iter().flat_map(|mode| mode.shape.iter().copied()).collect())
    };
    Ok((run, eigenvalues, shapes))
}
