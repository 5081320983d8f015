//! What is said to `centrical watch`.

use std::path::PathBuf;
use std::time::Duration;

use centrical_session::{PlateauName, WatchRequest};

use crate::given::{probability, seconds, target};
#[cfg(feature = "serve")]
use crate::serving::Serving;

/// Monitor a session folder while the laboratory is still adding records: after each plateau the uncertainties and the
/// benefit of the next; the calibration when the schedule is complete. After Ctrl-C it resumes when started again.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical watch examples/ta-200 --out watched --target bias=0.01")]
pub struct Arguments {
    /// The session folder, or its experiment.toml
    pub session: PathBuf,
    /// Folder for watch.json (its state), watch-history.jsonl (a line per plateau), its plot and result.json
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// A target standard uncertainty in the unit of the table, e.g. --target bias=0.01; may be repeated
    #[arg(long, value_name = "GROUP=VALUE", value_parser = target)]
    pub target: Vec<(String, f64)>,
    /// False-alarm probability per session
    #[arg(long, value_name = "CHANCE", default_value_t = 0.01, value_parser = probability)]
    pub false_alarm: f64,
    /// Hold out a plateau, e.g. 4:3 for the third of the fourth mounting; may be repeated
    #[arg(long, value_name = "MOUNTING:PLATEAU")]
    pub hold_out: Vec<PlateauName>,
    /// Hold out every plateau that raises an alarm; from the result only those that all plateaus single out, if they are fewer
    #[arg(long)]
    pub hold_out_alarms: bool,
    /// Seconds between two readings of the folder
    #[arg(long, value_name = "SECONDS", default_value = "2", value_parser = seconds)]
    pub interval: Duration,
    /// Seconds without change after which a record counts as finished; this is not the --quiet of other commands, and has no -q
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = seconds)]
    pub quiet: Duration,
    /// Seconds without a sample after which a record counts as frozen in the midst of its schedule
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = seconds)]
    pub frozen: Duration,
    /// Process what is present and exit
    #[arg(long)]
    pub once: bool,
    /// Run a command of the shell when a plateau does not fit, a record is frozen or the watch fails; CENTRICAL_ALARM and CENTRICAL_MESSAGE say which
    #[arg(long, value_name = "COMMAND")]
    pub on_alarm: Option<String>,
    #[cfg(feature = "serve")]
    #[command(flatten)]
    pub serving: Serving,
    /// Print a line of JSON per plateau instead of the table, as in watch-history.jsonl, and nothing else
    #[arg(short, long)]
    pub json: bool,
}

impl Arguments {
    /// How the session is watched, and whether the watch is shown.
    pub fn request(&self, is_shown: bool) -> WatchRequest {
        WatchRequest {
            out: self.out.clone(),
            false_alarm: self.false_alarm,
            hold_out: self.hold_out.clone(),
            hold_out_alarms: self.hold_out_alarms,
            groups: self.target.iter().map(|(group, _)| group.clone()).collect(),
            interval: self.interval,
            quiet: self.quiet,
            frozen: self.frozen,
            once: self.once,
            live: is_shown.then(|| self.target.clone()),
        }
    }
}
