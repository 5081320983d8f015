//! Digital Calibration Certificate: XML of the DCC schema 3.3.0 with quantities in D-SI.

mod administrative;
mod results;
mod xml;

use centrical_session::{CalibrationResult, UnitOfMeasure, UnknownUnit};

use crate::document::Issuer;
use crate::language::Language;
use xml::Xml;

/// The certificate of a result. The same data give the same bytes.
///
/// # Errors
/// [`UnknownUnit`] when a parameter has a unit that D-SI cannot be given for.
pub fn digital_certificate(
    result: &CalibrationResult,
    issuer: &Issuer,
    language: Language,
) -> Result<String, UnknownUnit> {
    let units = result.parameters.iter().map(|p| UnitOfMeasure::parse(&p.unit)).collect::<Result<Vec<_>, _>>()?;
    let of_axes = result.axes.iter().flat_map(|axes| &axes.parameters);
    let of_axes = of_axes.map(|p| UnitOfMeasure::parse(&p.unit)).collect::<Result<Vec<_>, _>>()?;
    let mut xml = Xml::new();
    let attributes = [
        ("xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance"),
        ("xmlns:dcc", "https://ptb.de/dcc"),
        ("xmlns:si", "https://ptb.de/si"),
        ("xsi:schemaLocation", "https://ptb.de/dcc https://ptb.de/dcc/v3.3.0/dcc.xsd"),
        ("schemaVersion", "3.3.0"),
    ];
    xml.element_with("dcc:digitalCalibrationCertificate", &attributes, |xml| {
        administrative::data(xml, result, issuer, language);
        results::list(xml, result, [&units, &of_axes], &issuer.laboratory, language);
    });
    Ok(xml.into_text())
}
