//! What every calibration hands over: documents, text and verdict.

use std::path::{Path, PathBuf};

use centrical_report::{
    Screen, UnitStatement, document_files, read_issuer, terminal_table, unit_text, verdict_text, write_all_documents,
};
use centrical_session::{CalibrationResult, Error, ResultObjection, refuse_inputs};

use super::report::{Documents, is_within_limits, remark_other_days};
use crate::outcome::Outcome;
use crate::output::remark;
use crate::printing::Printing;

/// Refuses a result, or documents in a folder, over what is read.
pub fn refuse_outputs(result: Option<&Path>, out: Option<&Path>, inputs: &[&Path]) -> Result<(), Error> {
    let documents = out.map(document_files).unwrap_or_default();
    let outputs: Vec<PathBuf> = result.map(Path::to_owned).into_iter().chain(documents).collect();
    Ok(refuse_inputs(&outputs, inputs)?)
}

impl Documents {
    /// Writes the documents to the folder `out`, shows the result, which is `written` to a file or folder, and says whether it is acceptable.
    pub fn hand_over(
        &self,
        result: &CalibrationResult,
        printing: Printing,
        out: Option<&Path>,
        written: Option<&Path>,
    ) -> Result<Outcome, Error> {
        let issuer = self.laboratory.as_deref().map(|file| read_issuer(file, result)).transpose()?;
        remark_other_days(issuer.as_ref().and_then(|issuer| issuer.other_days(result)).as_deref());
        if let Some(folder) = out {
            write_all_documents(result, issuer.as_ref(), self.language.into(), folder)?;
        }
        let objections = result.objections();
        let unit = issuer.and_then(|issuer| issuer.unit);
        let said = written.map(|written| format!("Written to {}", written.display()));
        let text = || result_text(result, &objections, unit.as_ref(), said.as_deref());
        printing.show(text, || result.to_json())?;
        // The result does not hold what the laboratory's limits say of the unit.
        if let Some(unit) = unit.as_ref().filter(|_| printing.json) {
            remark(&unit_text(unit));
        }
        Ok(Outcome::acceptable(objections.is_empty() && is_within_limits(unit.as_ref())))
    }
}

/// The verdict, what it rests on, and a last line.
pub fn result_text(
    result: &CalibrationResult,
    objections: &[ResultObjection],
    unit: Option<&UnitStatement>,
    said: Option<&str>,
) -> Screen {
    let mut screen = verdict_text(objections, result.is_checked());
    screen.add(unit.map(unit_text).unwrap_or_default());
    screen.gap();
    screen.add(terminal_table(result));
    if let Some(said) = said {
        screen.gap();
        screen.say(0, said);
    }
    screen
}
