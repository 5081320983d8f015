//! How long records have been left alone. The clock of the machine that writes them may be off: what a watch sees itself decides.

use std::collections::BTreeMap;
use std::time::{Duration, Instant, SystemTime};

/// What a watch has seen of the records of mountings.
#[derive(Debug, Clone)]
pub(super) struct Quiet {
    /// Time after which a record counts as left alone.
    pub after: Duration,
    /// Whether the watch looks once: the times of the files are then all that it has.
    pub looks_once: bool,
    seen: BTreeMap<usize, Seen>,
}

/// How a record looked.
#[derive(Debug, Clone, Copy)]
struct Seen {
    bytes: u64,
    changed: Option<SystemTime>,
    /// Since when it has looked so.
    since: Instant,
    /// Whether it has looked so before.
    is_again: bool,
    /// Whether it has looked otherwise.
    is_altered: bool,
}

impl Quiet {
    /// Before the first look.
    pub fn new(after: Duration, looks_once: bool) -> Self {
        Self { after, looks_once, seen: BTreeMap::new() }
    }

    /// Notes that the record of a mounting looks so; whether it has been left alone. The time of the file counts only where the watch has seen
    /// it twice, and always alike.
    pub fn is_left_alone(&mut self, mounting: usize, bytes: u64, changed: Option<SystemTime>) -> bool {
        let new = |is_altered| Seen { bytes, changed, since: Instant::now(), is_again: false, is_altered };
        let now = match self.seen.get(&mounting) {
            Some(seen) if (seen.bytes, seen.changed) == (bytes, changed) => Seen { is_again: true, ..*seen },
            before => new(before.is_some()),
        };
        self.seen.insert(mounting, now);
        let by_its_time = || changed.and_then(|changed| changed.elapsed().ok()).is_some_and(|age| age >= self.after);
        let has_its_time = !now.is_altered && (now.is_again || self.looks_once);
        now.since.elapsed() >= self.after || has_its_time && by_its_time()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MINUTE: Duration = Duration::from_secs(60);

    /// A file server whose clock lags by an hour dates a growing record back.
    #[test]
    fn a_record_that_grows_is_not_left_alone_whatever_its_time() {
        let lagging = || SystemTime::now().checked_sub(60 * MINUTE);
        let mut quiet = Quiet::new(MINUTE, false);
        for bytes in 1..5 {
            assert!(!quiet.is_left_alone(0, bytes, lagging()));
        }
        let old = lagging();
        assert!(!quiet.is_left_alone(1, 9, old), "it may grow");
        assert!(quiet.is_left_alone(1, 9, old));
        assert!(Quiet::new(MINUTE, true).is_left_alone(1, 9, old));
    }

    /// A record dated to the future.
    #[test]
    fn a_record_that_stands_is_left_alone_whatever_its_time() {
        let future = SystemTime::now().checked_add(60 * MINUTE);
        let mut quiet = Quiet::new(Duration::from_millis(20), false);
        assert!(!quiet.is_left_alone(0, 9, future));
        std::thread::sleep(Duration::from_millis(25));
        assert!(quiet.is_left_alone(0, 9, future));
    }
}
