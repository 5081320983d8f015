//! The live page of a watch: everything on it comes from the files of the watch.

use std::fmt::Write;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use centrical_report::{LIVE_SCRIPT, LIVE_STYLE, Language, live_page, live_panel};
use centrical_session::{Error, GroupProgress, HistoryEntry, LiveReport, LiveStatus, read_history, seconds_since_1970};
use serde_json::{Map, Value};

use super::answer::{Answer, Query, Site};

/// The folder of a watch.
#[derive(Debug)]
pub struct Watched {
    live: PathBuf,
    history: PathBuf,
    /// The history as it was read last, and what its file looked like then.
    read: Mutex<(u64, Vec<HistoryEntry>)>,
}

impl Watched {
    /// The watch that writes to `folder`.
    pub fn new(folder: &Path) -> Self {
        let (live, history) = (folder.join("watch-live.json"), folder.join("watch-history.jsonl"));
        Self { live, history, read: Mutex::default() }
    }

    /// Whether a watch has written there.
    pub fn is_there(&self) -> bool {
        self.live.exists()
    }

    /// Draws with what the watch saw last and its history.
    fn with<T>(&self, draw: impl FnOnce(&LiveReport, &[HistoryEntry], f64) -> T) -> Result<T, Error> {
        let live = LiveReport::read(&self.live)?;
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let stamp = stamp_of(&self.history);
        if read.0 != stamp {
            *read = (stamp, if self.history.exists() { read_history(&self.history)? } else { Vec::new() });
        }
        Ok(draw(&live, &read.1, now()))
    }

    /// What the watch saw last, with the time and the age of the last sample.
    fn state(&self) -> Result<String, Error> {
        let live = LiveReport::read(&self.live)?;
        let now = now();
        let mut state = match serde_json::to_value(&live) {
            Ok(Value::Object(state)) => state,
            _ => Map::new(),
        };
        state.insert("now".to_owned(), Value::from(now));
        state.insert("age".to_owned(), live.age(now).map_or(Value::Null, Value::from));
        state.insert("silent".to_owned(), Value::from(live.is_silent(now)));
        Ok(format!("{}\n", Value::Object(state)))
    }
}

impl Site for Watched {
    fn answer(&self, path: &str, query: &Query) -> Option<Answer> {
        let language = query.language();
        match path {
            "/" => Some(self.with(|live, history, now| Answer::Page(live_page(live, history, now, language))).into()),
            "/live.css" => Some(Answer::File("text/css; charset=utf-8", LIVE_STYLE.to_owned())),
            "/live.js" => Some(Answer::File("text/javascript; charset=utf-8", LIVE_SCRIPT.to_owned())),
            "/state.json" => Some(self.state().map(|state| Answer::File("application/json", state)).into()),
            _ => None,
        }
    }

    fn has_panel(&self) -> bool {
        true
    }

    fn stamp(&self) -> u64 {
        stamp_of(&self.live)
    }

    fn panel(&self, language: Language) -> Option<String> {
        // The folder may be on its way: the page stays as it was, and shows the age of the last sample.
        self.with(|live, history, now| live_panel(live, history, now, language)).ok()
    }

    fn metrics(&self) -> String {
        LiveReport::read(&self.live).map_or_else(|_| up(false), |live| metrics(&live, now()))
    }
}

/// What a file looks like from outside.
fn stamp_of(file: &Path) -> u64 {
    let mut hasher = DefaultHasher::new();
    if let Ok(metadata) = fs::metadata(file) {
        (1_u8, metadata.len(), metadata.modified().ok()).hash(&mut hasher);
    }
    hasher.finish()
}

fn now() -> f64 {
    seconds_since_1970(SystemTime::now())
}

fn up(is_up: bool) -> String {
    let up = u8::from(is_up);
    format!(
        "# HELP centrical_watch_up Whether a watch writes.\n# TYPE centrical_watch_up gauge\ncentrical_watch_up {up}\n"
    )
}

/// What the watch saw last, in Prometheus' text.
fn metrics(live: &LiveReport, now: f64) -> String {
    let mut text = up(live.status == LiveStatus::Following && !live.is_silent(now));
    let mut gauge = |name: &str, help: &str, value: Option<f64>| {
        if let Some(value) = value {
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "# HELP centrical_{name} {help}\n# TYPE centrical_{name} gauge\ncentrical_{name} {value}"
            );
        }
    };
    let last = live.last.as_ref();
    gauge("plateaus_arrived", "Plateaus that have arrived.", Some(live.arrived as f64));
    gauge("plateaus", "Plateaus of the schedule.", Some(live.plateaus as f64));
    gauge("alarms", "Plateaus that do not fit.", Some(live.alarms.len() as f64));
    gauge("rank", "Rank so far.", Some(live.rank as f64));
    gauge("unknowns", "Number of unknowns.", Some(live.unknowns as f64));
    gauge(
        "last_plateau_probability",
        "Chance of a test as large as the last plateau's.",
        last.map(|last| last.innovation.probability),
    );
    gauge("last_sample_age_seconds", "Time since the record grew.", live.age(now));
    let frozen = live.record.as_ref().map(|record| f64::from(u8::from(record.frozen)));
    gauge("record_frozen", "Whether the record has stopped growing.", frozen);
    gauge("schedule_end_seconds", "When the schedule will end, since 1970.", live.ends);
    gauge("rivals", "Effects outside the model that the residuals show.", Some(live.rivals.len() as f64));
    gauge(
        "result_acceptable",
        "Whether the calibration is acceptable.",
        live.acceptable.map(|good| f64::from(u8::from(good))),
    );
    let mut of_groups = |name: &str, help: &str, value: fn(&GroupProgress) -> Option<f64>| {
        let _ = writeln!(text, "# HELP centrical_{name} {help}\n# TYPE centrical_{name} gauge");
        for (group, value) in live.groups.iter().filter_map(|group| Some((group, value(group)?))) {
            let (group, unit) = (group.group.name(), &group.unit);
            let _ = writeln!(text, "centrical_{name}{{group=\"{group}\",unit=\"{unit}\"}} {value}");
        }
    };
    let help = "Largest standard uncertainty of a group, in its customary unit.";
    of_groups("largest_uncertainty", help, |group| group.largest);
    of_groups("target_uncertainty", "Target of a group, in its customary unit.", |group| group.target);
    text
}
