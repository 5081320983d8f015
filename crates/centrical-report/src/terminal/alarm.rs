//! What an alarm of a watch says.

use std::path::Path;
use std::time::Duration;

use centrical_session::{PlateauName, WatchEvent};

/// What an alarm is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AlarmKind {
    /// A plateau that does not fit.
    Plateau,
    /// A record that is frozen.
    Frozen,
    /// A record that is wrong, or another error that ends the watch.
    Failed,
}

impl AlarmKind {
    /// Its name for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plateau => "plateau",
            Self::Frozen => "frozen",
            Self::Failed => "failed",
        }
    }
}

/// The alarm of an event and what was found, if the event is one.
pub fn alarm_text(event: &WatchEvent) -> Option<(AlarmKind, String)> {
    match event {
        WatchEvent::Plateau(progress) => {
            let last = progress.plateaus.last().filter(|last| last.alarm)?;
            let PlateauName { mounting, plateau } = PlateauName::of(progress.session, last.set_point);
            let probability = last.innovation().probability();
            let found = format!("plateau {mounting}:{plateau} does not fit: a chance of {probability:.2e}");
            Some((AlarmKind::Plateau, found))
        }
        WatchEvent::Frozen { file, age } => Some((AlarmKind::Frozen, frozen_text(file, *age))),
        WatchEvent::Failed(error) => Some((AlarmKind::Failed, error.to_string())),
        WatchEvent::Begun(_) | WatchEvent::Followed(_) | WatchEvent::Waiting(_) => None,
    }
}

/// What is said of a frozen record.
pub fn frozen_text(file: &Path, age: Duration) -> String {
    format!("{}: found no new sample for {:.0} s, expected a record that grows", file.display(), age.as_secs_f64())
}
