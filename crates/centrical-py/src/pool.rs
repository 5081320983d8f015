//! The threads of the process, which a fork does not take along.

use std::process;
use std::sync::atomic::{AtomicU32, Ordering};

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::{PyResult, pyfunction};

/// The process whose threads work; 0 before the first of them.
static OWNER: AtomicU32 = AtomicU32::new(0);

/// Whether this process may use the threads. A child that was forked after their first use may not: it would wait for ever.
pub fn is_ours() -> bool {
    let here = process::id();
    OWNER
        .compare_exchange(0, here, Ordering::Relaxed, Ordering::Relaxed)
        .unwrap_or_else(|owner| if owner == here { 0 } else { owner })
        == 0
}

/// Refuses a forked child of a process that has used its threads.
///
/// # Errors
/// `RuntimeError` in such a child.
pub fn claim() -> PyResult<()> {
    if is_ours() {
        return Ok(());
    }
    Err(PyRuntimeError::new_err(
        "found a process forked after centrical had started its threads, expected one of its own: \
         use multiprocessing.get_context(\"spawn\"), or fork before the first call",
    ))
}

/// Threads at most: beyond it their start takes longer than the work.
const MOST: usize = 1024;

/// Sets the number of threads, before the first call.
#[pyfunction]
pub fn set_threads(count: i64) -> PyResult<()> {
    let threads = usize::try_from(count).ok().filter(|count| (1..=MOST).contains(count));
    let Some(threads) = threads else {
        return Err(PyValueError::new_err(format!("count: found {count}, expected 1 to {MOST} threads")));
    };
    claim()?;
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().map_err(|_| {
        PyRuntimeError::new_err("found threads that have started, expected set_threads before the first call")
    })
}
