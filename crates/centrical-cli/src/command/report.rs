//! `centrical report RESULT`: the documents that a laboratory hands over, from a result.

use std::path::PathBuf;

use centrical_report::{DocumentRequest, UnitStatement, exact_text, objections_text, unit_text, write_documents};
use centrical_session::{Axes, DocumentsReport, Error, Place};

use crate::documents::{Documents, is_within_limits, remark_other_days};
use crate::given::force_range;
use crate::output::{Outcome, Printing, remark};

/// Write the documents of a calibration from its result.json.
#[derive(Debug, clap::Args)]
#[command(
    arg_required_else_help = true,
    after_help = "Example: centrical report results/result.json --html report.html --code compensation"
)]
pub struct Arguments {
    /// The result.json of a calibration
    result: PathBuf,
    /// Write the report to this file: one self-contained HTML page
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Add a plot of the uncertainties during the session to the report, from the watch-history.jsonl of `watch`
    #[arg(long, value_name = "FILE", requires = "html")]
    history: Option<PathBuf>,
    /// Earlier calibrations of the unit: results, folders of results, or a store. What they say of a reading after a switch-on
    /// stands in the report and in the certificates
    #[arg(long, value_name = "STORE|RESULT|FOLDER", num_args = 1..)]
    past: Vec<PathBuf>,
    /// Write the calibration certificate (ISO/IEC 17025) to this file
    #[arg(long, value_name = "FILE", requires = "laboratory")]
    pdf: Option<PathBuf>,
    /// Add the results before an adjustment to the certificate, from the result.json of that calibration
    #[arg(long, value_name = "RESULT", requires = "pdf")]
    before: Option<PathBuf>,
    /// Write the digital calibration certificate (DCC XML 3.3.0) to this file
    #[arg(long, value_name = "FILE", requires = "laboratory")]
    dcc: Option<PathBuf>,
    /// Write the compensation as source code with test vectors to this folder: C99, MATLAB and Octave, Python
    #[arg(long, alias = "c", value_name = "DIR")]
    code: Option<PathBuf>,
    /// Largest specific force on each axis that the source code takes, such as "200 g"
    /// [default: twice the largest plateau reading of the calibration, or less where the inverse is not certified so far, but no less than that reading]
    #[arg(long, value_name = "QUANTITY", value_parser = force_range, requires = "code")]
    range: Option<f64>,
    #[command(flatten)]
    documents: Documents,
    #[command(flatten)]
    printing: Printing,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let request = DocumentRequest {
        result: arguments.result.clone(),
        html: arguments.html.clone(),
        history: arguments.history.clone(),
        past: arguments.past.clone(),
        pdf: arguments.pdf.clone(),
        before: arguments.before.clone(),
        dcc: arguments.dcc.clone(),
        code: arguments.code.clone(),
        range: arguments.range,
        laboratory: arguments.documents.laboratory.clone(),
        axes: arguments.documents.axes.as_deref().map(Axes::from),
        language: arguments.documents.language.into(),
    };
    if request.written().is_empty() && !arguments.printing.json {
        let expected = "--html, --pdf, --dcc or --code with its name";
        return Err(Error::content(&arguments.result, Place::Whole, "no document asked for", expected));
    }
    let documents = write_documents(&request)?;
    remark_other_days(documents.other_days.as_deref());
    if request.pdf.is_some() || request.dcc.is_some() {
        remark(&exact_text(&documents.result));
    }
    let (result, unit) = (documents.result, documents.unit);
    let objections = result.objections();
    let is_within = is_within_limits(unit.as_ref());
    let text = || {
        let mut screen = objections_text(&objections);
        screen.add(unit.as_ref().filter(|_| !is_within).map(unit_text).unwrap_or_default());
        let written: Vec<String> = request.written().iter().map(|(_, path)| path.display().to_string()).collect();
        screen.say(0, &format!("Written to {}", written.join(", ")));
        screen
    };
    let within = unit.as_ref().map(UnitStatement::is_within);
    let json = || DocumentsReport::of(&arguments.result, &result, &request.written(), within).to_json();
    arguments.printing.show(text, json)?;
    Ok(Outcome::acceptable(objections.is_empty() && is_within))
}
