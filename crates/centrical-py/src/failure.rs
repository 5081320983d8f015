//! What went wrong, as exceptions of Python: file, place, found, expected as data, and no panic.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use centrical_session::{Error, Place};
use centrical_table::Error as TableError;
use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError};
use pyo3::prelude::*;

/// What `centrical._errors.input_error` takes.
struct Parts<'a> {
    file: Option<&'a Path>,
    place: Option<&'a Place>,
    found: Option<&'a str>,
    expected: Option<&'a str>,
    /// What the operating system calls it.
    code: Option<i32>,
}

/// The exception for an error of a job.
pub fn exception(py: Python, error: &Error) -> PyErr {
    if matches!(error, Error::Stopped(_)) {
        return PyKeyboardInterrupt::new_err(error.to_string());
    }
    input_error(py, &error.to_string(), &parts(error)).unwrap_or_else(|broken| broken)
}

/// The exception for content that is wrong in a text that is in no file.
pub fn wrong_content(py: Python, place: &str, found: &str, expected: &str) -> PyErr {
    let message = format!("{place}: found {found}, expected {expected}");
    let parts = Parts { file: None, place: None, found: Some(found), expected: Some(expected), code: None };
    input_error(py, &message, &parts).unwrap_or_else(|broken| broken)
}

/// The outcome of work that is done at once; a panic in it becomes an exception.
///
/// # Errors
/// What the work gives, or `RuntimeError`.
pub fn guarded<T>(work: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(defect(panic.as_ref())))
}

/// The exception for a panic: a defect of the program.
pub fn defect(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    PyRuntimeError::new_err(format!("a defect of centrical, please report it: {}", text.unwrap_or("no message")))
}

fn parts(error: &Error) -> Parts<'_> {
    let of = |file, place| Parts { file: Some(file), place, found: None, expected: None, code: None };
    match error {
        Error::Table(TableError::Content { file, place, found, expected }) => Parts {
            found: Some(found),
            expected: Some(expected),
            // The kind of the error was found out by the system, and lies in the words since.
            code: (found == "no such file").then_some(NO_ENTRY),
            ..of(file, Some(place))
        },
        Error::Table(TableError::Io { file, source, .. }) => {
            Parts { code: Some(source.raw_os_error().unwrap_or(IO)), ..of(file, None) }
        }
        Error::Form { file, place, message } => Parts { found: Some(message), ..of(file, Some(place)) },
        Error::Reduction { file, .. }
        | Error::Fit { file, .. }
        | Error::ErrorModel { file, .. }
        | Error::NotInvertible { file, .. }
        | Error::Planning { file, .. }
        | Error::Noise { file, .. }
        | Error::Simulation { file, .. } => of(file, None),
        _ => Parts { file: None, place: None, found: None, expected: None, code: None },
    }
}

/// `ENOENT` and `EIO`, alike on all systems.
const NO_ENTRY: i32 = 2;
const IO: i32 = 5;

fn input_error(py: Python, message: &str, parts: &Parts) -> PyResult<PyErr> {
    // ", line 3, f2", as it follows the file in a message.
    let place = parts.place.map(Place::to_string);
    let place = place.as_deref().map(|place| place.trim_start_matches(", ")).filter(|place| !place.is_empty());
    let file = parts.file.map(|file| file.display().to_string());
    let make = py.import("centrical._errors")?.getattr("input_error")?;
    let exception = make.call1((message, file, place, parts.found, parts.expected, parts.code))?;
    Ok(PyErr::from_value(exception))
}
