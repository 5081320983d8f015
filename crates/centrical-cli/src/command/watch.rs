//! `centrical watch SESSION`: monitors a session folder while records arrive.

mod arguments;
mod events;

#[cfg(feature = "serve")]
use std::sync::atomic::Ordering;

#[cfg(feature = "serve")]
use centrical_live::Watched;
#[cfg(feature = "serve")]
use centrical_session::WatchEnd;
use centrical_session::{Error, Session, watch};

pub use self::arguments::Arguments;
use self::events::{say_end, say_event};
use crate::alarm::Alarm;
use crate::interruption::asked_to_end;
use crate::output::Outcome;
#[cfg(feature = "serve")]
use crate::output::say;
#[cfg(feature = "serve")]
use crate::serving::{remain, serve};

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let session = Session::read_before_rests(&arguments.session)?;
    #[cfg(feature = "serve")]
    let mut server = arguments.serving.bind()?;
    #[cfg(feature = "serve")]
    let is_shown = server.is_some();
    #[cfg(not(feature = "serve"))]
    let is_shown = false;
    let request = arguments.request(is_shown);
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
