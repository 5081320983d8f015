//! `centrical calibrate SESSION`: from a session folder to calibrated parameters.

use std::path::PathBuf;

use centrical_report::{refuse_outputs, states_text};
use centrical_session::{
    Error, Method, OnProgress, PlateauName, Session, Store, add_result, calibrate, claim_folder, refuse_date,
    wait_for_store,
};

use crate::documents::Documents;
use crate::output::{Outcome, Printing, remark, say, say_waiting};
use crate::progress;

/// Calibrate a unit from a session folder: plateau means, fit, result.json.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical calibrate examples/ta-200 --out results")]
pub struct Arguments {
    /// The session folder, or its experiment.toml
    session: PathBuf,
    /// Folder for result.json, the report and its plots, created if absent [default: result.json alone, in the current
    /// folder; with --json no file]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Add the result to a store of calibrations, created if absent
    #[arg(long, value_name = "DIR")]
    store: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
    #[command(flatten)]
    documents: Documents,
    /// Make the linear fit of [K5.3] alone, with its second-order error
    #[arg(long)]
    linear: bool,
    /// How the fit is computed: all plateaus at once, or by the recursive filter, which gives the same estimates
    #[arg(long, value_enum, default_value_t = FitMethod::Batch)]
    method: FitMethod,
    /// Hold a plateau out of the fit, e.g. 4:3 for the third of the fourth mounting; may be repeated
    #[arg(long, value_name = "MOUNTING:PLATEAU")]
    hold_out: Vec<PlateauName>,
}

/// How the fit is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum FitMethod {
    Batch,
    Recursive,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let session = Session::read(&arguments.session)?;
    let method = match (arguments.linear, arguments.method) {
        (false, FitMethod::Batch) => Method::Exact,
        (false, FitMethod::Recursive) => Method::Recursive,
        (true, FitMethod::Batch) => Method::Linear,
        (true, FitMethod::Recursive) => Method::RecursiveLinear,
    };
    if arguments.method == FitMethod::Recursive && !arguments.printing.quiet {
        let order: Vec<usize> = (0..session.experiment.set_points.len()).collect();
        remark(&states_text(&session.model()?, &order));
    }
    let out = arguments.out.as_deref();
    let claim = out.map(claim_folder).transpose()?;
    let file = match (out, arguments.printing.json) {
        (Some(folder), _) => Some(folder.join("result.json")),
        (None, false) => Some(PathBuf::from("result.json")),
        (None, true) => None,
    };
    let laboratory = arguments.documents.laboratory.as_deref();
    let inputs = [session.files(), laboratory.into_iter().collect()].concat();
    refuse_outputs(file.as_deref(), out, &inputs, [&session.unit_model, &session.unit_serial])?;
    if let Some(store) = arguments.store.as_deref() {
        Store::refuse_inputs(store, &inputs)?;
        refuse_date(&session.file, &session.date)?;
    }
    let job = |progress: OnProgress| calibrate(&session, &arguments.hold_out, method, progress);
    let result = progress::reading(&session, arguments.printing, job)?;
    let result = arguments.documents.in_axes(result, &arguments.session)?;
    // With a folder the result is written there beside its documents.
    let written = file.as_deref().filter(|_| out.is_none()).map_or(Ok(()), |file| result.write(file));
    let file = file.as_deref().filter(|_| written.is_ok());
    let outcome = arguments.documents.hand_over(&result, arguments.printing, out, file);
    let outcome = written.and(outcome);
    drop(claim);
    let Some(store) = arguments.store.as_deref() else { return outcome };
    let kept = wait_for_store(store, &say_waiting).and_then(|()| add_result(store, &result, false));
    match (kept, outcome) {
        (Ok(_), outcome) => outcome,
        (Err(not_kept), Ok(_)) => {
            say(&format!("{}: the result is not in this store; all other files are written\n", store.display()));
            Err(not_kept)
        }
        (Err(not_kept), failed) => {
            say(&format!("centrical: {not_kept}\n"));
            failed
        }
    }
}
