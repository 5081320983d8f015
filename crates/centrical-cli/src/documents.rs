//! What every calibration hands over: its result, and the documents of it.

use std::path::{Path, PathBuf};

use centrical_report::{
    Emphasis, Screen, UnitStatement, certificates_in, read_issuer, result_text, unit_text, write_all_documents,
};
use centrical_session::{Axes, CalibrationResult, Error};

use crate::given::LanguageName;
use crate::output::{Outcome, Printing, remark};

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

/// Remarks that a certificate is of other days than the session.
pub fn remark_other_days(words: Option<&str>) {
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
pub fn is_within_limits(unit: Option<&UnitStatement>) -> bool {
    unit.is_none_or(UnitStatement::is_within)
}
