//! `centrical watch SESSION`: monitors a session folder while records arrive.

mod arguments;

use std::io::{self, IsTerminal};
#[cfg(feature = "serve")]
use std::sync::atomic::Ordering;

#[cfg(feature = "serve")]
use centrical_live::Watched;
use centrical_report::{counted, frozen_text, result_text, states_text, watch_table, write_history_plot};
#[cfg(feature = "serve")]
use centrical_session::LiveRequest;
use centrical_session::{Error, Session, WatchEnd, WatchEvent, watch};

pub use self::arguments::Arguments;
use crate::alarm::Alarm;
use crate::command::calibrate::refuse_another_unit;
use crate::interruption::asked_to_end;
use crate::output::{Outcome, print, print_as_it_is, remark, say, show};
#[cfg(feature = "serve")]
use crate::serving::{remain, serve};

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
