//! Running a solve: it works in a thread of its own, while Python's thread shows progress and listens for Ctrl-C.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use ancf_core::assembly::System;
use ancf_core::dynamics::{self, Checkpoint, Method, Steps, Tolerances};
use ancf_core::linear::LinearError;
use ancf_core::nonlinear::{Options as NewtonOptions, Variant};
use ancf_core::observe::{Observer, State};
use ancf_core::statics::Control;
use ancf_core::{InputError, model, modes as oscillations, report, statics};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;

use crate::arrays::{coordinates, matrix, vector};
use crate::errors::{checked, input_error};
use crate::model::Model;
use crate::run::Run;

/// How often Python hears of progress and is asked for signals.
const PERIOD: Duration = Duration::from_millis(50);
/// How old the checkpoint in the file may become.
const BETWEEN_CHECKPOINTS: Duration = Duration::from_secs(1);
/// How long a solve that was stopped may take to answer; it is left behind after that.
const PATIENCE: Duration = Duration::from_millis(100);

/// What a solve tells while it runs.
enum Event {
    State(State),
    /// Outputs after a time are not sound.
    Withdraw(f64),
    Reached(f64),
    /// A checkpoint was written, or could not be.
    Checkpoint(std::io::Result<()>),
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
    saved: Option<Saved>,
}

/// A file from which a motion can be resumed.
struct Saved {
    path: PathBuf,
    /// Outputs so far.
    states: Vec<State>,
    written: Option<Instant>,
}

impl Saved {
    /// Replaces the file by one for the present step, in one go, so that there is always a whole one.
    fn write(&mut self, make: &dyn Fn(&[State]) -> Vec<u8>) -> std::io::Result<()> {
        let mut temporary = self.path.clone().into_os_string();
        temporary.push(".new");
        let done =
            std::fs::write(&temporary, make(&self.states)).and_then(|()| std::fs::rename(&temporary, &self.path));
        if done.is_err() {
            let _ = std::fs::remove_file(&temporary);
        }
        self.written = Some(Instant::now());
        done.map_err(|error| std::io::Error::new(error.kind(), format!("{}: {error}", self.path.display())))
    }
}

impl Observer for Messenger {
    fn state(&mut self, state: State) {
        if let Some(saved) = &mut self.saved {
            saved.states.push(state.clone());
        }
        // Nobody listens any more when the solve was left behind; it stops at its next iteration.
        let _ = self.events.send(Event::State(state));
    }

    fn withdraw(&mut self, after: f64) {
        if let Some(saved) = &mut self.saved {
            saved.states.withdraw(after);
        }
        let _ = self.events.send(Event::Withdraw(after));
    }

    fn reached(&mut self, t: f64) {
        if self.told.elapsed() >= PERIOD {
            self.told = Instant::now();
            let _ = self.events.send(Event::Reached(t));
        }
    }

    fn wants_checkpoints(&self) -> bool {
        self.saved.is_some()
    }

    fn checkpoint(&mut self, make: &dyn Fn(&[State]) -> Vec<u8>, last: bool) {
        let Some(saved) = &mut self.saved else { return };
        let recent = saved.written.is_some_and(|written| written.elapsed() < BETWEEN_CHECKPOINTS);
        if last || !recent {
            let _ = self.events.send(Event::Checkpoint(saved.write(make)));
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
    before: Vec<State>,
    file: Option<PathBuf>,
    solve: impl FnOnce(&mut System, &mut dyn Observer) -> Result<report::Run, InputError> + Send + 'static,
) -> PyResult<Run> {
    let model = model.core();
    let coordinates = model.reference().len();
    let (events, mut receiver) = channel();
    let stop = Arc::new(AtomicBool::new(false));
    let saved = file.map(|path| Saved { path, states: before.clone(), written: None });
    let mut states = before;
    let mut messenger = Messenger { events: events.clone(), stop: Arc::clone(&stop), told: Instant::now(), saved };
    let work = move || start(model, threads, &mut messenger, solve);
    let worker = thread::spawn(move || {
        let end = work();
        let _ = events.send(Event::End(end));
    });

    let mut reached = 0.0;
    let mut unsaved = None;
    let mut told = Instant::now();
    let exception = loop {
        match py.detach(|| receive(&mut receiver, PERIOD)) {
            Ok(Event::State(state)) => states.push(state),
            Ok(Event::Withdraw(after)) => states.withdraw(after),
            Ok(Event::Reached(t)) => reached = t,
            Ok(Event::Checkpoint(done)) => unsaved = done.err(),
            Ok(Event::End(end)) => {
                // A signal that came just before the end counts.
                let exception = py.check_signals().err();
                return finish(py, end, states, coordinates, reached, unsaved, exception);
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
            Ok(Event::Withdraw(after)) => states.withdraw(after),
            Ok(Event::Reached(t)) => reached = t,
            Ok(Event::Checkpoint(done)) => unsaved = done.err(),
            Ok(Event::End(end)) => return finish(py, end, states, coordinates, reached, unsaved, Some(exception)),
            Err(_) => return Ok(Run::new(None, states, coordinates, reached, unsaved, Some(exception))),
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
    unsaved: Option<std::io::Error>,
    exception: Option<PyErr>,
) -> PyResult<Run> {
    match end {
        Ok(end) => Ok(Run::new(Some(end), states, coordinates, reached, unsaved, exception)),
        Err(SolveError::Input(error)) => Err(input_error(py, &error)),
        Err(SolveError::Memory(error)) => Err(PyMemoryError::new_err(error.to_string())),
        Err(SolveError::Threads(error)) => Err(PyRuntimeError::new_err(error.to_string())),
    }
}

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
