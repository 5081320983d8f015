//! A session folder that is watched: plateaus as they come, on a thread of its own.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

#[cfg(feature = "serve")]
use centrical_live::{Running, Server, Watched};
use centrical_report::{AlarmKind, alarm_text, frozen_text, write_history_plot};
use centrical_session::{self as session, Error, Session, WatchEnd, WatchEvent, WatchRequest, watch};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::failure::exception;
use crate::pool;
use crate::result::CalibrationResult;
use crate::words;

/// How soon a signal is noticed.
const SLICE: Duration = Duration::from_millis(20);

/// What happens to a session that is watched.
enum Event {
    Plateau(String),
    Waiting(String),
    /// Of a plateau or of a record, and what was found.
    Alarm(AlarmKind, String),
    End(Result<Option<Box<session::CalibrationResult>>, Error>),
}

/// A session that is watched. Its iteration gives pairs: `("plateau", line of JSON)`, `("waiting", note)`, and at last
/// `("complete", result)` or `("stopped", None)`; and alarms, `("alarm", (name, text))`.
#[pyclass(frozen, module = "centrical._native")]
pub struct Watcher {
    events: Mutex<Option<Receiver<Event>>>,
    stop: Arc<AtomicBool>,
    thread: Mutex<Option<JoinHandle<()>>>,
    /// The live page, until the watcher goes.
    page: Option<Page>,
}

#[pymethods]
impl Watcher {
    #[new]
    #[pyo3(signature = (
        session, out, targets, false_alarm, hold_out, hold_out_alarms, interval, quiet, frozen, once, serve, serve_names, live_targets
    ))]
    fn new(
        py: Python,
        session: PathBuf,
        out: PathBuf,
        targets: Vec<String>,
        false_alarm: f64,
        hold_out: Vec<String>,
        hold_out_alarms: bool,
        interval: f64,
        quiet: f64,
        frozen: f64,
        once: bool,
        serve: Option<String>,
        serve_names: Vec<String>,
        live_targets: Option<Vec<(String, f64)>>,
    ) -> PyResult<Self> {
        pool::claim()?;
        let page = serve.map(|address| Page::bind(&address, &serve_names)).transpose();
        let page = page.map_err(|error| exception(py, &error))?;
        let time = |argument, seconds| WatchRequest::time(seconds).map_err(|wrong| words::refused(argument, wrong));
        let request = WatchRequest {
            out,
            false_alarm: words::probability("false_alarm", false_alarm)?,
            hold_out: words::plateaus("hold_out", &hold_out)?,
            hold_out_alarms,
            groups: targets,
            interval: time("interval", interval)?,
            quiet: time("quiet", quiet)?,
            frozen: time("frozen", frozen)?,
            once,
            live: live_targets,
        };
        let page = page.map(|page| page.begin(&request.out)).transpose().map_err(|error| exception(py, &error))?;
        let (sender, events) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let raised = Arc::clone(&stop);
        let follow = move || {
            let end = follow(&session, &request, &raised, &sender);
            // Nobody receives it after the watcher was closed.
            let _ = sender.send(Event::End(end));
        };
        let thread = thread::Builder::new().name("centrical watch".to_owned()).spawn(follow);
        let thread = thread.map_err(|error| PyRuntimeError::new_err(format!("found no further thread: {error}")))?;
        Ok(Self { events: Mutex::new(Some(events)), stop, thread: Mutex::new(Some(thread)), page })
    }

    /// The address of the live page.
    #[getter]
    fn url(&self) -> Option<&str> {
        self.page.as_ref().map(|page| page.url.as_str())
    }

    fn __iter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __next__(&self, py: Python) -> PyResult<Option<(&'static str, Py<PyAny>)>> {
        let taken = self.events.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some(mut events) = taken else { return Ok(None) };
        loop {
            let event;
            (events, event) = py.detach(move || {
                let event = events.recv_timeout(SLICE);
                (events, event)
            });
            let event = match event {
                Ok(Event::End(end)) => return self.ended(py, end).map(Some),
                Ok(Event::Plateau(line)) => ("plateau", text(py, &line)),
                Ok(Event::Waiting(note)) => ("waiting", text(py, &note)),
                Ok(Event::Alarm(kind, found)) => ("alarm", (kind.name(), found).into_py_any(py)?),
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(interruption) = py.check_signals() {
                        self.close(py);
                        return Err(interruption);
                    }
                    continue;
                }
                Err(RecvTimeoutError::Disconnected) => {
                    self.close(py);
                    return Err(PyRuntimeError::new_err(
                        "a defect of centrical, please report it: a watch that panicked",
                    ));
                }
            };
            *self.events.lock().unwrap_or_else(PoisonError::into_inner) = Some(events);
            return Ok(Some(event));
        }
    }

    /// Ends the watch; its state on disk is whole, and another one resumes from it.
    fn close(&self, py: Python) {
        self.stop.store(true, Ordering::Relaxed);
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(thread) = thread {
            // A panic of it has been seen already, by the end of its messages.
            let _ = py.detach(|| thread.join());
        }
    }
}

impl Watcher {
    fn ended(
        &self,
        py: Python,
        end: Result<Option<Box<session::CalibrationResult>>, Error>,
    ) -> PyResult<(&'static str, Py<PyAny>)> {
        self.close(py);
        match end {
            Ok(Some(result)) => Ok(("complete", Py::new(py, CalibrationResult::from(*result))?.into_any())),
            Ok(None) => Ok(("stopped", py.None())),
            Err(error) => Err(exception(py, &error)),
        }
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        // The thread ends by itself; it is not waited for, as this may be the end of the interpreter.
        self.stop.store(true, Ordering::Relaxed);
    }
}

fn follow(
    session: &Path,
    request: &WatchRequest,
    stop: &AtomicBool,
    events: &Sender<Event>,
) -> Result<Option<Box<session::CalibrationResult>>, Error> {
    let session = Session::read_before_rests(session)?;
    let mut reported = Ok(());
    let mut hear = |event: WatchEvent| {
        if let Some((kind, found)) = alarm_text(&event) {
            // Whether somebody receives it shows with the event itself.
            let _ = events.send(Event::Alarm(kind, found));
        }
        let has_gone = match message(&event, &request.out) {
            Ok(event) => event.is_some_and(|event| events.send(event).is_err()),
            Err(error) => {
                reported = std::mem::replace(&mut reported, Ok(())).and(Err(error));
                false
            }
        };
        if has_gone {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let end = watch(&session, request, stop, &mut hear)?;
    reported?;
    Ok(match end {
        WatchEnd::Stopped { .. } => None,
        WatchEnd::Complete(result) => Some(result),
    })
}

/// The live page.
struct Page {
    url: String,
    #[cfg(feature = "serve")]
    server: Option<Server>,
    #[cfg(feature = "serve")]
    _running: Option<Running>,
}

#[cfg(feature = "serve")]
impl Page {
    fn bind(address: &str, names: &[String]) -> Result<Self, Error> {
        let server = Server::bind(address, names)?;
        Ok(Self { url: server.url(), server: Some(server), _running: None })
    }

    fn begin(mut self, out: &Path) -> Result<Self, Error> {
        let running = self.server.take().map(|server| server.begin(Watched::new(out))).transpose()?;
        Ok(Self { _running: running, ..self })
    }
}

#[cfg(not(feature = "serve"))]
impl Page {
    #[allow(clippy::needless_pass_by_value, reason = "the arguments of a build that has a server")]
    fn bind(address: &str, _: &[String]) -> Result<Self, Error> {
        let expected = "none in a package that was built without the feature `serve`: with live=True `centrical view OUT` shows the page";
        Err(Error::content(Path::new("serve"), session::Place::Whole, format!("the address {address}"), expected))
    }

    #[allow(clippy::unnecessary_wraps, reason = "as with a server")]
    fn begin(self, _: &Path) -> Result<Self, Error> {
        Ok(self)
    }
}

/// The event for the other thread; a plateau as its line of the history.
fn message(event: &WatchEvent, out: &Path) -> Result<Option<Event>, Error> {
    match event {
        WatchEvent::Begun(_) | WatchEvent::Failed(_) => Ok(None),
        WatchEvent::Followed(model) => write_history_plot(model, out).map(|()| None),
        WatchEvent::Waiting(note) => Ok(Some(Event::Waiting((*note).to_owned()))),
        WatchEvent::Frozen { file, age } => Ok(Some(Event::Waiting(frozen_text(file, *age)))),
        WatchEvent::Plateau(progress) => {
            let last = progress.plateaus.last();
            let entry = last.map(|last| last.entry(progress.plateaus.len(), progress.model, &progress.now));
            entry.map(|entry| entry.line().map(Event::Plateau)).transpose()
        }
    }
}

fn text(py: Python, text: &str) -> Py<PyAny> {
    pyo3::types::PyString::new(py, text).into_any().unbind()
}
