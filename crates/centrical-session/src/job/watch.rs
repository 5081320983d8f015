//! A session folder that is monitored while the laboratory is still adding records.

mod arrivals;
mod board;
mod changed;
mod following;
mod growth;
mod note;
mod quiet;
mod request;
mod rests;

use std::sync::atomic::{AtomicBool, Ordering};

use centrical_table::claim_folder;

pub use self::arrivals::Watch;
pub use self::board::WatchProgress;
use self::following::{Following, STATE_FILE};
use self::quiet::Quiet;
pub use self::request::{WatchEnd, WatchEvent, WatchRequest};
use crate::document::{CalibrationResult, WatchState};
use crate::error::Error;
use crate::experiment::{Session, refuse_inputs};

/// Files that a watch writes into its folder; the plot is drawn by who hears the events.
const OUTPUTS: [&str; 5] = ["watch.json", "watch-history.jsonl", "watch-history.svg", "watch-live.json", "result.json"];

/// Watches a session ([`Session::read_before_rests`]) until its schedule is complete or `stop` is raised. Rests join it when their files
/// are there: the watch then begins anew with the model of them.
///
/// # Errors
/// [`Error`] when the request names an unknown group or plateau, or a finished record is wrong. Likewise when the folder is in use,
/// holds an input, the state of another session or the result of another unit, or does not take the state.
pub fn watch(
    session: &Session,
    request: &WatchRequest,
    stop: &AtomicBool,
    report: &mut dyn FnMut(WatchEvent),
) -> Result<WatchEnd, Error> {
    let _claim = claim_folder(&request.out)?;
    let outputs @ [.., result] = &OUTPUTS.map(|name| request.out.join(name));
    refuse_inputs(outputs, &session.files())?;
    CalibrationResult::refuse_another_unit(result, &session.unit_model, &session.unit_serial)?;
    let mut quiet = Quiet::new(request.quiet, request.once);
    let mut is_waiting = false;
    loop {
        let session = rests::with_rests_there(session, &mut quiet, &|_| quiet::until(stop))?;
        let model = session.model()?;
        let unknowns = model.parameters().len() + model.influences().len();
        let state = match WatchState::resume(&session, unknowns, &request.out.join(STATE_FILE))? {
            Ok(state) => state,
            Err(plateaus) => {
                // Rests that it had taken up are waited for, as a watch that begins does.
                if let Some(file) = rests::awaited(&session).filter(|_| !is_waiting) {
                    report(WatchEvent::Waiting(&format!("waiting for {}", file.display())));
                }
                is_waiting = true;
                if !request.once {
                    quiet::wait(request.interval, stop);
                }
                if request.once || stop.load(Ordering::Relaxed) {
                    return Ok(WatchEnd::Stopped { plateaus });
                }
                continue;
            }
        };
        let mut following = Following::resume(request, &session, &model, state)?;
        report(WatchEvent::Begun(&model));
        let end = following.run(stop, &mut quiet, report).inspect_err(|error| {
            if !matches!(error, Error::Stopped(_)) {
                report(WatchEvent::Failed(error));
            }
        })?;
        report(WatchEvent::Followed(&model));
        if let Some(end) = end {
            return Ok(end);
        }
    }
}
