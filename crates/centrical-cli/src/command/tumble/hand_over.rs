//! What every calibration by rests hands over: files, text and verdict.

use std::path::Path;

use centrical_report::{read_issuer, write_all_documents};
use centrical_session::{CalibrationResult, Error, refuse_inputs};

use super::arguments::Arguments;
use crate::command::calibrate::{outputs, report};
use crate::command::report::{is_within_limits, remark_other_days};
use crate::outcome::Outcome;

/// The result in the folder.
pub const RESULT: &str = "result.json";

impl Arguments {
    /// Refuses outputs over what is read.
    pub fn refuse_inputs<'a>(&'a self, inputs: impl Iterator<Item = &'a Path>) -> Result<(), Error> {
        let read: Vec<&Path> = inputs.chain(self.documents.laboratory.as_deref()).collect();
        let result = self.out.as_ref().map(|folder| folder.join(RESULT));
        Ok(refuse_inputs(&outputs(self.out.as_deref(), result.as_deref()), &read)?)
    }

    /// Writes the result by `write` and the documents, shows the result and says whether it is acceptable.
    pub fn hand_over(
        &self,
        result: &CalibrationResult,
        write: impl FnOnce(&Path) -> Result<(), Error>,
    ) -> Result<Outcome, Error> {
        let out = self.out.as_deref();
        let laboratory = self.documents.laboratory.as_deref();
        let issuer = laboratory.map(|file| read_issuer(file, result)).transpose()?;
        remark_other_days(issuer.as_ref().and_then(|issuer| issuer.other_days(result)).as_deref());
        if let Some(folder) = out {
            write(folder)?;
            write_all_documents(result, issuer.as_ref(), self.documents.language.into(), folder)?;
        }
        let objections = result.objections();
        let unit = issuer.and_then(|issuer| issuer.unit);
        let text = || report(result, &objections, unit.as_ref(), out);
        self.printing.show(text, || result.to_json())?;
        Ok(Outcome::acceptable(objections.is_empty() && is_within_limits(unit.as_ref())))
    }
}
