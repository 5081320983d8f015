//! `centrical report RESULT`: the documents that a laboratory hands over, from a result.

use std::path::{Path, PathBuf};

use centrical_report::{
    DocumentRequest, Emphasis, Screen, UnitStatement, certificates_in, exact_text, objections_text, read_issuer,
    result_text, unit_text, write_all_documents, write_documents,
};
use centrical_session::{Axes, CalibrationResult, DocumentsReport, Error, Place};

use crate::given::{LanguageName, force_range};
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

/// Language of the documents, and the laboratory's data in them: what every calibration hands over.
#[derive(Debug, clap::Args)]
pub struct Documents {
    /// Laboratory file: laboratory, customer, dates, standards and persons named in the certificates, and limits of the
    /// unit; a unit that is not within them ends with exit code 1
    #[arg(long, value_name = "FILE")]
    pub laboratory: Option<PathBuf>,
    /// Further axes in which to state the error model and specific forces: lower, upper, symmetric, case, or a file with [axes]
    #[arg(long, value_name = "AXES|FILE")]
    pub axes: Option<String>,
    /// Language of the documents
    #[arg(long, value_enum, default_value = "en")]
    pub language: LanguageName,
}

impl Documents {
    /// `result`, which is called `name` in messages, in the axes asked for. One that is not acceptable has documents in its own axes, and
    /// a remark, where the others cannot be found.
    pub fn in_axes(&self, result: CalibrationResult, name: &Path) -> Result<CalibrationResult, Error> {
        let Some(axes) = &self.axes else { return Ok(result) };
        match Axes::from(axes.as_str()).of(result.clone(), name) {
            Err(error @ Error::ErrorModel { .. }) if !result.objections().is_empty() => {
                let mut screen = Screen::default();
                screen.say(0, &format!("axes {axes} are left out: {error}"));
                remark(&screen);
                Ok(result)
            }
            in_axes => in_axes,
        }
    }

    /// Writes the result and its documents to the folder `out`, shows the result, which is `written` to a file or folder, and says whether it is
    /// acceptable.
    pub fn hand_over(
        &self,
        result: &CalibrationResult,
        printing: Printing,
        out: Option<&Path>,
        written: Option<&Path>,
    ) -> Result<Outcome, Error> {
        let issuer = self.laboratory.as_deref().map(|file| read_issuer(file, result)).transpose();
        let known = issuer.as_ref().ok().and_then(Option::as_ref);
        remark_other_days(known.and_then(|issuer| issuer.other_days(result)).as_deref());
        let documents = out.map_or(Ok(()), |folder| {
            if known.is_none() {
                remark_old_certificates(folder);
            }
            write_all_documents(result, known, self.language.into(), folder)
        });
        let issuer = issuer?;
        let objections = result.objections();
        let unit = issuer.and_then(|issuer| issuer.unit);
        let said = written.filter(|_| documents.is_ok()).map(|written| format!("Written to {}", written.display()));
        let text = || result_text(result, unit.as_ref(), said.as_deref());
        printing.show(text, || result.to_json())?;
        // The result does not hold what the laboratory's limits say of the unit.
        if let Some(unit) = unit.as_ref().filter(|_| printing.json) {
            remark(&unit_text(unit));
        }
        documents?;
        Ok(Outcome::acceptable(objections.is_empty() && is_within_limits(unit.as_ref())))
    }
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

/// Remarks that a certificate is of other days than the session.
fn remark_other_days(words: Option<&str>) {
    let mut screen = Screen::default();
    if let Some(words) = words {
        screen.marked(Emphasis::Warning, "OTHER DAYS", words);
    }
    remark(&screen);
}

/// Remarks that certificates in a folder are of an earlier result, which was replaced without a new one.
fn remark_old_certificates(folder: &Path) {
    let mut screen = Screen::default();
    for certificate in certificates_in(folder) {
        let words = format!("{} is of an earlier result: --laboratory makes a new one", certificate.display());
        screen.marked(Emphasis::Warning, "OLD CERTIFICATE", &words);
    }
    remark(&screen);
}

/// Whether the unit keeps the limits that were asked for; limits that were not are kept.
fn is_within_limits(unit: Option<&UnitStatement>) -> bool {
    unit.is_none_or(UnitStatement::is_within)
}
