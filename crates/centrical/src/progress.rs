//! Long work: how it reports what it has done, and how it is stopped.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use thiserror::Error;

/// Called again and again, from any thread, with the amount of work done since the last call; [`ControlFlow::Break`] stops the
/// work, which then ends with [`Stopped`].
pub type OnProgress<'a, N = u64> = &'a (dyn Fn(N) -> ControlFlow<()> + Sync);

/// The caller stopped the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("stopped before the end")]
pub struct Stopped;

/// The progress of work that nobody watches: it goes on.
pub fn unwatched<N>(_: N) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Reports what was done.
///
/// # Errors
/// [`Stopped`] when the caller stops the work.
pub fn advance<N>(progress: OnProgress<N>, done: N) -> Result<(), Stopped> {
    match progress(done) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Stopped),
    }
}

/// The progress of a search whose loops end early when it is stopped: what they return then is not used.
pub(crate) struct Watch<'a> {
    progress: OnProgress<'a, ()>,
    is_stopped: AtomicBool,
}

impl<'a> Watch<'a> {
    pub fn new(progress: OnProgress<'a, ()>) -> Self {
        Self { progress, is_stopped: AtomicBool::new(false) }
    }

    /// Asks the caller, until he stops the search.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed) || self.asked()
    }

    fn asked(&self) -> bool {
        let is_stopped = (self.progress)(()).is_break();
        self.is_stopped.fetch_or(is_stopped, Ordering::Relaxed) || is_stopped
    }

    /// What a search found, unless it was stopped.
    pub fn found<T>(&self, found: T) -> Result<T, Stopped> {
        if self.is_stopped.load(Ordering::Relaxed) { Err(Stopped) } else { Ok(found) }
    }
}
