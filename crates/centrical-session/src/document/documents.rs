//! The documents that were made of a result, as a JSON document: schema `centrical-documents/1`.

use std::path::Path;

use serde::Serialize;

use super::result::{CalibrationResult, Program, ResultObjection};

/// Name of the schema's present version.
pub(crate) const DOCUMENTS_SCHEMA: &str = "centrical-documents/1";

/// The documents of a result, and its verdict.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DocumentsReport {
    /// `centrical-documents/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// The result, as it was given.
    pub result: String,
    /// The documents that were written.
    pub written: Vec<WrittenDocument>,
    /// Whether the result has no objections.
    pub acceptable: bool,
    /// The objections to the result; its `validity`, `fit` and `speeds` say more of each.
    pub objections: Vec<ObjectionName>,
    /// Whether the unit keeps the limits of the laboratory, where there are some.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub within_limits: Option<bool>,
}

/// A document that was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct WrittenDocument {
    /// What it is.
    pub kind: DocumentKind,
    /// Its file or folder, as it was given.
    pub path: String,
}

/// A kind of document.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DocumentKind {
    /// The report, an HTML page.
    Report,
    /// The calibration certificate, PDF.
    Certificate,
    /// The digital calibration certificate, XML.
    DigitalCertificate,
    /// The compensation as source code, a folder.
    Code,
}

/// An objection to a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ObjectionName {
    /// The fit did not converge.
    NotConverged,
    /// The residuals show an effect that the model leaves out.
    LeftOut,
    /// The residuals are larger than the stated uncertainties explain.
    Residuals,
    /// Plateaus stand out.
    Outlying,
    /// The residuals follow something that the model does not have.
    Patterns,
    /// The telemetry contradicts the schedule or the record.
    Speeds,
    /// Readings drift over plateaus.
    Drift,
    /// Readings creep after the unit is turned.
    Creep,
    /// Coefficients of the error model are not determined.
    NotDetermined,
}

impl ObjectionName {
    /// Its word in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::NotConverged => "not-converged",
            Self::LeftOut => "left-out",
            Self::Residuals => "residuals",
            Self::Outlying => "outlying",
            Self::Patterns => "patterns",
            Self::Speeds => "speeds",
            Self::Drift => "drift",
            Self::Creep => "creep",
            Self::NotDetermined => "not-determined",
        }
    }
}

impl From<&ResultObjection> for ObjectionName {
    fn from(objection: &ResultObjection) -> Self {
        match objection {
            ResultObjection::NotConverged { .. } => Self::NotConverged,
            ResultObjection::LeftOut(..) => Self::LeftOut,
            ResultObjection::Residuals { .. } => Self::Residuals,
            ResultObjection::Outlying(..) => Self::Outlying,
            ResultObjection::Patterns(..) => Self::Patterns,
            ResultObjection::Speeds(..) => Self::Speeds,
            ResultObjection::Drift { .. } => Self::Drift,
            ResultObjection::Creep(..) => Self::Creep,
            ResultObjection::NotDetermined(..) => Self::NotDetermined,
        }
    }
}

impl DocumentsReport {
    /// The documents that were `written` of the result in `file`, and whether the unit is within its limits, if it has some.
    pub fn of(
        file: &Path,
        result: &CalibrationResult,
        written: &[(DocumentKind, &Path)],
        within_limits: Option<bool>,
    ) -> Self {
        let document =
            |(kind, path): &(DocumentKind, &Path)| WrittenDocument { kind: *kind, path: path.display().to_string() };
        let objections: Vec<ObjectionName> = result.objections().iter().map(Into::into).collect();
        Self {
            schema: DOCUMENTS_SCHEMA,
            program: Program::this(),
            result: file.display().to_string(),
            written: written.iter().map(document).collect(),
            acceptable: objections.is_empty(),
            objections,
            within_limits,
        }
    }
}
