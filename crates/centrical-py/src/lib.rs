//! The native core of the Python package `centrical`: each command of the program as a function, results as objects.
//!
//! It is thin. A function runs one job of `centrical-session` without the interpreter lock and gives the JSON text that the
//! command prints; the Python layer beside it, `python/centrical`, makes objects of that. No panic crosses into Python.

#![allow(clippy::missing_errors_doc, reason = "the docstrings of the Python layer say what is raised")]
#![allow(
    clippy::needless_pass_by_value,
    clippy::too_many_arguments,
    reason = "arguments come from Python as values, and are the options of a command"
)]

mod arrays;
mod compensation;
mod failure;
mod given;
mod jobs;
mod pool;
mod progress;
mod result;
mod watch;
mod words;

use pyo3::pymodule;

/// The native core of `centrical`.
#[pymodule(gil_used = true)]
pub mod _native {
    /// Version of the package.
    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name")]
    pub const __version__: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    pub use crate::jobs::calibrate::{assess, calibrate, compare, models, montecarlo, series};
    #[pymodule_export]
    pub use crate::jobs::history::{
        add_failure, add_to_store, history_chart, history_list, history_pages, history_station, history_unit,
        history_units,
    };
    #[pymodule_export]
    pub use crate::jobs::in_memory::{calibrate_arrays, plateau_columns};
    #[pymodule_export]
    pub use crate::jobs::measure::{noise, noise_of_session, reduce};
    #[pymodule_export]
    pub use crate::jobs::prepare::{init, observe, plan, schema, simulate};
    #[pymodule_export]
    pub use crate::jobs::report::{compensate, draw_curves, report};
    #[pymodule_export]
    pub use crate::jobs::tumble::tumble;
    #[pymodule_export]
    pub use crate::pool::set_threads;
    #[pymodule_export]
    pub use crate::result::CalibrationResult;
    #[pymodule_export]
    pub use crate::watch::Watcher;
}
