//! `centrical watch SESSION`: monitors a session folder while records arrive.

use std::io::{self, IsTerminal};
use std::path::PathBuf;
#[cfg(feature = "serve")]
use std::sync::atomic::Ordering;
use std::time::Duration;

#[cfg(feature = "serve")]
use centrical_live::Watched;
use centrical_report::{counted, frozen_text, result_text, states_text, watch_table, write_history_plot};
use centrical_session::{Error, LiveRequest, PlateauName, Session, WatchEnd, WatchEvent, WatchRequest, watch};

use crate::alarm::Alarm;
use crate::command::calibrate::refuse_another_unit;
use crate::given::{probability, seconds, target};
use crate::interruption::asked_to_end;
use crate::output::{Outcome, print, print_as_it_is, remark, say, show};
#[cfg(feature = "serve")]
use crate::serving::{Serving, remain, serve};

/// Monitor a session folder while the laboratory is still adding records: after each plateau the uncertainties and the
/// benefit of the next; the calibration when the schedule is complete. After Ctrl-C it resumes when started again.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical watch examples/ta-200 --out watched --target bias=0.01")]
pub struct Arguments {
    /// The session folder, or its experiment.toml
    session: PathBuf,
    /// Folder for watch.json (its state), watch-history.jsonl (a line per plateau), its plot and result.json
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// A target standard uncertainty in the unit of the table, e.g. --target bias=0.01; may be repeated
    #[arg(long, value_name = "GROUP=VALUE", value_parser = target)]
    target: Vec<(String, f64)>,
    /// False-alarm probability per session
    #[arg(long, value_name = "CHANCE", default_value_t = 0.01, value_parser = probability)]
    false_alarm: f64,
    /// Hold out a plateau, e.g. 4:3 for the third of the fourth mounting; may be repeated
    #[arg(long, value_name = "MOUNTING:PLATEAU")]
    hold_out: Vec<PlateauName>,
    /// Hold out every plateau that raises an alarm; in the result those that all plateaus single out, if they are fewer
    #[arg(long)]
    hold_out_alarms: bool,
    /// Seconds between two readings of the folder
    #[arg(long, value_name = "SECONDS", default_value = "2", value_parser = seconds)]
    interval: Duration,
    /// Seconds without change after which a record counts as finished; this is not the --quiet of other commands, and has no -q
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = seconds)]
    quiet: Duration,
    /// Seconds without a sample after which a record counts as frozen in the midst of its schedule
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = seconds)]
    frozen: Duration,
    /// Process what is present and exit
    #[arg(long)]
    once: bool,
    /// Run a command of the shell when a plateau does not fit, a record is frozen or the watch fails; CENTRICAL_ALARM and CENTRICAL_MESSAGE say which
    #[arg(long, value_name = "COMMAND")]
    on_alarm: Option<String>,
    #[cfg(feature = "serve")]
    #[command(flatten)]
    serving: Serving,
    /// Print a line of JSON per plateau instead of the table, as in watch-history.jsonl, and nothing else
    #[arg(short, long)]
    json: bool,
}

impl Arguments {
    /// How the session is watched.
    fn request(&self, live: Option<LiveRequest>) -> WatchRequest {
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
            live,
        }
    }
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let session = Session::read_before_rests(&arguments.session)?;
    refuse_another_unit(&arguments.out.join("result.json"), &session)?;
    #[cfg(feature = "serve")]
    let mut server = arguments.serving.bind()?;
    #[cfg(feature = "serve")]
    let live = server.as_ref().map(|_| LiveRequest { targets: arguments.target.clone() });
    #[cfg(not(feature = "serve"))]
    let live = None;
    let request = arguments.request(live);
    let alarm = Alarm::new(arguments.on_alarm.as_deref(), &session.file);
    #[cfg(feature = "serve")]
    let mut url = None;
    let mut shown = Ok(());
    let end = watch(&session, &request, asked_to_end(), &mut |event| {
        alarm.hear(&event);
        let outcome = say_event(&event, arguments);
        // The page needs what a watch that has begun writes.
        #[cfg(feature = "serve")]
        if let Some(server) = server.take() {
            match serve(server, Watched::new(&arguments.out)) {
                Ok(served) => url = Some(served),
                Err(error) => {
                    asked_to_end().store(true, Ordering::Relaxed);
                    shown = Err(error);
                }
            }
        }
        if shown.is_ok() {
            shown = outcome;
        }
    });
    #[cfg(feature = "serve")]
    if let (Err(error), Some(url), true) = (&end, &url, Watched::new(&arguments.out).is_there()) {
        // The page says what was wrong to one who comes later.
        say(&format!("{error}\n"));
        remain(url);
    }
    let end = end?;
    shown?;
    #[cfg(feature = "serve")]
    let is_complete = matches!(end, WatchEnd::Complete(_));
    let outcome = say_end(end, arguments)?;
    #[cfg(feature = "serve")]
    if let Some(url) = url.filter(|_| is_complete) {
        remain(&url);
    }
    Ok(outcome)
}

/// How the watch ended; of a complete schedule the result.
fn say_end(end: WatchEnd, arguments: &Arguments) -> Result<Outcome, Error> {
    match end {
        WatchEnd::Stopped { plateaus } => {
            let (file, count) = (arguments.out.join("watch.json"), counted(plateaus, "plateau"));
            say(&format!("Stopped after {count}; the same command goes on from {}\n", file.display()));
            Ok(Outcome::Done)
        }
        WatchEnd::Complete(result) => {
            let (objections, file) = (result.objections(), arguments.out.join("result.json"));
            let said = format!("The schedule is complete. Written to {}", file.display());
            if !arguments.json {
                show(&result_text(&result, None, Some(&said)))?;
            }
            Ok(Outcome::acceptable(objections.is_empty()))
        }
    }
}

/// What has happened.
fn say_event(event: &WatchEvent, arguments: &Arguments) -> Result<(), Error> {
    match event {
        WatchEvent::Begun(model) => {
            let order: Vec<usize> = (0..model.experiment().set_points.len()).collect();
            remark(&states_text(model, &order));
        }
        WatchEvent::Followed(model) => write_history_plot(model, &arguments.out)?,
        WatchEvent::Waiting(note) => say(&format!("{note}\n")),
        WatchEvent::Frozen { file, age } => say(&format!("{}\n", frozen_text(file, *age))),
        // The error is printed where the command ends.
        WatchEvent::Failed(_) => {}
        WatchEvent::Plateau(progress) if arguments.json => {
            if let Some(last) = progress.plateaus.last() {
                print(&last.entry(progress.plateaus.len(), progress.model, &progress.now).line()?)?;
            }
        }
        WatchEvent::Plateau(progress) => {
            // On a terminal the table stays in its place.
            let is_cleared = io::stdout().is_terminal();
            if is_cleared {
                print_as_it_is("\x1b[2J\x1b[H")?;
            }
            let mut screen = watch_table(progress, &arguments.target, is_cleared);
            screen.gap();
            show(&screen)?;
        }
    }
    Ok(())
}
