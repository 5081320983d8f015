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
            let monomial = monomial(term);
            let _ = if monomial == "1" {
                write!(text, " + {}", term.name)
            } else {
                write!(text, " + {}·{}", term.name, typeset(&monomial))
            };
        }
        text
    })
}

/// The same monomial as print has it: `f1^2*f3` with a raised 2 and a centred point.
fn typeset(monomial: &str) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let mut is_power = false;
    let mut text = String::with_capacity(monomial.len());
    for symbol in monomial.chars() {
        match (symbol, symbol.to_digit(10)) {
            ('^', _) => {}
            ('*', _) => text.push('·'),
            (_, Some(digit)) if is_power => text.push(RAISED[digit as usize]),
            _ => text.push(symbol),
        }
        is_power = symbol == '^' || is_power && symbol.is_ascii_digit();
    }
    text
}

/// `f1^2*f3`, `f2*|f2|` or `1`, as sessions write it; a question mark if it takes the sign of an axis that does not exist.
pub(crate) fn monomial(term: &TermSummary) -> String {
    term.monomial().map_or_else(|_| "?".to_owned(), |monomial| monomial.to_string())
}

#[cfg(test)]
mod tests {
    use super::typeset;

    #[test]
    fn products_and_powers_are_typeset() {
        for (written, printed) in
            [("f1", "f1"), ("f1^2", "f1²"), ("f1*f2", "f1·f2"), ("f2*|f2|", "f2·|f2|"), ("f1^2*f3^12", "f1²·f3¹²")]
        {
            assert_eq!(typeset(written), printed);
        }
    }
}
