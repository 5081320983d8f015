//! The sessions of a series on threads: each has one session and computes it alone, so that no core waits for another.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant};
use std::{mem, thread};

use centrical::{OnProgress, Stopped, advance, unwatched};
use rayon::ThreadPoolBuilder;

use super::ledger::Ledger;
use super::one::{Done, SeriesRequest, Writing, calibrated};
use crate::error::Error;
use crate::store::Store;

/// Rows that wait to be written, and how long: a kill loses no more work than that.
const WAITING: usize = 256;
const PERIOD: Duration = Duration::from_secs(2);

/// How often the caller is asked while nothing is done.
const ASKING: Duration = Duration::from_millis(100);

/// What the threads work with.
pub(super) struct Workers<'a> {
    pub request: &'a SeriesRequest,
    pub store: &'a Store,
    pub progress: OnProgress<'a, usize>,
    /// The reduced sessions that are written.
    pub writing: Writing,
}

impl Workers<'_> {
    /// Calibrates the sessions and writes their rows as they come.
    pub fn run(&self, sessions: &[&Path], ledger: &mut Ledger) -> Result<(), Error> {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        // A pool of fewer threads than cores was asked for, or is all that the system gives.
        let usual = cores.min(rayon::current_num_threads());
        let jobs = self.request.jobs.unwrap_or(usual).clamp(1, sessions.len().max(1));
        let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
        let (send, received) = sync_channel(2 * jobs);
        thread::scope(|scope| {
            let is_given = |_: &usize| {
                let (send, next, stop) = (send.clone(), &next, &stop);
                thread::Builder::new().spawn_scoped(scope, move || self.work(sessions, next, stop, &send)).is_ok()
            };
            if (0..jobs).take_while(is_given).count() == 0 {
                return self.one_by_one(sessions, ledger);
            }
            drop(send);
            let written = self.write(sessions, &received, ledger, &stop);
            // If nothing can be written, nothing more is calibrated, and no thread waits to hand over.
            stop.store(true, Ordering::Relaxed);
            while received.recv().is_ok() {}
            written
        })
    }

    /// Without a thread for it: session after session, each on all threads that there are.
    fn one_by_one(&self, sessions: &[&Path], ledger: &mut Ledger) -> Result<(), Error> {
        for session in sessions {
            let done = calibrated(session, self.request, &self.writing, &|_| (self.progress)(0)).ok_or(Stopped)?;
            self.flush(&[session], vec![(0, done)], ledger)?;
            advance(self.progress, 1)?;
        }
        Ok(())
    }

    /// One thread: session after session, to the last.
    fn work(&self, sessions: &[&Path], next: &AtomicUsize, stop: &AtomicBool, send: &SyncSender<(usize, Done)>) {
        // This thread is the whole pool. The shared one may consist of the thread that writes, which would never compute.
        let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
        let progress =
            |_| if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        while progress(0_u64).is_continue() {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(session) = sessions.get(number) else { break };
            let one = || calibrated(session, self.request, &self.writing, &progress);
            // A thread of a caller that is in a pool already computes there.
            let done = pool.as_ref().map_or_else(|_| one(), |pool| pool.install(one));
            if done.is_none_or(|done| send.send((number, done)).is_err()) {
                break;
            }
        }
    }

    /// Writes rows and lines as sessions are done.
    fn write(
        &self,
        sessions: &[&Path],
        received: &Receiver<(usize, Done)>,
        ledger: &mut Ledger,
        stop: &AtomicBool,
    ) -> Result<(), Error> {
        let (mut waiting, mut last, mut is_stopped) = (Vec::new(), Instant::now(), false);
        loop {
            let (count, is_ended) = match received.recv_timeout(ASKING) {
                Ok(done) => {
                    waiting.push(done);
                    (1, false)
                }
                Err(RecvTimeoutError::Timeout) => (0, false),
                Err(RecvTimeoutError::Disconnected) => (0, true),
            };
            if (self.progress)(count).is_break() {
                is_stopped = true;
                stop.store(true, Ordering::Relaxed);
            }
            if is_ended || waiting.len() >= WAITING || last.elapsed() > PERIOD {
                self.flush(sessions, mem::take(&mut waiting), ledger)?;
                last = Instant::now();
            }
            if is_ended {
                return if is_stopped { Err(Stopped.into()) } else { Ok(()) };
            }
        }
    }

    /// The rows first: a session is known only once its row is there.
    fn flush(&self, sessions: &[&Path], mut waiting: Vec<(usize, Done)>, ledger: &mut Ledger) -> Result<(), Error> {
        if waiting.is_empty() {
            return Ok(());
        }
        let keeps = !self.request.rows_only;
        let rows = waiting.iter_mut().map(|(_, done)| {
            let result = done.result.take().filter(|_| keeps).map(String::into_bytes);
            (done.row.clone(), result)
        });
        self.store.add_with_results(rows.collect(), &unwatched)?;
        ledger.add(waiting.iter().map(|(number, done)| (sessions[*number], done)))
    }
}
