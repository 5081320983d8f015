//! How long files have been left alone, and until when a watch works. The clock of the machine that writes them may be off: what a watch sees itself decides.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use centrical_table::Error as TableError;

use crate::error::Error;

/// Time for which a file has to stand under the eyes of a watch before its own time counts: recorders write more often.
const STANDING: Duration = Duration::from_secs(10);

/// What a watch has seen of files.
#[derive(Debug, Clone)]
pub(super) struct Quiet {
    /// Time after which a file counts as left alone.
    pub after: Duration,
    /// Whether the watch looks once: the times of the files are then all that it has.
    pub looks_once: bool,
    /// Since when the system fails to read a record.
    failing: Option<Instant>,
    seen: BTreeMap<Vec<PathBuf>, Seen>,
}

/// How files looked.
#[derive(Debug, Clone, Copy)]
struct Seen {
    bytes: u64,
    written: Option<SystemTime>,
    /// Since when they have looked so.
    since: Instant,
    /// Whether they have looked otherwise.
    is_altered: bool,
}

/// What a look at files shows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    pub bytes: u64,
    /// Their own time.
    pub written: Option<SystemTime>,
    /// For how long they have not changed.
    pub stood: Duration,
    /// When they changed last, by the clock of the watch; their own time as long as it has not seen them change.
    pub changed: Option<SystemTime>,
    /// Whether they are older than the time called quiet by their own time.
    pub is_old: bool,
    /// Whether they have been left alone for the time called quiet.
    pub left_alone: bool,
}

impl Quiet {
    /// Before the first look.
    pub fn new(after: Duration, looks_once: bool) -> Self {
        Self { after, looks_once, failing: None, seen: BTreeMap::new() }
    }

    /// Looks at files that belong together, the last one to change counts; `None` unless all are there. Their own time counts as long as
    /// the watch has not seen them change.
    pub fn look<'f>(&mut self, files: impl IntoIterator<Item = &'f PathBuf>) -> Option<Sight> {
        let files: Vec<PathBuf> = files.into_iter().cloned().collect();
        let (mut bytes, mut written) = (0, None);
        for file in &files {
            let metadata = fs::metadata(file).ok()?;
            bytes += metadata.len();
            written = written.max(metadata.modified().ok());
        }
        Some(self.see(files, bytes, written))
    }

    /// The last of files that is not there or has not been left alone; each of them is looked at.
    pub fn awaited<'f>(&mut self, files: impl Iterator<Item = &'f PathBuf>) -> Option<PathBuf> {
        files.filter(|file| !self.look([*file]).is_some_and(|sight| sight.left_alone)).last().cloned()
    }

    /// Whether the system fails to read a file, as a file server does for a moment, and has not done so for the time called quiet.
    pub fn may_pass(&mut self, error: &Error) -> bool {
        let Error::Table(TableError::Io { source, .. }) = error else {
            self.failing = None;
            return false;
        };
        let since = *self.failing.get_or_insert_with(Instant::now);
        !self.looks_once && source.kind() != ErrorKind::PermissionDenied && since.elapsed() < self.after
    }

    /// Notes that a file was read.
    pub fn was_read(&mut self) {
        self.failing = None;
    }

    fn see(&mut self, files: Vec<PathBuf>, bytes: u64, written: Option<SystemTime>) -> Sight {
        let now = match self.seen.get(&files) {
            Some(seen) if (seen.bytes, seen.written) == (bytes, written) => *seen,
            before => Seen { bytes, written, since: Instant::now(), is_altered: before.is_some() },
        };
        self.seen.insert(files, now);
        let age = written.and_then(|written| written.elapsed().ok()).filter(|_| !now.is_altered);
        let watched = now.since.elapsed();
        let is_old = age.is_some_and(|age| age >= self.after);
        let is_standing = self.looks_once || watched >= STANDING.min(self.after);
        Sight {
            bytes,
            written,
            stood: if self.looks_once { age.unwrap_or_default() } else { watched },
            changed: SystemTime::now().checked_sub(age.unwrap_or_default().max(watched)),
            is_old,
            left_alone: watched >= self.after || is_standing && is_old,
        }
    }
}

/// The progress of work that ends when `stop` is raised.
pub(super) fn until(stop: &AtomicBool) -> ControlFlow<()> {
    if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// Sleeps, but not on when `stop` is raised.
pub(super) fn wait(time: Duration, stop: &AtomicBool) {
    /// How soon a stop is noticed.
    const SLICE: Duration = Duration::from_millis(50);
    let begun = Instant::now();
    while !stop.load(Ordering::Relaxed)
        && let Some(left) = time.checked_sub(begun.elapsed()).filter(|left| !left.is_zero())
    {
        thread::sleep(left.min(SLICE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MINUTE: Duration = Duration::from_secs(60);
    const SOON: Duration = Duration::from_millis(20);

    /// A file server whose clock lags by an hour dates a growing record back.
    #[test]
    fn a_record_that_grows_is_not_left_alone_whatever_its_time() {
        let lagging = || SystemTime::now().checked_sub(60 * MINUTE);
        let (mut quiet, file) = (Quiet::new(MINUTE, false), || vec![PathBuf::from("m01.csv")]);
        for bytes in 1..5 {
            assert!(!quiet.see(file(), bytes, lagging()).left_alone);
        }
        let changed = quiet.see(file(), 5, lagging()).changed.unwrap();
        assert!(changed.elapsed().unwrap() < MINUTE, "by the clock of the watch");
        // Two looks alike between two lines of a recorder.
        let (old, new) = (lagging(), || vec![PathBuf::from("m02.csv")]);
        assert!(!quiet.see(new(), 9, old).left_alone && !quiet.see(new(), 9, old).left_alone, "it may grow");
        assert!(Quiet::new(MINUTE, true).see(new(), 9, old).left_alone);
    }

    /// Where a file has stood for a while, its time counts too.
    #[test]
    fn an_old_record_need_not_be_watched_for_long() {
        let written = |age: Duration| SystemTime::now().checked_sub(age);
        for (age, is_left_alone) in [(60 * MINUTE, true), (MINUTE / 2, false)] {
            let (mut quiet, file, written) = (Quiet::new(MINUTE, false), vec![PathBuf::from("m01.csv")], written(age));
            assert!(!quiet.see(file.clone(), 9, written).left_alone);
            let seen = quiet.seen.values_mut().next().unwrap();
            seen.since = seen.since.checked_sub(STANDING).unwrap();
            assert_eq!(quiet.see(file, 9, written).left_alone, is_left_alone);
        }
    }

    /// A record dated to the future.
    #[test]
    fn a_record_that_stands_is_left_alone_whatever_its_time() {
        let future = SystemTime::now().checked_add(60 * MINUTE);
        let (mut quiet, file) = (Quiet::new(SOON, false), || vec![PathBuf::from("m01.csv")]);
        assert!(!quiet.see(file(), 9, future).left_alone);
        thread::sleep(SOON);
        let sight = quiet.see(file(), 9, future);
        assert!(sight.left_alone && sight.stood >= SOON);
    }
}
