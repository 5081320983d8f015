//! The error model written out.

use std::fmt::Write;

use centrical_session::CalibrationResult;

/// `f1' = f1 + df_1 + G0_11 f1 + ...` for the three newtonometers, separated by semicolons.
pub(crate) fn equation(result: &CalibrationResult) -> String {
    equations(result).join("; ")
}

/// One equation for each newtonometer.
pub(crate) fn equations(result: &CalibrationResult) -> [String; 3] {
    [1, 2, 3].map(|axis| {
        let mut text = format!("f{axis}\u{2032} = f{axis}");
        for term in result.model.error_model.iter().filter(|term| term.axis == axis) {
            let monomial = monomial(term.powers, term.sign_of);
            let _ = if monomial == "1" {
                write!(text, " + {}", term.name)
            } else {
                write!(text, " + {}·{}", term.name, monomial.replace("^2", "²").replace("^3", "³"))
            };
        }
        text
    })
}

/// `f1^2 f3`, or `1`; an odd term with its sign, `sgn(f1) f1^2`.
pub(crate) fn monomial(powers: [u8; 3], sign_of: Option<usize>) -> String {
    let mut factors: Vec<String> = sign_of.map(|axis| format!("sgn(f{axis})")).into_iter().collect();
    for (axis, power) in (1..).zip(powers).filter(|(_, power)| *power > 0) {
        factors.push(if power == 1 { format!("f{axis}") } else { format!("f{axis}^{power}") });
    }
    if factors.is_empty() { "1".to_owned() } else { factors.join(" ") }
}
