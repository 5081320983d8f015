//! `centrical tumble RECORD...|SESSION`: a unit that was turned by hand or on a table, calibrated by gravity alone.

mod arguments;
mod hand_over;

use std::path::{Path, PathBuf};

use centrical_session::{Error, Method, Session, calibrate, claim_folder, tumble, unwatched};

pub use self::arguments::Arguments;
use self::hand_over::RESULT;
use crate::outcome::Outcome;
use crate::output::remark_unused_time;

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    match &arguments.records[..] {
        [session] if Session::is_named_by(session) => of_session(arguments, session),
        _ => of_records(arguments),
    }
}

/// By records whose rests are still to be found.
fn of_records(arguments: &Arguments) -> Result<Outcome, Error> {
    let request = arguments.request()?;
    if request.rate.is_some() && !arguments.printing.quiet {
        remark_unused_time(request.files.iter().map(PathBuf::as_path));
    }
    let out = arguments.out.as_deref();
    let claim = out.map(claim_folder).transpose()?;
    arguments.refuse_inputs(request.inputs())?;
    let mut tumble = tumble(&request, out.unwrap_or(Path::new("")), &unwatched)?;
    tumble.result = arguments.documents.in_axes(tumble.result, &request.files[0])?;
    let outcome = arguments.hand_over(&tumble.result, |folder| tumble.write(&request, folder));
    drop(claim);
    outcome
}

/// By the rests of a session alone.
fn of_session(arguments: &Arguments, path: &Path) -> Result<Outcome, Error> {
    arguments.refuse_what_a_session_states(path)?;
    let session = Session::read(path)?.off_arm(&arguments.terms)?;
    let out = arguments.out.as_deref();
    let claim = out.map(claim_folder).transpose()?;
    arguments.refuse_inputs(session.files().into_iter())?;
    let result = calibrate(&session, Method::Exact, &unwatched)?;
    let result = arguments.documents.in_axes(result, path)?;
    let outcome = arguments.hand_over(&result, |folder| result.write(&folder.join(RESULT)));
    drop(claim);
    outcome
}
