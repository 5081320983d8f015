//! What is said while a session is watched, and at the end.

use std::io::{self, IsTerminal};

use centrical_report::{counted, frozen_text, result_text, states_text, watch_table, write_history_plot};
use centrical_session::{Error, WatchEnd, WatchEvent};

use super::arguments::Arguments;
use crate::output::{Outcome, print, print_as_it_is, remark, say, show};

/// How the watch ended; of a complete schedule the result.
pub fn say_end(end: WatchEnd, arguments: &Arguments) -> Result<Outcome, Error> {
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
pub fn say_event(event: &WatchEvent, arguments: &Arguments) -> Result<(), Error> {
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
