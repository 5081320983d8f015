//! Formulas as print has them: raised powers, lowered indices, a centred point.

use crate::number::raised;

/// A formula of sessions as print has it: `f1^2*f3` with a raised 2, lowered 1 and 3 and a point between.
pub(crate) fn typeset(formula: &str) -> String {
    let mut after = ' ';
    let mut text = String::with_capacity(formula.len());
    for symbol in formula.chars() {
        match (symbol.to_digit(10), after) {
            (Some(_), '^') => text.push(raised(symbol)),
            (Some(_), 'f') => text.push_str(&lowered(symbol.encode_utf8(&mut [0; 4]))),
            _ => match symbol {
                '^' => {}
                '*' => text.push('·'),
                _ => text.push(symbol),
            },
        }
        // A power may have several digits.
        if !(after == '^' && symbol.is_ascii_digit()) {
            after = symbol;
        }
    }
    text
}

/// Digits lowered.
pub(crate) fn lowered(digits: &str) -> String {
    const LOWERED: [char; 10] = ['₀', '₁', '₂', '₃', '₄', '₅', '₆', '₇', '₈', '₉'];
    digits.chars().map(|c| c.to_digit(10).map_or(c, |digit| LOWERED[digit as usize])).collect()
}

#[cfg(test)]
mod tests {
    use super::typeset;

    #[test]
    fn products_and_powers_are_typeset() {
        for (written, printed) in
            [("f1", "f₁"), ("f1^2", "f₁²"), ("f1*f2", "f₁·f₂"), ("f2*|f2|", "f₂·|f₂|"), ("f1^2*f3^12", "f₁²·f₃¹²")]
        {
            assert_eq!(typeset(written), printed);
        }
    }
}
