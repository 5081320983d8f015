//! What went wrong, as exceptions of Python: file, place, found, expected as data, and no panic.

use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};

use centrical_session::{Error, ErrorKind};
use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError};
use pyo3::prelude::*;

/// The exception for an error of a job.
pub fn exception(py: Python, error: &Error) -> PyErr {
    if matches!(error, Error::Stopped(_)) {
        return PyKeyboardInterrupt::new_err(error.to_string());
    }
    // ", line 3, f2", as it follows the file in a message.
    let place = error.place().map(|place| place.to_string().trim_start_matches(", ").to_owned());
    let file = error.file().map(|file| file.display().to_string());
    let parts = (error.to_string(), file, place, error.found(), error.expected(), code(error));
    input_error(py, parts)
}

/// The exception for content that is wrong in a text that is in no file.
pub fn wrong_content(py: Python, place: &str, found: &str, expected: &str) -> PyErr {
    let message = format!("{place}: found {found}, expected {expected}");
    let parts = (message, None, Some(place.to_owned()), Some(found), Some(expected), None);
    input_error(py, parts)
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

/// What `centrical._errors.input_error` takes: message, file, place, found, expected, and the code of the system.
type Parts<'a> = (String, Option<String>, Option<String>, Option<&'a str>, Option<&'a str>, Option<i32>);

fn input_error(py: Python, parts: Parts) -> PyErr {
    let make = py.import("centrical._errors").and_then(|errors| errors.getattr("input_error"));
    make.and_then(|make| make.call1(parts)).map_or_else(|broken| broken, PyErr::from_value)
}

/// The code that the operating system gives to what it refused.
fn code(error: &Error) -> Option<i32> {
    // Alike on all systems.
    const NO_ENTRY: i32 = 2;
    const IO: i32 = 5;
    match error.kind() {
        ErrorKind::Missing => Some(NO_ENTRY),
        ErrorKind::Io => {
            let source = std::error::Error::source(error).and_then(|source| source.downcast_ref::<io::Error>());
            Some(source.and_then(io::Error::raw_os_error).unwrap_or(IO))
        }
        _ => None,
    }
}
