//! Long work on a thread of its own, while the calling one shows progress and looks for signals.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use centrical_session::Error;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::failure::{defect, exception};
use crate::pool;

/// How soon a signal is noticed.
const SLICE: Duration = Duration::from_millis(20);

/// A function of Python that shows progress: it takes what is done and all there is to do.
pub type Shown = Option<Py<PyAny>>;

/// How far work is, and whether it is to stop.
#[derive(Debug, Default)]
pub struct Work {
    done: AtomicU64,
    all: AtomicU64,
    is_stopped: AtomicBool,
}

impl Work {
    /// States how much there is to do.
    pub fn expect(&self, all: u64) {
        self.done.store(0, Ordering::Relaxed);
        self.all.store(all, Ordering::Relaxed);
    }

    /// Counts what was done.
    pub fn advance(&self, done: u64) -> ControlFlow<()> {
        self.done.fetch_add(done, Ordering::Relaxed);
        if self.is_stopped.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Counts pieces that were done.
    pub fn count(&self, pieces: usize) -> ControlFlow<()> {
        self.advance(pieces as u64)
    }
}

/// Runs a job without the interpreter lock. A signal stops it, and its handler's exception is raised.
///
/// # Errors
/// The exception of a signal, of `shown`, or of the job.
pub fn run<T: Send>(py: Python, shown: &Shown, job: impl FnOnce(&Work) -> Result<T, Error> + Send) -> PyResult<T> {
    pool::claim()?;
    let work = Work::default();
    let (sender, receiver) = channel();
    thread::scope(|scope| {
        let worker = || {
            // Nobody receives it only after a panic of the one who waits.
            let _ = sender.send(catch_unwind(AssertUnwindSafe(|| job(&work))));
        };
        let spawned = thread::Builder::new().name("centrical".to_owned()).spawn_scoped(scope, worker);
        spawned.map_err(|error| PyRuntimeError::new_err(format!("found no further thread ({error}), expected one")))?;
        match outcome(py, receiver, &work, shown)? {
            Ok(Ok(value)) => Ok(value),
            Ok(Err(error)) => Err(exception(py, &error)),
            Err(panic) => Err(defect(panic.as_ref())),
        }
    })
}

/// Waits for the outcome of work in slices.
fn outcome<T: Send>(py: Python, mut receiver: Receiver<T>, work: &Work, shown: &Shown) -> PyResult<T> {
    let mut interruption = None;
    loop {
        let outcome;
        (receiver, outcome) = py.detach(move || {
            let outcome = receiver.recv_timeout(SLICE);
            (receiver, outcome)
        });
        match (outcome, interruption) {
            (Err(RecvTimeoutError::Timeout), None) => {
                interruption = py.check_signals().and_then(|()| show(py, work, shown)).err();
                if interruption.is_some() {
                    work.is_stopped.store(true, Ordering::Relaxed);
                }
            }
            (Err(RecvTimeoutError::Timeout), interrupted) => interruption = interrupted,
            (_, Some(interruption)) => return Err(interruption),
            (Ok(outcome), None) => {
                // A signal that came in the last slice.
                py.check_signals()?;
                return Ok(outcome);
            }
            (Err(RecvTimeoutError::Disconnected), None) => {
                return Err(PyRuntimeError::new_err("a job without outcome"));
            }
        }
    }
}

fn show(py: Python, work: &Work, shown: &Shown) -> PyResult<()> {
    let Some(shown) = shown else { return Ok(()) };
    let [done, all] = [&work.done, &work.all].map(|count| count.load(Ordering::Relaxed));
    shown.call1(py, (done, all)).map(drop)
}
