//! How a session is watched, what happens meanwhile, and how it ends.

use std::path::{Path, PathBuf};
use std::time::Duration;

use centrical::MeasurementModel;

use super::board::WatchProgress;
use crate::document::CalibrationResult;
use crate::error::Error;
use crate::experiment::PlateauName;

/// How a session is watched.
#[derive(Debug, Clone, PartialEq)]
pub struct WatchRequest {
    /// Folder for the state, the history and the result.
    pub out: PathBuf,
    /// Probability that a good session raises an alarm.
    pub false_alarm: f64,
    /// Plateaus that are held out whatever their test says.
    pub hold_out: Vec<PlateauName>,
    /// Whether plateaus that raise an alarm are held out.
    pub hold_out_alarms: bool,
    /// Groups of parameters for which an uncertainty is wanted.
    pub groups: Vec<String>,
    /// Time between two looks at the folder.
    pub interval: Duration,
    /// Time without change after which a record counts as finished.
    pub quiet: Duration,
    /// Time without a sample after which a record counts as frozen in the midst of its schedule.
    pub frozen: Duration,
    /// Whether one look is enough.
    pub once: bool,
    /// If the watch is shown in `watch-live.json`, the target standard uncertainties beside it: group, and value in its customary unit.
    pub live: Option<Vec<(String, f64)>>,
}

impl WatchRequest {
    /// A time in seconds, up to a day.
    ///
    /// # Errors
    /// What was found and expected.
    pub fn time(seconds: f64) -> Result<Duration, String> {
        let is_time = (0.0..=86400.0).contains(&seconds);
        is_time
            .then(|| Duration::from_secs_f64(seconds))
            .ok_or_else(|| format!("found {seconds}, expected seconds from 0 to 86400"))
    }
}

/// What happens while a session is watched.
#[derive(Debug)]
pub enum WatchEvent<'a> {
    /// The session is followed from now on, by this model.
    Begun(&'a MeasurementModel),
    /// It was followed by this model: rests that were waited for have come, or the watch ends.
    Followed(&'a MeasurementModel),
    /// A plateau was taken up or held out.
    Plateau(WatchProgress<'a>),
    /// What is waited for.
    Waiting(&'a str),
    /// A record has stopped growing in the midst of its schedule.
    Frozen {
        /// Its file.
        file: &'a Path,
        /// Since it changed last.
        age: Duration,
    },
    /// The watch ends with this error.
    Failed(&'a Error),
}

/// How a watch ends.
#[derive(Debug)]
pub enum WatchEnd {
    /// Stopped; the state on disk is whole.
    Stopped {
        /// Plateaus that have arrived.
        plateaus: usize,
    },
    /// The schedule is complete: the calibration of the session, from its files anew.
    Complete(Box<CalibrationResult>),
}
