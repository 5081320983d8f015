//! Digital Calibration Certificate: XML of the DCC schema 3.3.0 with quantities in D-SI.

mod administrative;
mod results;
mod unit;
mod xml;

use centrical_session::{CalibrationResult, Laboratory};

use crate::language::Language;
use xml::Xml;

/// The certificate of a result. The same data give the same bytes.
pub fn digital_certificate(result: &CalibrationResult, laboratory: &Laboratory, language: Language) -> String {
    let mut xml = Xml::new();
    let attributes = [
        ("xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance"),
        ("xmlns:dcc", "https://ptb.de/dcc"),
        ("xmlns:si", "https://ptb.de/si"),
        ("xsi:schemaLocation", "https://ptb.de/dcc https://ptb.de/dcc/v3.3.0/dcc.xsd"),
        ("schemaVersion", "3.3.0"),
    ];
    xml.element_with("dcc:digitalCalibrationCertificate", &attributes, |xml| {
        administrative::data(xml, result, laboratory, language);
        results::list(xml, result, laboratory, language);
    });
    xml.into_text()
}
