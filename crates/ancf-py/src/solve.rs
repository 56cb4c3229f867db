//! Running a solve: it works in a thread of its own, while Python's thread shows progress and listens for Ctrl-C.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use ancf_core::assembly::System;
use ancf_core::dynamics::{self, GeneralizedAlpha};
use ancf_core::linear::LinearError;
use ancf_core::nonlinear::{Options as NewtonOptions, Variant};
use ancf_core::observe::{Observer, State};
use ancf_core::statics::Control;
use ancf_core::{InputError, model, report, statics};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;

use crate::arrays::coordinates;
use crate::errors::{checked, input_error};
use crate::model::Model;
use crate::run::Run;

/// How often Python hears of progress and is asked for signals.
const PERIOD: Duration = Duration::from_millis(50);
/// How long a solve that was stopped may take to answer; it is left behind after that.
const PATIENCE: Duration = Duration::from_millis(100);

/// What a solve tells while it runs.
enum Event {
    State(State),
    Reached(f64),
    End(Result<report::Run, SolveError>),
}

/// Why a solve could not start.
enum SolveError {
    Input(InputError),
    Memory(LinearError),
    Threads(rayon::ThreadPoolBuildError),
}

/// Sends what a solve tells to Python's thread.
struct Messenger {
    events: Sender<Event>,
    stop: Arc<AtomicBool>,
    told: Instant,
}

impl Observer for Messenger {
    fn state(&mut self, state: State) {
        // Nobody listens any more when the solve was left behind; it stops at its next iteration.
        let _ = self.events.send(Event::State(state));
    }

    fn reached(&mut self, t: f64) {
        if self.told.elapsed() >= PERIOD {
            self.told = Instant::now();
            let _ = self.events.send(Event::Reached(t));
        }
    }

    fn stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Runs `solve` for a model in a thread of its own.
fn run(
    py: Python<'_>,
    model: &Model,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    solve: impl FnOnce(&mut System, &mut dyn Observer) -> Result<report::Run, InputError> + Send + 'static,
) -> PyResult<Run> {
    let model = model.core();
    let coordinates = model.reference().len();
    let (events, mut receiver) = channel();
    let stop = Arc::new(AtomicBool::new(false));
    let mut messenger = Messenger { events: events.clone(), stop: Arc::clone(&stop), told: Instant::now() };
    let work = move || start(model, threads, &mut messenger, solve);
    let worker = thread::spawn(move || {
        let end = work();
        let _ = events.send(Event::End(end));
    });

    let mut states = Vec::new();
    let mut reached = 0.0;
    let mut told = Instant::now();
    let exception = loop {
        match py.detach(|| receive(&mut receiver, PERIOD)) {
            Ok(Event::State(state)) => states.push(state),
            Ok(Event::Reached(t)) => reached = t,
            Ok(Event::End(end)) => {
                // A signal that came just before the end counts.
                let exception = py.check_signals().err();
                return finish(py, end, states, coordinates, reached, exception);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                let _ = worker.join();
                return Err(PyRuntimeError::new_err("the solve ended by a fault of the program: please report it"));
            }
        }
        if told.elapsed() >= PERIOD {
            told = Instant::now();
            let call = progress.map(|call| call.call1((reached,))).transpose();
            if let Err(error) = py.check_signals().and(call.map(|_| ())) {
                break error;
            }
        }
    };

    stop.store(true, Ordering::Relaxed);
    let deadline = Instant::now() + PATIENCE;
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        match py.detach(|| receive(&mut receiver, left)) {
            Ok(Event::State(state)) => states.push(state),
            Ok(Event::Reached(t)) => reached = t,
            Ok(Event::End(end)) => return finish(py, end, states, coordinates, reached, Some(exception)),
            Err(_) => return Ok(Run::new(None, states, coordinates, reached, Some(exception))),
        }
    }
}

/// What comes next, without Python's lock.
fn receive(events: &mut Receiver<Event>, timeout: Duration) -> Result<Event, RecvTimeoutError> {
    events.recv_timeout(timeout)
}

/// Makes the system and solves, on the wanted number of threads.
fn start(
    model: Arc<model::Model>,
    threads: Option<usize>,
    messenger: &mut Messenger,
    solve: impl FnOnce(&mut System, &mut dyn Observer) -> Result<report::Run, InputError> + Send,
) -> Result<report::Run, SolveError> {
    let work = || {
        let mut system = System::new(model).map_err(SolveError::Memory)?;
        solve(&mut system, messenger).map_err(SolveError::Input)
    };
    match threads {
        None => work(),
        Some(count) => {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().map_err(SolveError::Threads)?;
            pool.install(work)
        }
    }
}

fn finish(
    py: Python<'_>,
    end: Result<report::Run, SolveError>,
    states: Vec<State>,
    coordinates: usize,
    reached: f64,
    exception: Option<PyErr>,
) -> PyResult<Run> {
    match end {
        Ok(end) => Ok(Run::new(Some(end), states, coordinates, reached, exception)),
        Err(SolveError::Input(error)) => Err(input_error(py, &error)),
        Err(SolveError::Memory(error)) => Err(PyMemoryError::new_err(error.to_string())),
        Err(SolveError::Threads(error)) => Err(PyRuntimeError::new_err(error.to_string())),
    }
}

fn newton_options(py: Python<'_>, newton: &str, tolerance: f64, max_iterations: usize) -> PyResult<NewtonOptions> {
    let variant = match newton {
        "mip" => Variant::MixedIntegrationPoint,
        "plain" => Variant::Plain,
        _ => return Err(input_error(py, &InputError::new("newton", format!("\"{newton}\""), "mip, plain"))),
    };
    Ok(NewtonOptions { variant, tolerance, max_iterations })
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
    let newton = newton_options(py, newton, tolerance, max_iterations)?;
    let control = match path {
        "load" => Control::Load,
        "arc" => Control::Arc,
        _ => return Err(input_error(py, &InputError::new("path", format!("\"{path}\""), "load, arc"))),
    };
    let options = statics::Options { control, load_factors, newton, first_step, min_step, max_steps };
    run(py, model, threads, progress, move |system, observer| statics::solve(system, &options, observer))
}

/// Integrates a motion.
#[pyfunction]
#[pyo3(signature = (model, *, until, step, method, alpha, rho_inf, outputs, velocity, newton, tolerance, max_iterations, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments in Python")]
pub fn simulate(
    py: Python<'_>,
    model: &Model,
    until: f64,
    step: f64,
    method: &str,
    alpha: Option<f64>,
    rho_inf: Option<f64>,
    outputs: Vec<f64>,
    velocity: Option<PyReadonlyArray1<'_, f64>>,
    newton: &str,
    tolerance: f64,
    max_iterations: usize,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Run> {
    let newton = newton_options(py, newton, tolerance, max_iterations)?;
    let method = match method {
        "hht" => checked(py, GeneralizedAlpha::hht(alpha.unwrap_or(-0.05)))?,
        "generalized_alpha" => checked(py, GeneralizedAlpha::from_spectral_radius(rho_inf.unwrap_or(0.9)))?,
        _ => {
            let error = InputError::new("method", format!("\"{method}\""), "hht, generalized_alpha");
            return Err(input_error(py, &error));
        }
    };
    let n = model.core().reference().len();
    let velocity = velocity.map(|v| coordinates(py, "velocity", &v, n)).transpose()?;
    let options = dynamics::Options { until, step, method, outputs, velocity, newton };
    run(py, model, threads, progress, move |system, observer| dynamics::simulate(system, &options, observer))
}
