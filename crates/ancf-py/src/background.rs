//! A solve in a thread of its own, while Python's thread shows progress and listens for Ctrl-C.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use ancf_core::assembly::System;
use ancf_core::linear::LinearError;
use ancf_core::observe::{Observer, State};
use ancf_core::{InputError, model, report};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;

use crate::errors::input_error;
use crate::model::Model;
use crate::run::Run;

/// How often Python hears of progress and is asked for signals.
const PERIOD: Duration = Duration::from_millis(50);
/// How old the checkpoint in the file may become.
const BETWEEN_CHECKPOINTS: Duration = Duration::from_secs(1);
/// How long a solve that was stopped may take to answer, an iteration of it at most; it is left behind after that, or when the
/// user insists.
const PATIENCE: Duration = Duration::from_secs(5);

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
pub fn run(
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
        match py.detach(|| receive(&mut receiver, left.min(PERIOD))) {
            Err(RecvTimeoutError::Timeout) if !left.is_zero() && py.check_signals().is_ok() => {}
            Ok(Event::State(state)) => states.push(state),
            Ok(Event::Withdraw(after)) => states.withdraw(after),
            Ok(Event::Reached(t)) => reached = t,
            Ok(Event::Checkpoint(done)) => unsaved = done.err(),
            Ok(Event::End(end)) => return finish(py, end, states, coordinates, reached, unsaved, Some(exception)),
            Err(_) => {
                // What was reached between the states is lost with the solve that is left behind.
                let reached = states.last().map_or(0.0, |state| state.t);
                return Ok(Run::new(None, states, coordinates, reached, unsaved, Some(exception)));
            }
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
