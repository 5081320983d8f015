//! The error model written out.

use std::fmt::Write;

use centrical_session::{CalibrationResult, TermSummary};

/// `f1' = f1 + df_1 + G0_11 f1 + ...` for the three newtonometers, separated by semicolons.
pub(crate) fn equation(result: &CalibrationResult) -> String {
    equations(result).join("; ")
}

/// One equation for each newtonometer.
pub(crate) fn equations(result: &CalibrationResult) -> [String; 3] {
    [1, 2, 3].map(|axis| {
        let mut text = format!("f{axis}\u{2032} = f{axis}");
        for term in result.model.error_model.iter().filter(|term| term.axis == axis) {
            let monomial = monomial(term).replace('*', " ");
            let _ = if monomial == "1" {
                write!(text, " + {}", term.name)
            } else {
                write!(text, " + {}·{}", term.name, monomial.replace("^2", "²").replace("^3", "³"))
            };
        }
        text
    })
}

/// `f1^2*f3`, `f2*|f2|` or `1`, as sessions write it; a question mark if it takes the sign of an axis that does not exist.
pub(crate) fn monomial(term: &TermSummary) -> String {
    term.monomial().map_or_else(|_| "?".to_owned(), |monomial| monomial.to_string())
}
